//! The true derivatives by routes that do not use dual numbers: differences in double-double, closed forms and identities.

use featherbench_bench::by_duals::{ByDuals, Columns, Point};
use featherbench_bench::measure::{Magnitudes, scaled_error, worst};
use featherbench_bench::truth::{TrueDerivatives, TruthModel};
use featherbench_bench::{Quantity, Robot, derivative_floor};
use featherbench_model::{JointKind, Model};
use featherbench_results::ModelOrigin;
use featherbench_robots::{Family, StateBatch};
use featherbench_spatial::{DoubleDouble, Lift, Quaternion, Real, Vec3};

type Wide = DoubleDouble;

const ROBOTS: [&str; 6] = [
    "joints:kind=mixed,base=free",
    "joints:kind=euler_zyx,base=free",
    "joints:kind=cylindrical,base=fixed,armature=true",
    "tree:n=7,joints=all,seed=4,base=free,armature=true",
    "chain:n=8,layout=spatial",
    "humanoid",
];

fn robot(spec: &str) -> Robot {
    let description = Family::parse(spec).unwrap().generate().unwrap();
    Robot::new(&description, "test", ModelOrigin::Generated, StateBatch::HEAD, 3).unwrap()
}

fn wide(values: &[f64]) -> Vec<Wide> {
    values.iter().map(|&x| x.lift()).collect()
}

/// The configuration after a straight step of the coordinates: `q + h N e_dof`. Its derivative by h at 0 is the tangent. A quaternion then
/// is longer than one by h²/8, so its length is made one again.
fn moved(model: &Model<Wide>, q: &[Wide], dof: usize, h: Wide) -> Vec<Wide> {
    let mut end = q.to_vec();
    let joint = model.topology.joints().iter().rev().find(|joint| joint.v <= dof).unwrap();
    let k = dof - joint.v;
    let step = |k: usize| Vec3::from_array(std::array::from_fn(|of| if of == k { h } else { Wide::zero() }));
    let turns = |end: &mut [Wide], k: usize| {
        let [x, y, z, w] = [end[0], end[1], end[2], end[3]];
        let rate = Quaternion::from_array([x, y, z, w]).derivative(step(k));
        let turned = [x + rate.v.x, y + rate.v.y, z + rate.v.z, w + rate.w];
        let length = turned.iter().fold(Wide::zero(), |sum, &x| sum + x * x).sqrt();
        end.iter_mut().zip(turned).for_each(|(end, x)| *end = x / length);
    };
    match joint.kind {
        JointKind::Spherical => turns(&mut end[joint.q..joint.q + 4], k),
        JointKind::Free if k >= 3 => turns(&mut end[joint.q + 3..joint.q + 7], k - 3),
        JointKind::Free => {
            let [x, y, z, w] = [q[joint.q + 3], q[joint.q + 4], q[joint.q + 5], q[joint.q + 6]];
            let along = (Quaternion::from_array([x, y, z, w]).to_rotation() * step(k)).to_array();
            end[joint.q..joint.q + 3].iter_mut().zip(along).for_each(|(end, x)| *end += x);
        }
        _ => end[joint.q] += h,
    }
    end
}

/// Central differences of fourth order of ID or FD with 32 digits, in the layout of the quantity.
fn differences(robot: &Robot, quantity: Quantity, state: usize) -> Vec<f64> {
    let model: Model<Wide> = Model::build(&robot.description).unwrap();
    let states = &robot.states;
    let (q, v, a, tau) = (wide(states.q(state)), wide(states.v(state)), wide(states.a(state)), wide(states.tau(state)));
    let by_q = matches!(quantity, Quantity::InverseDynamicsDq | Quantity::ForwardDynamicsDq);
    let inverse = matches!(quantity, Quantity::InverseDynamicsDq | Quantity::InverseDynamicsDv);
    // h⁴/30 of fifth derivatives, 1e-25 of them; rounding leaves 1e-31/h = 1e-25.
    let h = Wide::from_f64(1e-6);
    let nv = states.nv;
    let mut out = vec![0.0; nv * nv];
    for dof in 0..nv {
        let at = |steps: f64| {
            let step = h * Wide::from_f64(steps);
            let (mut q, mut v) = (q.clone(), v.clone());
            if by_q {
                q = moved(&model, &q, dof, step);
            } else {
                v[dof] += step;
            }
            if inverse {
                featherbench_dynamics::inverse_dynamics(&model, &q, &v, &a).unwrap()
            } else {
                featherbench_dynamics::forward_dynamics(&model, &q, &v, &tau).unwrap()
            }
        };
        let [near, back, far, far_back] = [1.0, -1.0, 2.0, -2.0].map(at);
        for row in 0..nv {
            let slope = Wide::from_f64(8.0) * (near[row] - back[row]) - (far[row] - far_back[row]);
            out[row * nv + dof] = (slope / (Wide::from_f64(12.0) * h)).to_f64();
        }
    }
    out
}

