//! Properties of the error measures:
//! - they do not depend on units;
//! - the magnitudes are upper bounds;
//! - a perturbation of a known size has the backward error of that size;
//! - no forward error exceeds its amplification.

use featherbench_bench::measure::{ForwardScale, Magnitudes, ratio, scaled_error, worst};
use featherbench_bench::{Quantity, Robot};
use featherbench_dynamics::{Ltdl, Rnea, TreeSparse, bias_force, forward_dynamics, forward_kinematics, inverse_dynamics, mass_matrix};
use featherbench_model::{Description, JointKind, JointType, Model};
use featherbench_results::ModelOrigin;
use featherbench_robots::{Family, Random};
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use std::cell::Cell;

/// Six states: one of each case.
const STATES: usize = 6;

fn robot(spec: &str, seed: u64) -> Robot {
    let description = Family::parse(spec).unwrap().generate().unwrap();
    Robot::new(&description, "test", ModelOrigin::Generated, STATES, seed).unwrap()
}

/// Robots of every kind of joint, with and without armature, on either base.
fn any_robot() -> impl Strategy<Value = (String, u64)> {
    let tree = (1_usize..14, any::<u32>(), prop::sample::select(vec!["fixed", "free"]), any::<bool>(), 0_u32..=10).prop_map(
        |(n, seed, base, armature, spread)| {
            format!("tree:n={n},seed={seed},base={base},joints=all,armature={armature},spread=0.{spread:02}")
        },
    );
    let named =
        prop::sample::select(vec!["humanoid", "quadruped", "hand", "chain:n=9,layout=spatial", "chain:n=6", "joints:kind=mixed,base=free"]);
    (prop_oneof![3 => tree, 1 => named.prop_map(str::to_owned)], any::<u64>())
}

/// The same robots and states in every run.
fn cases(count: u32) -> ProptestConfig {
    ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(count) }
}

/// A unit of mass and one of length, in kg and m. All numbers of a robot are divided by them; seconds are unchanged.
#[derive(Clone, Copy)]
struct Units {
    mass: f64,
    length: f64,
}

impl Units {
    /// The factor of each dof's rate: angles have no unit.
    fn rates(self, description: &Description) -> Vec<f64> {
        let of = |kind: JointType| match kind {
            JointType::Prismatic { .. } => vec![self.length],
            JointType::Planar => vec![self.length, self.length, 1.0],
            JointType::Free => vec![self.length, self.length, self.length, 1.0, 1.0, 1.0],
            other => vec![1.0; other.nv()],
        };
        description.bodies.iter().flat_map(|body| of(body.joint.kind)).collect()
    }

    /// The factor of moments; energies have the same unit.
    fn moment(self) -> f64 {
        self.mass * self.length * self.length
    }

    /// The same robot at the same states, in these units.
    fn convert(self, robot: &Robot) -> Robot {
        let Self { mass, length } = self;
        let rates = self.rates(&robot.description);
        let mut other = robot.clone();
        let description = &mut other.description;
        description.gravity = description.gravity.map(|g| g * length);
        let mut rate = rates.iter();
        for body in &mut description.bodies {
            body.mass *= mass;
            body.com = body.com.map(|x| x * length);
            body.inertia = body.inertia.map(|x| x * self.moment());
            body.joint.placement.translation = body.joint.placement.translation.map(|x| x * length);
            if let JointType::Helical { pitch, .. } = &mut body.joint.kind {
                *pitch *= length;
            }
            let of_joint: Vec<f64> = rate.by_ref().take(body.joint.kind.nv()).copied().collect();
            body.joint.armature.iter_mut().zip(&of_joint).for_each(|(armature, rate)| *armature *= self.moment() / (rate * rate));
        }
        other.model = Model::build(description).unwrap();
        let states = &mut other.states;
        for q in states.q.chunks_exact_mut(states.nq) {
            for joint in other.model.topology.joints() {
                match joint.kind {
                    JointKind::Prismatic(_) => q[joint.q] *= length,
                    JointKind::Free => q[joint.q..joint.q + 3].iter_mut().for_each(|x| *x *= length),
                    _ => (),
                }
            }
        }
        let nv = states.nv;
        let scale = |all: &mut Vec<f64>, factor: &dyn Fn(usize) -> f64| all.iter_mut().enumerate().for_each(|(k, x)| *x *= factor(k));
        scale(&mut states.v, &|k| rates[k % nv]);
        scale(&mut states.a, &|k| rates[k % nv]);
        scale(&mut states.tau, &|k| self.moment() / rates[k % nv]);
        scale(&mut states.wrench, &|k| if k % 6 < 3 { self.moment() } else { mass * length });
        other
    }

