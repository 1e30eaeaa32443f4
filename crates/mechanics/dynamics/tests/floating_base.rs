//! The partitioned mass matrix of robots with a floating base: against sums over bodies, dense block elimination in double-double, the
//! articulated-body algorithm, and conservation of momentum.

use crate::common;

use common::dense::{Dense, off};
use common::{ROBOTS, condition, describe, generated, lifted, robot, topology, within};
use featherbench_dynamics::{
    BaseBlocks, Error, FloatingBase, NoFloatingBase, NotPositiveDefinite, PartitionError, TreeSparse, bias_force, centroidal_momentum,
    forward_dynamics, forward_kinematics, mass_matrix,
};
use featherbench_model::{Axis, Description, JointKind, Model};
use featherbench_robots::StateBatch;
use featherbench_spatial::{Counted, DoubleDouble, Dual, Mat3, Operations, Real, Sym3, Vec3};
use wide::f64x4;

/// Robots with a floating base.
fn floating() -> Vec<(String, Description)> {
    let families = [
        "humanoid",
        "quadruped",
        "chain:n=20,layout=spatial,base=free",
        "chain:n=1,base=free",
        "chain:n=12,layout=spatial,base=free,tip_scale=1000.0",
        "tree:n=30,base=free",
        "joints:kind=spherical,base=free,shape=branched",
    ];
    let mut robots: Vec<_> = families.iter().map(|name| ((*name).to_owned(), describe(name))).collect();
    robots.push((ROBOTS[7].0.to_owned(), robot(&ROBOTS[7].1, 11)));
    robots
}

fn models() -> impl Iterator<Item = (String, Model<f64>)> {
    floating().into_iter().map(|(name, description)| (name, Model::build(&description).unwrap()))
}

/// Gravity and velocity do not act, and one joint force does: the accelerations are a column of M⁻¹.
fn weightless(model: &Model<f64>) -> Model<f64> {
    Model { gravity: Vec3::zero(), ..model.clone() }
}

fn joint_block(m: &TreeSparse<f64>) -> Dense {
    Dense::from_fn(m.size() - 6, |i, j| m.get(i + 6, j + 6).into())
}

/// `A_own − A_off A_other⁻¹ A_offᵀ` in double-double: the complement of one block of M, rows `own`.
fn complement(m: &TreeSparse<f64>, own: std::ops::Range<usize>, other: std::ops::Range<usize>) -> Dense {
    let block = Dense::from_fn(other.len(), |i, j| m.get(other.start + i, other.start + j).into());
    let columns: Vec<Vec<DoubleDouble>> =
        own.clone().map(|i| block.clone().solve(&other.clone().map(|j| m.get(i, j)).collect::<Vec<_>>()).0).collect();
    Dense::from_fn(own.len(), |i, j| {
        let off = |sum: DoubleDouble, k: usize| sum - columns[j][k] * m.get(own.start + i, other.start + k).into();
        (0..other.len()).fold(m.get(own.start + i, own.start + j).into(), off)
    })
}

fn dense6(matrix: [[f64; 6]; 6]) -> Dense {
    Dense::from_fn(6, |i, j| matrix[i][j].into())
}

/// What a factorization in `f64` of a part of M may lose: κ of M scaled to a unit diagonal, times roundings.
fn tolerance(m: &TreeSparse<f64>) -> f64 {
    8.0 * f64::EPSILON * condition(m)
}