const BY_DIFFERENCES: [Quantity; 4] =
    [Quantity::InverseDynamicsDq, Quantity::InverseDynamicsDv, Quantity::ForwardDynamicsDq, Quantity::ForwardDynamicsDv];

#[test]
fn the_truth_is_that_of_differences_with_32_digits() {
    for spec in ROBOTS {
        let robot = robot(spec);
        let mut truth = TrueDerivatives::new(&robot).unwrap();
        for state in 0..robot.states.count() {
            let at = Magnitudes::new(&robot, state);
            for quantity in BY_DIFFERENCES {
                let error = scaled_error(
                    &robot,
                    quantity,
                    &at,
                    &truth.answer(&robot, quantity, state).unwrap(),
                    &differences(&robot, quantity, state),
                );
                // Both are rounded to doubles; differences of fast states are good to 1e-18 and better.
                assert!(error <= f64::EPSILON, "{spec}, state {state}, {quantity:?}: {error:e}");
            }
        }
    }
}

/// With the known answer of one number, in f64: `dual` has the digits of the kernels.
#[test]
fn duals_in_double_are_near_the_truth() {
    for spec in ROBOTS {
        let robot = robot(spec);
        let mut truth = TrueDerivatives::new(&robot).unwrap();
        let (mut duals, mut columns) = (ByDuals::<f64>::new(robot.model.lift()), Columns::new(robot.model.clone()));
        for state in 0..robot.states.count() {
            let states = &robot.states;
            let at = Point { q: states.q(state), v: states.v(state), a: states.a(state), tau: states.tau(state) };
            for quantity in Quantity::DERIVATIVES {
                let mut found = vec![0.0; quantity.size(&robot)];
                if quantity == Quantity::TorqueRegressor {
                    columns.run(at, &mut found).unwrap();
                } else {
                    assert!(duals.run(quantity, at, &mut found).unwrap());
                }
                let due = truth.answer(&robot, quantity, state).unwrap();
                let error = scaled_error(&robot, quantity, &Magnitudes::new(&robot, state), &due, &found);
                assert!(error <= 1e-12, "{spec}, state {state}, {quantity:?}: {error:e}");
            }
        }
    }
}

/// C v = h(q, v) − h(q, 0), and C + Cᵀ is the rate of M: as matrices, by differences of M with 32 digits.
#[test]
fn the_coriolis_matrix_has_its_two_properties() {
    for spec in ROBOTS {
        let robot = robot(spec);
        let model: Model<Wide> = Model::build(&robot.description).unwrap();
        let mut truth = TrueDerivatives::new(&robot).unwrap();
        for state in 0..robot.states.count() {
            let (states, nv) = (&robot.states, robot.states.nv);
            let (q, v) = (wide(states.q(state)), wide(states.v(state)));
            let c = truth.answer(&robot, Quantity::CoriolisMatrix, state).unwrap();
            let bias = |v: &[Wide]| featherbench_dynamics::bias_force(&model, &q, v).unwrap();
            let (moving, still) = (bias(&v), bias(&vec![Wide::zero(); nv]));
            let at = Magnitudes::new(&robot, state);
            for row in 0..nv {
                let product: f64 = (0..nv).map(|column| c[row * nv + column] * states.v(state)[column]).sum();
                let due = (moving[row] - still[row]).to_f64();
                // nv products of rounded entries
                assert!((product - due).abs() <= 1e-13 * at.bias_force[row], "{spec}, state {state}: C v of {row}: {product} {due}");
            }

            let h = Wide::from_f64(1e-10);
            let mass = |sign: f64| {
                let step = h * Wide::from_f64(sign);
                let end = (0..nv).fold(q.clone(), |q, dof| moved(&model, &q, dof, step * v[dof]));
                featherbench_dynamics::mass_matrix(&model, &end).unwrap()
            };
            let (ahead, behind) = (mass(1.0), mass(-1.0));
            let pairs = (0..nv * nv).map(|entry| (entry / nv, entry % nv));
            let rate: Vec<f64> = pairs.clone().map(|(i, j)| ((ahead.get(i, j) - behind.get(i, j)) / (h + h)).to_f64()).collect();
            let sum: Vec<f64> = pairs.map(|(i, j)| c[i * nv + j] + c[j * nv + i]).collect();
            let error = scaled_error(&robot, Quantity::CoriolisMatrix, &at, &rate, &sum);
            // h²/6 of third derivatives, whose fast states have 1e3 to the third: 1e-11.
            assert!(error <= 1e-10, "{spec}, state {state}: C + Cᵀ is off by {error:e}");
        }
    }
}