    /// The factor of each number of a quantity.
    fn of(self, robot: &Robot, quantity: Quantity) -> Vec<f64> {
        let Self { mass, length } = self;
        let rates = self.rates(&robot.description);
        let forces: Vec<f64> = rates.iter().map(|rate| self.moment() / rate).collect();
        let bodies = robot.description.bodies.len();
        match quantity {
            Quantity::InverseDynamics | Quantity::InverseDynamicsWrench | Quantity::Bias => forces,
            Quantity::MassMatrix => forces.iter().flat_map(|force| rates.iter().map(move |rate| force / rate)).collect(),
            Quantity::KineticEnergy | Quantity::PotentialEnergy => vec![self.moment()],
            Quantity::CenterOfMass => vec![length; 3],
            Quantity::Momentum => [[self.moment(); 3], [mass * length; 3]].concat(),
            Quantity::BodyPlacement => [vec![1.0; 9], vec![length; 3]].concat().repeat(bodies),
            Quantity::BodyVelocity | Quantity::BodyAcceleration => [[1.0; 3], [length; 3]].concat().repeat(bodies),
            Quantity::BodyJacobian => {
                [1.0, length].into_iter().flat_map(|unit| rates.iter().map(move |rate| unit / rate).collect::<Vec<_>>().repeat(3)).collect()
            }
            Quantity::Readback => {
                [vec![mass], vec![length; 3], vec![self.moment(); 6], vec![1.0; 9], vec![length; 3]].concat().repeat(bodies)
            }
            _ => unreachable!("{quantity:?} has no measure of its own"),
        }
    }
}

const MEASURED: [Quantity; 13] = [
    Quantity::InverseDynamics,
    Quantity::InverseDynamicsWrench,
    Quantity::Bias,
    Quantity::MassMatrix,
    Quantity::KineticEnergy,
    Quantity::PotentialEnergy,
    Quantity::CenterOfMass,
    Quantity::Momentum,
    Quantity::BodyPlacement,
    Quantity::BodyVelocity,
    Quantity::BodyAcceleration,
    Quantity::BodyJacobian,
    Quantity::Readback,
];

/// A relative error of about a thousandth of either sign. It is never so small that rounding matters.
fn error(random: &mut Random) -> f64 {
    random.uniform(0.5e-3, 1e-3) * if random.bits32() & 1 == 1 { 1.0 } else { -1.0 }
}