/// M_bb from the description alone: masses, centres and inertias of all bodies where forward kinematics puts them.
#[test]
fn the_base_block_is_the_composite_inertia_by_direct_sum() {
    for (name, description) in floating() {
        let model: Model<f64> = Model::build(&description).unwrap();
        let states = StateBatch::random(&model, 3, 4);
        let still = vec![0.0; model.topology.nv()];
        for k in 0..states.count() {
            let m = mass_matrix(&model, states.q(k)).unwrap();
            let blocks = BaseBlocks::of(&model.topology, &m).unwrap();
            let places = forward_kinematics(&model, states.q(k), &still, &still).unwrap();
            let base = places.body(0).unwrap().placement.inverse();
            let (mut mass, mut moment, mut inertia) = (0.0, Vec3::zero(), Sym3::zero());
            for (body, &compiled) in description.bodies.iter().zip(&model.described) {
                let place = base.compose(&places.body(compiled).unwrap().placement);
                let com = place.point(Vec3::from_array(body.com));
                mass += body.mass;
                moment += com * body.mass;
                inertia = inertia + Sym3::from_array(body.inertia).rotate(place.rotation) + Sym3::point_mass(body.mass, com);
            }
            let (cross, inertia) = (Mat3::skew(moment).to_array(), inertia.to_mat3().to_array());
            let expected = Dense::from_fn(6, |i, j| {
                let entry = match (i < 3, j < 3) {
                    (true, true) => {
                        if i == j {
                            mass
                        } else {
                            0.0
                        }
                    }
                    (true, false) => -cross[3 * i + j - 3],
                    (false, true) => cross[3 * (i - 3) + j],
                    (false, false) => inertia[3 * (i - 3) + j - 3],
                };
                entry.into()
            });
            // The frames on a path of d bodies are multiplied, and as many bodies summed.
            let terms = 4.0 * model.topology.bodies() as f64;
            within(&name, expected.distance(&dense6(blocks.base())), terms * f64::EPSILON);
        }
    }
}

/// The views are the entries of M, and the numbers are not copied.
#[test]
fn blocks_are_views_of_the_matrix() {
    for (name, model) in models() {
        let m = mass_matrix(&model, StateBatch::random(&model, 1, 4).q(0)).unwrap();
        let blocks = BaseBlocks::of(&model.topology, &m).unwrap();
        let (base, n) = (blocks.base(), m.size());
        assert_eq!(blocks.joint_dofs(), n - 6, "{name}");
        for i in 6..n {
            for (j, entry) in blocks.coupling(i).iter().enumerate() {
                assert_eq!(*entry, m.get(i, j), "{name}");
            }
            assert!(std::ptr::eq(blocks.coupling(i).as_ptr(), &m.values()[model.topology.row(i).start]), "{name}: a view");
            let ancestors = &model.topology.row_dofs(i)[6..];
            assert_eq!(blocks.joint_row(i).len(), ancestors.len(), "{name}");
            for (entry, &j) in blocks.joint_row(i).iter().zip(ancestors) {
                assert_eq!((*entry, *entry), (m.get(i, j), blocks.joints(j, i)), "{name}");
            }
        }
        for (i, row) in base.iter().enumerate() {
            assert_eq!(row.to_vec(), (0..6).map(|j| m.get(i, j)).collect::<Vec<_>>(), "{name}");
        }
    }
}

/// By its definition in double-double, and by the articulated-body algorithm, for which it is a unit force's acceleration that is known.
#[test]
fn the_complement_of_the_joints_is_the_articulated_inertia() {
    for (name, model) in models() {
        let states = StateBatch::random(&model, 3, 4);
        let mut workspace = FloatingBase::new(&model.topology).unwrap();
        let (free, still) = (weightless(&model), vec![0.0; model.topology.nv()]);
        for k in 0..states.count() {
            let m = mass_matrix(&model, states.q(k)).unwrap();
            workspace.run(&m).unwrap();
            let found = workspace.articulated_inertia();
            let truth = complement(&m, 0..6, 6..m.size());
            within(&format!("{name}: by definition"), truth.distance(&dense6(found)), tolerance(&m));
            // S_bb a_b = e_i where a_b is the base's acceleration under a unit force on it
            for i in 0..6 {
                let mut unit = still.clone();
                unit[i] = 1.0;
                let a = forward_dynamics(&free, states.q(k), &still, &unit).unwrap();
                let force = dense6(found).mul(&a[..6]);
                for (row, force) in force.iter().enumerate() {
                    let expected = if row == i { 1.0 } else { 0.0 };
                    // a_i is a diagonal entry of the inverse: so the measure has no unit.
                    let size = (found[row][row] * a[i]).sqrt();
                    within(&format!("{name}: by ABA, force {i}"), (force.to_f64() - expected).abs() / size, 8.0 * tolerance(&m));
                }
            }
        }
    }
}