/// Of a single body that turns: C = ½(ω×I + I ω× − (Iω)×), whose torsion is zero. The rest of the properties leave C + A(ω) with any
/// skew A that has A ω = 0.
#[test]
fn the_coriolis_matrix_of_a_spinning_body_has_a_closed_form() {
    let robot = robot("joints:kind=spherical,base=fixed,shape=single");
    assert_eq!(robot.states.nv, 3);
    let mut truth = TrueDerivatives::new(&robot).unwrap();
    for state in 0..robot.states.count() {
        let c = truth.answer(&robot, Quantity::CoriolisMatrix, state).unwrap();
        let mass = TruthModel::new(&robot).unwrap().answer(&robot, Quantity::MassMatrix, state).unwrap();
        let omega = robot.states.v(state);
        let skew = |u: &[f64]| [[0.0, -u[2], u[1]], [u[2], 0.0, -u[0]], [-u[1], u[0], 0.0]];
        let inertia: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| mass[3 * i + j]));
        let momentum: Vec<f64> = (0..3).map(|i| (0..3).map(|j| inertia[i][j] * omega[j]).sum()).collect();
        let product = |a: [[f64; 3]; 3], b: [[f64; 3]; 3], i: usize, j: usize| (0..3).map(|k| a[i][k] * b[k][j]).sum::<f64>();
        let due: Vec<f64> = (0..9)
            .map(|entry| {
                let (i, j) = (entry / 3, entry % 3);
                0.5 * (product(skew(omega), inertia, i, j) + product(inertia, skew(omega), i, j) - skew(&momentum)[i][j])
            })
            .collect();
        let error = scaled_error(&robot, Quantity::CoriolisMatrix, &Magnitudes::new(&robot, state), &due, &c);
        // Nine products in double
        assert!(error <= 1e-14, "state {state}: {error:e}");
    }
}

/// Y π = τ − armature·a with the parameters of the description, their inertia shifted to the body's origin by Steiner.
#[test]
fn the_regressor_times_the_parameters_is_the_torque() {
    for spec in ROBOTS {
        let robot = robot(spec);
        let mut truth = TrueDerivatives::new(&robot).unwrap();
        let model = TruthModel::new(&robot).unwrap();
        let parameters: Vec<f64> = (robot.description.bodies.iter())
            .flat_map(|body| {
                let ([x, y, z], m) = (body.com, body.mass);
                let [xx, xy, xz, yy, yz, zz] = body.inertia;
                let shifted = [xx + m * (y * y + z * z), xy - m * x * y, xz - m * x * z];
                let rest = [yy + m * (x * x + z * z), yz - m * y * z, zz + m * (x * x + y * y)];
                [&[m, m * x, m * y, m * z][..], &shifted, &rest].concat()
            })
            .collect();
        for state in 0..robot.states.count() {
            let y = truth.answer(&robot, Quantity::TorqueRegressor, state).unwrap();
            let tau = model.answer(&robot, Quantity::InverseDynamics, state).unwrap();
            let at = Magnitudes::new(&robot, state);
            let rows = y.chunks_exact(parameters.len()).enumerate();
            let off = rows.map(|(row, y)| {
                let product: f64 = y.iter().zip(&parameters).map(|(y, p)| y * p).sum();
                let due = tau[row] - robot.model.armature[row] * robot.states.a(state)[row];
                (product - due).abs() / at.joint_force[row]
            });
            let off = off.fold(0.0, worst);
            // Hundreds of products in double
            assert!(off <= 1e-13, "{spec}, state {state}: {off:e}");
        }
    }
}

/// The floor is a bound: a random change of the inputs by half an ulp moves the derivative by less, and not by many decades less.
#[test]
fn the_floor_is_near_what_rounded_inputs_do() {
    let robot = robot("chain:n=8,layout=spatial");
    for quantity in [Quantity::ForwardDynamicsDq, Quantity::ForwardDynamicsDv] {
        let floor = derivative_floor(&robot, quantity, 0).unwrap();
        let due = TrueDerivatives::new(&robot).unwrap().answer(&robot, quantity, 0).unwrap();
        let mut largest = 0.0;
        for seed in 0..8 {
            let mut other = robot.clone();
            // A change of 2²⁰ half ulps, so that the change of the truth is not lost in its own rounding
            let mut random = featherbench_robots::Random::new(7, seed);
            let grow = f64::EPSILON * 0.5 * (1_u64 << 20) as f64;
            let mut shake = |x: &mut f64| *x *= 1.0 + if random.bits64().is_multiple_of(2) { grow } else { -grow };
            for body in &mut other.description.bodies {
                shake(&mut body.mass);
                body.joint.placement.translation.iter_mut().for_each(&mut shake);
            }
            other.states.q.iter_mut().chain(&mut other.states.v).chain(&mut other.states.tau).for_each(&mut shake);
            let found = TrueDerivatives::new(&other).unwrap().answer(&other, quantity, 0).unwrap();
            let error = scaled_error(&robot, quantity, &Magnitudes::new(&robot, 0), &due, &found) / (1_u64 << 20) as f64;
            largest = worst(largest, error);
        }
        assert!(largest <= floor, "{quantity:?}: {largest:e} above {floor:e}");
        assert!(largest >= 1e-2 * floor, "{quantity:?}: {largest:e} far below {floor:e}");
    }
}