/// Whether two errors are equal but for rounding: a difference of a thousandth rounds by 4e-13, scales of some dozen terms by less.
fn same(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= 1e-11 * a.abs().min(b.abs())
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn errors_have_no_unit((spec, seed) in any_robot(), grams in any::<bool>(), millimetres in any::<bool>()) {
        let units = Units { mass: if grams { 1e3 } else { 0.4536 }, length: if millimetres { 1e3 } else { 3.281 } };
        let robot = robot(&spec, seed);
        let other = units.convert(&robot);
        let mut random = Random::named(seed, "errors");
        for k in 0..robot.states.count() {
            let (at, there) = (Magnitudes::new(&robot, k), Magnitudes::new(&other, k));
            for quantity in MEASURED {
                let factors = units.of(&robot, quantity);
                prop_assert_eq!(factors.len(), quantity.size(&robot));
                // Any numbers, if the scale comes from robot and state.
                let reference: Vec<f64> = match quantity {
                    Quantity::MassMatrix => {
                        let matrix = mass_matrix(&robot.model, robot.states.q(k)).unwrap();
                        let n = robot.states.nv;
                        (0..n * n).map(|entry| matrix.get(entry / n, entry % n)).collect()
                    }
                    Quantity::Readback => robot.readback(),
                    _ => factors.iter().map(|_| random.uniform(0.5, 1.5)).collect(),
                };
                let value: Vec<f64> = reference.iter().map(|x| x * (1.0 + error(&mut random))).collect();
                let convert = |values: &[f64]| values.iter().zip(&factors).map(|(x, factor)| x * factor).collect::<Vec<f64>>();
                let here = scaled_error(&robot, quantity, &at, &reference, &value);
                let there = scaled_error(&other, quantity, &there, &convert(&reference), &convert(&value));
                prop_assert!(same(here, there), "{spec}, {quantity:?} at state {k}: {here:e} and {there:e}");
            }
        }
    }

    #[test]
    fn forward_measures_have_no_unit((spec, seed) in any_robot()) {
        let units = Units { mass: 1e3, length: 1e3 };
        let robot = robot(&spec, seed);
        let other = units.convert(&robot);
        let rates = units.rates(&robot.description);
        let convert = |a: &[f64]| a.iter().zip(&rates).map(|(x, rate)| x * rate).collect::<Vec<f64>>();
        let (at, there) = (robot.magnitudes(), other.magnitudes());
        let mut random = Random::named(seed, "forward");
        for (k, (here, there)) in ForwardScale::all(&robot, &at).iter().zip(ForwardScale::all(&other, &there)).enumerate() {
            let states = &robot.states;
            let a = forward_dynamics(&robot.model, states.q(k), states.v(k), states.tau(k)).unwrap();
            let wrong: Vec<f64> = a.iter().map(|x| x * (1.0 + error(&mut random))).collect();
            // Eigenvalues have relative errors of κ·ε, solutions their amplified rounding; a factor of a hundred covers the number of
            // terms.
            let rounding = 100.0 * f64::EPSILON * (here.condition + here.amplification);
            let close = |a: f64, b: f64| a == b || (a - b).abs() <= rounding * a.abs();
            prop_assert!(close(here.condition, there.condition), "{spec}: {} and {}", here.condition, there.condition);
            prop_assert!(close(here.amplification, there.amplification), "{spec}: {} and {}", here.amplification, there.amplification);
            let (e, f) = (here.backward_error(&wrong), there.backward_error(&convert(&wrong)));
            // Relative to their terms, residuals have the rounding that the gate on them allows.
            prop_assert!((e - f).abs() <= 1e-14 * robot.depth as f64, "{spec}: backward {e:e} and {f:e}");
            let (e, f) = (here.forward_error(&a, &wrong), there.forward_error(&convert(&a), &convert(&wrong)));
            prop_assert!(close(e, f) || same(e, f), "{spec}: forward {e:e} and {f:e}");
        }
    }

    /// A sum of magnitudes is at least as large as the magnitude of the sum. Rounding may reduce it a little if there is only one term.
    #[test]
    fn magnitudes_bound_their_sums((spec, seed) in any_robot()) {
        let robot = robot(&spec, seed);
        let (model, states) = (&robot.model, &robot.states);
        let below = |value: f64, magnitude: f64| value.abs() <= magnitude * (1.0 + 1e-12);
        for (k, at) in robot.magnitudes().iter().enumerate() {
            let (q, v, a) = (states.q(k), states.v(k), states.a(k));
            let motion = forward_kinematics(model, q, v, a).unwrap();
            for (body, moves) in motion.iter().enumerate() {
                for (what, value, magnitude) in [
                    ("placement", moves.placement.translation, at.reach[body]),
                    ("angular velocity", moves.velocity.ang, at.angular_velocity[body]),
                    ("velocity", moves.velocity.lin, at.linear_velocity[body]),
                    ("angular acceleration", moves.acceleration.ang, at.angular_acceleration[body]),
                    ("acceleration", moves.acceleration.lin, at.linear_acceleration[body]),
                ] {
                    prop_assert!(below(value.norm(), magnitude), "{spec}: {what} of body {body} at state {k}: {} > {magnitude}", value.norm());
                }
            }
            let mut wrenches = vec![featherbench_spatial::Force::zero(); model.topology.bodies()];
            for (&body, w) in model.described.iter().zip(states.wrench(k).chunks_exact(6)) {
                wrenches[body] = featherbench_spatial::Force::from_array([w[0], w[1], w[2], w[3], w[4], w[5]]);
            }
            let mut wrenched = vec![0.0; states.nv];
            Rnea::new(&model.topology).run(model, q, v, a, Some(&wrenches), &mut wrenched).unwrap();
            for (what, forces, magnitudes) in [
                ("id", inverse_dynamics(model, q, v, a).unwrap(), &at.joint_force),
                ("id_wrench", wrenched, &at.joint_force_wrench),
                ("bias", bias_force(model, q, v).unwrap(), &at.bias_force),
            ] {
                for (dof, (force, magnitude)) in forces.iter().zip(magnitudes).enumerate() {
                    prop_assert!(below(*force, *magnitude), "{spec}: {what} of dof {dof} at state {k}: {force} > {magnitude}");
                }
            }
        }
    }

    /// The forward error of any answer is at most its backward error times the amplification. The reference's share of the factor two
    /// covers the reference's rounding.
    #[test]
    fn no_forward_error_exceeds_its_amplification((spec, seed) in any_robot(), decades in 1_i32..10) {
        let robot = robot(&spec, seed);
        let (states, at) = (&robot.states, robot.magnitudes());
        let size = 10.0_f64.powi(-decades);
        let mut random = Random::named(seed, "answers");
        for (k, scale) in ForwardScale::all(&robot, &at).iter().enumerate() {
            let a = forward_dynamics(&robot.model, states.q(k), states.v(k), states.tau(k)).unwrap();
            let wrong: Vec<f64> = a.iter().map(|x| x * (1.0 + size * random.uniform(-1.0, 1.0))).collect();
            let (forward, backward) = (scale.forward_error(&a, &wrong), scale.backward_error(&wrong));
            // The denominators of the backward error are those of the wrong answer: larger by its error.
            let bound = scale.amplification * backward * (1.0 + size);
            prop_assert!(forward <= bound, "{spec} at state {k}: {forward:e} > {bound:e}");
            prop_assert!(scale.backward_error(&a) <= 1e-14 * robot.depth as f64, "{spec}: our own answer");
        }
    }
}