/// By its definition in double-double; its inverse is the joint block of M⁻¹; and it is dense: limbs couple through the base.
#[test]
fn the_complement_of_the_base_is_dense_and_inverts_to_the_joint_block() {
    for (name, model) in models() {
        let m = mass_matrix(&model, StateBatch::random(&model, 1, 4).q(0)).unwrap();
        let (n, all) = (m.size() - 6, m.size());
        let mut workspace = FloatingBase::new(&model.topology).unwrap();
        workspace.run(&m).unwrap();
        let mut found = vec![f64::NAN; n * n];
        workspace.joint_complement(&mut found).unwrap();
        let truth = complement(&m, 6..all, 0..6);
        let dense = Dense::from_fn(n, |i, j| found[i * n + j].into());
        // Relative to M_jj: what is subtracted is as large.
        let scale = joint_block(&m);
        let gap = Dense::from_fn(n, |i, j| scale.at(i, j) + dense.at(i, j) - truth.at(i, j));
        within(&format!("{name}: by definition"), scale.distance(&gap), tolerance(&m));
        assert!(found.iter().all(|entry| *entry != 0.0), "{name}: joints of different limbs couple");

        let mut inverse = vec![0.0; all * all];
        workspace.factors().inverse(&mut inverse).unwrap();
        let block = Dense::from_fn(n, |i, j| inverse[(i + 6) * all + j + 6].into());
        let product = dense.times(&block);
        for i in 0..n {
            for j in 0..n {
                let expected = if i == j { 1.0 } else { 0.0 };
                let size = (scale.at(i, i) * block.at(j, j)).to_f64().sqrt();
                within(
                    &format!("{name}: inverse ({i}, {j})"),
                    (product.at(i, j).to_f64() - expected).abs() / size,
                    n as f64 * tolerance(&m),
                );
            }
        }
    }
}

#[test]
fn the_base_accelerates_as_the_articulated_body_algorithm_says() {
    for (name, model) in models() {
        let states = StateBatch::random(&model, 5, 4);
        let mut workspace = FloatingBase::new(&model.topology).unwrap();
        for k in 0..states.count() {
            let (q, v, tau) = (states.q(k), states.v(k), states.tau(k));
            let m = mass_matrix(&model, q).unwrap();
            workspace.run(&m).unwrap();
            let h = bias_force(&model, q, v).unwrap();
            let forces: Vec<f64> = tau.iter().zip(&h).map(|(tau, h)| tau - h).collect();
            let found = workspace.base_acceleration(&forces).unwrap();
            // M a = f by elimination in another order, in double-double
            let (truth, _) = Dense::of(&m).solve(&forces);
            within(&format!("{name}: elimination"), off(&found, &truth[..6]), 8.0 * tolerance(&m));
            let aba = forward_dynamics(&model, q, v, tau).unwrap();
            // h has roundings of its own: of sums that are larger than it is.
            let scale = common::largest(&aba[..6]);
            within(&format!("{name}: ABA"), common::distance(&found, &aba[..6]) / scale, 64.0 * tolerance(&m));
        }
    }
}

#[test]
fn every_scalar_has_the_same_text() {
    for (name, model) in models() {
        let states = StateBatch::random(&model, 1, 4);
        let t = &model.topology;
        let m = mass_matrix(&model, states.q(0)).unwrap();
        let mut slow = FloatingBase::new(t).unwrap();
        slow.run(&TreeSparse::from_fn(t, |i, j| Counted(m.get(i, j)))).unwrap();
        let mut fours = FloatingBase::new(t).unwrap();
        fours.run(&TreeSparse::from_fn(t, |i, j| f64x4::splat(m.get(i, j)))).unwrap();
        let bound = tolerance(&m);
        // The factors of lanes are products with 1/D.
        let lane = fours.articulated_inertia().map(|row| row.map(|x| x.to_array()[2]));
        let plain = slow.articulated_inertia().map(|row| row.map(|x| x.0));
        within(&format!("{name}: lane"), dense6(plain).distance(&dense6(lane)), bound);
        // Of t M, S_bb and S_jj have the derivatives S_bb and S_jj, and a base acceleration that of −a.
        let mut dual = FloatingBase::new(t).unwrap();
        dual.run(&TreeSparse::from_fn(t, |i, j| Dual::new(m.get(i, j), m.get(i, j)))).unwrap();
        for x in dual.articulated_inertia().as_flattened() {
            within(&format!("{name}: S_bb"), (x.derivative - x.value).abs() / m.get(0, 0), bound);
        }
        let f: Vec<Dual<f64>> = lifted(states.tau(0));
        let a = dual.base_acceleration(&f).unwrap();
        let scale = common::largest(&a.map(|a| a.value));
        for a in a {
            within(&format!("{name}: a_b"), (a.derivative + a.value).abs() / scale, bound);
        }
        let n = t.nv() - 6;
        let mut complement = vec![Dual::zero(); n * n];
        dual.joint_complement(&mut complement).unwrap();
        let scale = common::largest(&complement.iter().map(|x| x.value).collect::<Vec<_>>());
        for x in &complement {
            within(&format!("{name}: S_jj"), (x.derivative - x.value).abs() / scale, bound);
        }
    }
}