/// An answer to a robot with a perturbation η has at most the backward error η, and its forward error is bounded accordingly: M and τ are
/// perturbed at random. If all terms of one row are perturbed in the same direction, the backward error is η, no less.
#[test]
fn a_perturbation_of_a_known_size_is_seen_in_that_size() {
    let (checked, left_out) = (Cell::new(0), Cell::new(0));
    let result = TestRunner::new(cases(200)).run(&(any_robot(), 5_i32..10), |((spec, seed), decades)| {
        let robot = robot(&spec, seed);
        let (model, states, at) = (&robot.model, &robot.states, robot.magnitudes());
        let eta = 10.0_f64.powi(-decades);
        let mut random = Random::named(seed, "perturbations");
        for (k, scale) in ForwardScale::all(&robot, &at).iter().enumerate() {
            // A perturbation beyond the smallest eigenvalue is another question.
            if eta * scale.condition > 1e-3 {
                left_out.set(left_out.get() + 1);
                continue;
            }
            checked.set(checked.get() + 1);
            let (q, v, tau) = (states.q(k), states.v(k), states.tau(k));
            let matrix = mass_matrix(model, q).unwrap();
            let root: Vec<f64> = matrix.diagonal().map(f64::sqrt).collect();
            let h = bias_force(model, q, v).unwrap();
            let exact = forward_dynamics(model, q, v, tau).unwrap();
            // Accelerations with M_ij changed by η·m(i, j)·√(M_ii·M_jj), and the right-hand side by η·r(i).
            let off = |m: &mut dyn FnMut(usize, usize) -> f64, r: &mut dyn FnMut(usize) -> f64| {
                let perturbed = TreeSparse::from_fn(&model.topology, |i, j| matrix.get(i, j) + eta * m(i, j) * root[i] * root[j]);
                let mut a: Vec<f64> = (0..states.nv).map(|i| tau[i] - h[i] + eta * r(i)).collect();
                let factors: Ltdl<f64> = perturbed.into_ltdl().unwrap();
                factors.solve(&mut a).unwrap();
                a
            };
            let mut sides = random.clone();
            let a = off(&mut |_, _| random.uniform(-1.0, 1.0), &mut |i| sides.uniform(-1.0, 1.0) * tau[i]);
            // Solving rounds by about 1e-14, a fraction of η.
            let allowed = eta * (1.0 + 1e-3);
            let backward = scale.backward_error(&a);
            prop_assert!(backward <= allowed, "{spec} at state {k}: {backward:e} > {eta:e}");
            let forward = scale.forward_error(&exact, &a);
            prop_assert!(forward <= allowed * scale.amplification, "{spec} at state {k}: {forward:e} > {:e}", eta * scale.amplification);

            let row = random.below(states.nv);
            let aligned = off(
                &mut |i, j| match (i == row, j == row) {
                    (true, _) => exact[j].signum(),
                    (_, true) => exact[i].signum(),
                    _ => 0.0,
                },
                &mut |i| if i == row { -tau[i].abs() - at[k].bias_force[i] } else { 0.0 },
            );
            // η·κ is at most a thousandth. So are the effects of rounding, and of other signs of numbers near zero.
            let backward = scale.backward_error(&aligned);
            prop_assert!(backward <= allowed && backward >= 0.99 * eta, "{spec} at state {k}, row {row}: {backward:e}, not {eta:e}");
        }
        Ok(())
    });
    result.unwrap_or_else(|failure| panic!("{failure}"));
    let (checked, left_out) = (checked.get(), left_out.get());
    assert_eq!(checked + left_out, 200 * STATES);
    assert!(checked > 150 * STATES, "{checked} states checked, {left_out} conditioned too badly");
    println!("{checked} states checked, {left_out} conditioned too badly");
}