/// The table in the file's head.
#[test]
fn counts() {
    for (name, model) in models() {
        let t = &model.topology;
        let m = mass_matrix(&model, StateBatch::random(&model, 1, 4).q(0)).unwrap();
        let mut workspace = FloatingBase::new(t).unwrap();
        workspace.run(&TreeSparse::from_fn(t, |i, j| Counted(m.get(i, j)))).unwrap();
        let (joints, d1) = (t.nv() as u64 - 6, (t.stored() - t.nv()) as u64);
        let none = Operations::default();
        let inertia = Counted::count(|| assert!(workspace.articulated_inertia()[0][0].0 > 0.0));
        assert_eq!(inertia, Operations { fused: 56, multiplications: 56, ..none }, "{name}");
        let f: Vec<Counted> = lifted(&vec![1.0; t.nv()]);
        let acceleration = Counted::count(|| assert!(workspace.base_acceleration(&f).is_ok()));
        assert_eq!(acceleration, Operations { fused: d1 + 15, divisions: 6, ..none }, "{name}");
        let mut out = vec![Counted(0.0); (joints * joints) as usize];
        let complement = Counted::count(|| workspace.joint_complement(&mut out).unwrap());
        let expected = Operations { fused: 35 + 15 * joints + 3 * joints * (joints + 1), divisions: 15 + 6 * joints, ..none };
        assert_eq!(complement, expected, "{name}");
    }
}

#[test]
fn robots_without_one_floating_base_are_refused() {
    use JointKind::{Free, Revolute};
    let hinge = Revolute(Axis::Z);
    for (tree, expected) in [
        (vec![], NoFloatingBase::Fixed),
        (vec![(-1, hinge), (0, Free)], NoFloatingBase::Fixed),
        (vec![(-1, Free), (0, hinge), (-1, hinge)], NoFloatingBase::SecondRoot { body: 2 }),
        (vec![(-1, Free), (-1, Free)], NoFloatingBase::SecondRoot { body: 1 }),
    ] {
        let t = topology(&tree);
        assert_eq!(FloatingBase::<f64>::new(&t).unwrap_err(), expected);
        assert_eq!(BaseBlocks::of(&t, &TreeSparse::<f64>::new(&t)).unwrap_err(), PartitionError::NoFloatingBase(expected));
    }
    let t = topology(&[(-1, Free), (0, hinge), (0, hinge)]);
    let other = topology(&[(-1, Free), (0, hinge), (1, hinge)]);
    assert!(matches!(BaseBlocks::of(&t, &TreeSparse::<f64>::new(&other)).unwrap_err(), PartitionError::Dimension(_)));
    let mut workspace = FloatingBase::<f64>::new(&t).unwrap();
    assert!(matches!(workspace.run(&TreeSparse::new(&other)), Err(Error::Dimension(_))));
    assert_eq!(workspace.base_acceleration(&[0.0; 7]).unwrap_err().expected, 8);
    assert!(matches!(workspace.joint_complement(&mut [0.0; 3]), Err(Error::Dimension(_))));
    // Armature alone: the joints can be eliminated, the base cannot.
    let massless = TreeSparse::from_fn(&t, |i, j| if i == j && i >= 6 { 1.0 } else { 0.0 });
    let refused = Error::NotPositiveDefinite(NotPositiveDefinite { dof: 5, pivot: 0.0 });
    assert_eq!(workspace.run(&massless).unwrap_err(), refused);
    assert_eq!(workspace.joint_complement(&mut [0.0; 4]).unwrap_err(), refused);
    // A base alone.
    let lone = topology(&[(-1, Free)]);
    let mut workspace = FloatingBase::<f64>::new(&lone).unwrap();
    workspace.run(&TreeSparse::from_fn(&lone, |i, j| if i == j { 2.0 } else { 0.0 })).unwrap();
    workspace.joint_complement(&mut []).unwrap();
    assert_eq!(workspace.base_acceleration(&[4.0; 6]).unwrap(), [2.0; 6]);
}