#[test]
fn no_fold_loses_what_is_not_a_number() {
    assert!(worst(f64::NAN, 1.0).is_nan() && worst(1.0, f64::NAN).is_nan());
    assert_eq!(worst(1.0, f64::INFINITY), f64::INFINITY);
    assert_eq!((ratio(0.0, 0.0), ratio(1e-300, 0.0), ratio(-2.0, 4.0)), (0.0, f64::INFINITY, 0.5));
    assert!(ratio(f64::NAN, 1.0).is_nan() && ratio(1.0, f64::NAN).is_nan() && ratio(0.0, f64::NAN).is_nan());
    let robot = robot("joints:kind=mixed,base=free", 1);
    let at = Magnitudes::new(&robot, 0);
    for quantity in Quantity::ALL {
        let reference = vec![1.0; quantity.size(&robot)];
        assert_eq!(scaled_error(&robot, quantity, &at, &reference, &reference), 0.0, "{quantity:?}");
        for entry in [0, reference.len() / 2, reference.len() - 1] {
            let mut value = reference.clone();
            value[entry] = f64::NAN;
            assert!(scaled_error(&robot, quantity, &at, &reference, &value).is_nan(), "{quantity:?}");
        }
        let more = [&reference[..], &[1.0]].concat();
        let fewer = &reference[1..];
        for (reference, value) in
            [(&reference[..], fewer), (&reference, &more), (fewer, &reference), (&more, &reference), (fewer, fewer), (&more, &more)]
        {
            assert_eq!(
                scaled_error(&robot, quantity, &at, reference, value),
                f64::INFINITY,
                "{quantity:?}: one number too few or too many"
            );
        }
    }
}

/// Tree-sparse layouts are measured like the dense M, and factors by the matrix that they multiply to.
#[test]
fn factors_are_measured_by_their_product() {
    for spec in ["humanoid", "tree:n=9,seed=2,base=free,armature=true", "chain:n=6"] {
        let robot = robot(spec, 1);
        let (topology, at) = (&robot.model.topology, &robot.magnitudes()[0]);
        let sparse = mass_matrix(&robot.model, robot.states.q(0)).unwrap();
        let mass = sparse.to_dense();
        let error = |quantity, reference: &[f64], value: &[f64]| scaled_error(&robot, quantity, at, reference, value);
        let factors = sparse.clone().into_ltdl().unwrap().factors().values().to_vec();
        assert_eq!(error(Quantity::Factorization, &factors, &factors), 0.0);

        // A factor on D is the same factor on M, and no entry is larger than its diagonal ones.
        let mut scaled = factors.clone();
        (0..topology.nv()).for_each(|k| scaled[topology.row(k).end - 1] *= 1.0 + 1e-6);
        let found = error(Quantity::Factorization, &factors, &scaled);
        assert!((found - 1e-6).abs() < 1e-12, "{spec}: {found}");

        // A change of any entry of L changes an entry of M, weighted by D.
        let last = topology.nv() - 1;
        let (row, mut wrong) = (topology.row(last), factors.clone());
        wrong[row.start] += 1e-6;
        let (first, pivot) = (topology.row_dofs(last)[0], factors[row.end - 1]);
        let found = error(Quantity::Factorization, &factors, &wrong);
        assert!(found >= 0.99e-6 * pivot / (mass[(first, first)] * mass[(last, last)]).sqrt(), "{spec}: {found}");

        let mut other = sparse.values().to_vec();
        other[row.start] += 1e-6;
        let mut dense = mass.clone();
        dense[(last, first)] += 1e-6;
        dense[(first, last)] += 1e-6;
        let whole = error(Quantity::MassMatrix, mass.as_slice(), dense.as_slice());
        assert_eq!(error(Quantity::MassMatrixSparse, sparse.values(), &other), whole);
        for quantity in [Quantity::MassMatrixSparse, Quantity::Factorization] {
            assert_eq!(error(quantity, &factors, &factors[1..]), f64::INFINITY);
        }
    }
}