/// dq/dt and dv/dt of a robot that only its joints push.
fn rate(model: &Model<f64>, tau: &[f64], q: &[f64], v: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let velocities = common::flow(model, q, v).iter().map(|x| x.derivative).collect();
    (velocities, forward_dynamics(model, q, v, tau).unwrap())
}

/// The state after `steps` steps of the classical Runge–Kutta method of order 4; quaternions are normalized after each.
fn integrate(model: &Model<f64>, tau: &[f64], mut q: Vec<f64>, mut v: Vec<f64>, time: f64, steps: usize) -> (Vec<f64>, Vec<f64>) {
    let dt = time / steps as f64;
    let along = |x: &[f64], dx: &[f64], h: f64| x.iter().zip(dx).map(|(x, dx)| x + h * dx).collect::<Vec<_>>();
    for _ in 0..steps {
        let (q1, v1) = rate(model, tau, &q, &v);
        let (q2, v2) = rate(model, tau, &along(&q, &q1, dt / 2.0), &along(&v, &v1, dt / 2.0));
        let (q3, v3) = rate(model, tau, &along(&q, &q2, dt / 2.0), &along(&v, &v2, dt / 2.0));
        let (q4, v4) = rate(model, tau, &along(&q, &q3, dt), &along(&v, &v3, dt));
        for (x, slopes) in [(&mut q, [q1, q2, q3, q4]), (&mut v, [v1, v2, v3, v4])] {
            for (k, x) in x.iter_mut().enumerate() {
                *x += dt / 6.0 * (slopes[0][k] + 2.0 * slopes[1][k] + 2.0 * slopes[2][k] + slopes[3][k]);
            }
        }
        for joint in model.topology.joints() {
            if joint.kind.nq() != joint.kind.nv() {
                let end = joint.q + joint.kind.nq();
                let quaternion = &mut q[end - 4..end];
                let norm = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
                quaternion.iter_mut().for_each(|x| *x /= norm);
            }
        }
    }
    (q, v)
}

/// Without gravity and external forces the spatial momentum is conserved while the joints push. A trajectory of the humanoid changes it by the
/// error of the integrator alone, which falls by 2⁴ where the step is halved. The centre of mass moves on a line.
#[test]
fn spatial_momentum_is_conserved_at_the_order_of_the_integrator() {
    let humanoid = weightless(&generated("humanoid"));
    let states = StateBatch::random(&humanoid, 1, 6);
    let mut tau = states.tau(0).to_vec();
    tau[..6].fill(0.0);
    assert!(tau[6..].iter().all(|tau| *tau != 0.0), "every joint pushes");
    let momentum = |q: &[f64], v: &[f64]| centroidal_momentum(&humanoid, q, v).unwrap();
    let before = momentum(states.q(0), states.v(0));
    let time = 0.0625;
    let mut errors = Vec::new();
    for steps in [16, 32, 64, 128] {
        let (q, v) = integrate(&humanoid, &tau, states.q(0).to_vec(), states.v(0).to_vec(), time, steps);
        let after = momentum(&q, &v);
        assert!(common::distance(&v, states.v(0)) > 1.0, "the robot moves");
        let moved = before.center.position + before.momentum.lin * (time / before.center.mass);
        errors.push([
            (after.momentum.ang - before.momentum.ang).norm() / before.momentum.ang.norm(),
            (after.momentum.lin - before.momentum.lin).norm() / before.momentum.lin.norm(),
            (after.center.position - moved).norm(),
        ]);
    }
    for k in 0..3 {
        let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0][k] / pair[1][k]).log2()).collect();
        println!("{k}: {:?}, orders {orders:?}", errors.iter().map(|error| error[k]).collect::<Vec<_>>());
        // The order is 4 up to O(dt): its distance halves from pair to pair, and was 0.02 at the first.
        within(&format!("order of {k}"), (orders[orders.len() - 1] - 4.0).abs(), 0.05);
    }
}
