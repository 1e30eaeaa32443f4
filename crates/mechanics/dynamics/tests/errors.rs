//! Bad input gives an error, never a panic: wrong shapes, singular matrices, NaN.

use crate::common;

use common::{ROBOTS, build, dyadic_chain};
use featherbench_dynamics::{
    Aba, Bias, CenterOfMass, Crba, DimensionError, Energy, Error, Jacobian, Kinematics, Ltdl, Momentum, NotPositiveDefinite, Refined, Rnea,
    TreeSparse, forward_dynamics, inverse_dynamics, mass_matrix,
};
use featherbench_model::{Axis, BodyDescription, Description, JointDescription, JointKind, JointType, Model};
use featherbench_robots::{Case, StateBatch};
use featherbench_spatial::{Compensated, Force, RigidBodyInertia, Sym3, Vec3};

/// What an error names, and what it counted.
fn refusal(result: Result<(), impl Into<Error>>) -> (&'static str, usize, usize) {
    match result.map_err(Into::into) {
        Err(Error::Dimension(DimensionError { what, expected, found })) => (what, expected, found),
        other => panic!("expected a dimension error, got {other:?}"),
    }
}

#[test]
fn each_argument_of_the_wrong_length_is_named() {
    let model = build(&ROBOTS[7].1);
    let t = &model.topology;
    let (nq, nv, bodies) = (t.nq(), t.nv(), t.bodies());
    assert_ne!(nq, nv);
    let (q, x, short) = (vec![0.5; nq], vec![0.5; nv], vec![0.5; nv - 1]);
    let (mut out, mut short_out) = (vec![0.0; nv], vec![0.0; nv - 1]);
    let few = vec![Force::zero(); bodies - 1];
    let (q_len, v_len) = (("configuration q", nq, nv), ("velocity v", nv, nv - 1));
    let (a_len, tau_len) = (("acceleration a", nv, nv - 1), ("joint forces tau", nv, nv - 1));
    let wrench_len = ("external wrenches", bodies, bodies - 1);

    let mut rnea = Rnea::new(t);
    assert_eq!(refusal(rnea.run(&model, &x, &x, &x, None, &mut out)), q_len);
    assert_eq!(refusal(rnea.run(&model, &q, &short, &x, None, &mut out)), v_len);
    assert_eq!(refusal(rnea.run(&model, &q, &x, &short, None, &mut out)), a_len);
    assert_eq!(refusal(rnea.run(&model, &q, &x, &x, None, &mut short_out)), tau_len);
    assert_eq!(refusal(rnea.run(&model, &q, &x, &x, Some(&few), &mut out)), wrench_len);
    let mut bias = Bias::new(t);
    assert_eq!(refusal(bias.run(&model, &x, &x, None, &mut out)), q_len);
    assert_eq!(refusal(bias.run(&model, &q, &short, None, &mut out)), v_len);
    assert_eq!(refusal(bias.run(&model, &q, &x, None, &mut short_out)), tau_len);
    let mut aba = Aba::new(t);
    assert_eq!(refusal(aba.run(&model, &x, &x, &x, None, &mut out)), q_len);
    assert_eq!(refusal(aba.run(&model, &q, &short, &x, None, &mut out)), v_len);
    assert_eq!(refusal(aba.run(&model, &q, &x, &short, None, &mut out)), tau_len);
    assert_eq!(refusal(aba.run(&model, &q, &x, &x, None, &mut short_out)), a_len);
    assert_eq!(refusal(aba.run(&model, &q, &x, &x, Some(&few), &mut out)), wrench_len);
    assert_eq!(refusal(Crba::new(t).run(&model, &x, &mut TreeSparse::new(t))), q_len);
    let mut kinematics = Kinematics::new(t);
    assert_eq!(refusal(kinematics.run(&model, &x, &x, &x)), q_len);
    assert_eq!(refusal(kinematics.run(&model, &q, &short, &x)), v_len);
    assert_eq!(refusal(kinematics.run(&model, &q, &x, &short)), a_len);
    assert!(kinematics.body(bodies).is_none());
    assert_eq!(refusal(Energy::new(t).run(&model, &x, &x).map(drop)), q_len);
    assert_eq!(refusal(Energy::new(t).run(&model, &q, &short).map(drop)), v_len);
    assert_eq!(refusal(Momentum::new(t).run(&model, &x, &x).map(drop)), q_len);
    assert_eq!(refusal(Momentum::new(t).run(&model, &q, &short).map(drop)), v_len);
    assert_eq!(refusal(CenterOfMass::new(t).run(&model, &x).map(drop)), q_len);
    assert_eq!(refusal(Jacobian::new(t).run(&model, &x, 0).map(drop)), q_len);
    let no_such_body = ("bodies, for the one that was named", bodies + 1, bodies);
    assert_eq!(refusal(Jacobian::new(t).run(&model, &q, bodies).map(drop)), no_such_body);

    let matrix = mass_matrix(&model, &q).unwrap();
    assert_eq!(refusal(matrix.mul(&short, &mut out)), ("vector x", nv, nv - 1));
    assert_eq!(refusal(matrix.mul(&x, &mut short_out)), ("vector y", nv, nv - 1));
    let factors = matrix.into_ltdl().unwrap();
    assert_eq!(refusal(factors.solve(&mut short_out)), ("right-hand side x", nv, nv - 1));
    assert_eq!(refusal(factors.inverse(&mut short_out)), ("inverse of the mass matrix", nv * nv, nv - 1));
    assert!(inverse_dynamics(&model, &q, &x, &short).unwrap_err().to_string().contains("acceleration a: expected"));
}

#[test]
fn workspaces_of_another_topology_are_refused() {
    let (model, other) = (build(&ROBOTS[0].1), build(&ROBOTS[1].1));
    let (n, t) = (model.topology.nv(), &other.topology);
    let (q, mut out) = (vec![0.1; n], vec![0.0; n]);
    let expected = ("bodies of the workspace", 8, 6);
    assert_eq!(refusal(Rnea::new(t).run(&model, &q, &q, &q, None, &mut out)), expected);
    assert_eq!(refusal(Bias::new(t).run(&model, &q, &q, None, &mut out)), expected);
    assert_eq!(refusal(Aba::new(t).run(&model, &q, &q, &q, None, &mut out)), expected);
    assert_eq!(refusal(Crba::new(t).run(&model, &q, &mut TreeSparse::new(&model.topology))), expected);
    assert_eq!(refusal(Kinematics::new(t).run(&model, &q, &q, &q)), expected);
    assert_eq!(refusal(Energy::new(t).run(&model, &q, &q).map(drop)), expected);
    assert_eq!(refusal(Momentum::new(t).run(&model, &q, &q).map(drop)), expected);
    assert_eq!(refusal(CenterOfMass::new(t).run(&model, &q).map(drop)), expected);
    assert_eq!(refusal(Jacobian::new(t).run(&model, &q, 0).map(drop)), expected);

    // A matrix of the same size and another shape: a star instead of a chain.
    let chain = dyadic_chain(&[[0.0, 1.0, 0.0]], 4);
    let star = common::topology(&[(-1, JointKind::Revolute(Axis::Z)); 4]);
    let parents = "dofs of the tree-sparse matrix with the model's parent dof";
    assert_eq!(refusal(Crba::new(&chain.topology).run(&chain, &[0.0; 4], &mut TreeSparse::new(&star))), (parents, 4, 1));
    let place = "dofs of the tree-sparse matrix with the same place in the tree";
    assert_eq!(refusal(Ltdl::new(&star).run(&mass_matrix(&chain, &[0.0; 4]).unwrap())), (place, 4, 0));
}

/// Each of these has its own check: the same number of bodies with another number of dofs; more dofs that begin alike; the same number of
/// dofs with other configurations.
#[test]
fn workspaces_and_matrices_that_fit_in_part_are_refused() {
    use JointKind::{Revolute, Spherical};
    let star = |dofs: usize| common::topology(&vec![(-1, Revolute(Axis::Z)); dofs]);
    let model = balls(&[JointType::Spherical, REVOLUTE]);
    let t = &model.topology;
    let q = [0.0, 0.0, 0.0, 1.0, 0.0];
    let pair = star(2);
    assert_eq!((pair.bodies(), pair.nv()), (t.bodies(), 2));
    assert_eq!(refusal(Crba::new(&pair).run(&model, &q, &mut TreeSparse::new(t))), ("dofs of the workspace", 4, 2));
    assert_eq!(refusal(Jacobian::new(&pair).run(&model, &q, 0).map(drop)), ("columns of the workspace", 4, 2));

    // A star of five begins like a star of four, row by row.
    let four = balls(&[REVOLUTE; 4]);
    let dofs = "dofs of the tree-sparse matrix";
    let mut crba = Crba::new(&four.topology);
    assert_eq!(refusal(crba.run(&four, &[0.0; 4], &mut TreeSparse::new(&star(5)))), (dofs, 4, 5));
    assert_eq!(refusal(crba.run(&four, &[0.0; 4], &mut TreeSparse::new(&star(3)))), (dofs, 4, 3));
    assert_eq!(refusal(Ltdl::<f64>::new(&star(4)).run(&TreeSparse::new(&star(5)))), (dofs, 4, 5));
    assert_eq!(refusal(Ltdl::<f64>::new(&star(5)).run(&TreeSparse::new(&star(4)))), (dofs, 5, 4));

    // A quaternion has four numbers and three dofs.
    let ball = balls(&[JointType::Spherical]);
    let (q, x, mut a) = ([0.0, 0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]);
    let mut refine =
        |topology: &featherbench_model::Topology| refusal(Refined::<Compensated>::new(topology, 1).run(&ball, &q, &x, &x, None, &mut a));
    assert_eq!(refine(&star(3)), ("configuration numbers of the workspace", 4, 3));
    assert_eq!(refine(&star(4)), ("dofs of the workspace", 3, 4));
    assert_eq!(refine(&common::topology(&[(-1, Spherical), (0, Spherical)])), ("configuration numbers of the workspace", 4, 8));
}

const REVOLUTE: JointType = JointType::Revolute { axis: [0.0, 1.0, 0.0] };

/// Balls of 1 kg, each on a joint of its own that stands on the ground.
fn balls(kinds: &[JointType]) -> Model<f64> {
    let ball = |(i, &kind): (usize, &JointType)| BodyDescription {
        name: format!("ball{i}"),
        parent: None,
        mass: 1.0,
        com: [0.0; 3],
        inertia: [0.1, 0.0, 0.0, 0.1, 0.0, 0.1],
        joint: JointDescription { name: format!("joint{i}"), kind, ..JointDescription::default() },
    };
    let bodies = kinds.iter().enumerate().map(ball).collect();
    Model::build(&Description { bodies, ..Description::default() }).unwrap()
}

#[test]
fn matrices_exchange_their_numbers_with_as_many() {
    let topology =
        common::topology(&[(-1, JointKind::Revolute(Axis::Z)), (0, JointKind::Revolute(Axis::Z)), (0, JointKind::Revolute(Axis::Z))]);
    let mut matrix = TreeSparse::from_fn(&topology, |i, j| (10 * i + j) as f64);
    let (own, mut others) = (matrix.clone(), TreeSparse::new(&topology));
    assert_eq!(own.values(), [0.0, 10.0, 11.0, 20.0, 22.0]);
    others.values_mut().copy_from_slice(&[1.0, 2.0, 3.0, 4.0, 5.0]);
    matrix.exchange(&mut others).unwrap();
    assert_eq!((matrix.values(), &others), (&[1.0, 2.0, 3.0, 4.0, 5.0][..], &own));
    for (parents, length) in [(&[None, None, None, None][..], 4), (&[None, Some(0), Some(1)], 6)] {
        let mut wrong = TreeSparse::of_parents(parents).unwrap();
        assert_eq!(refusal(matrix.exchange(&mut wrong)), ("stored numbers of the tree-sparse matrix", 5, length));
        assert_eq!((matrix.values(), wrong.values()), (&[1.0, 2.0, 3.0, 4.0, 5.0][..], &vec![0.0; length][..]), "nothing is exchanged");
    }
}

#[test]
fn a_model_with_a_missing_part_is_refused() {
    let whole = dyadic_chain(&[[0.0, 1.0, 0.0]], 3);
    type Remove = fn(&mut Model<f64>);
    let parts: [(&str, Remove); 5] = [
        ("labels of the model", |model| model.labels.truncate(2)),
        ("placements of the model", |model| model.placements.truncate(2)),
        ("subspaces of the model", |model| model.subspaces.truncate(2)),
        ("inertias of the model", |model| model.inertias.truncate(2)),
        ("armature of the model", |model| model.armature.truncate(2)),
    ];
    let zero = [0.0; 3];
    for (part, remove) in parts {
        let mut model = whole.clone();
        remove(&mut model);
        let expected = (part, 3, 2);
        assert_eq!(refusal(inverse_dynamics(&model, &zero, &zero, &zero).map(drop)), expected);
        assert_eq!(refusal(forward_dynamics(&model, &zero, &zero, &zero).map(drop)), expected);
        assert_eq!(refusal(mass_matrix(&model, &zero).map(drop)), expected);
    }
}

#[test]
fn a_massless_tip_is_named() {
    let mut model = dyadic_chain(&[[0.0, 1.0, 0.0]], 3);
    model.inertias[2] = featherbench_spatial::RigidBodyInertia::zero();
    let zero = [0.0; 3];
    let expected = NotPositiveDefinite { dof: 2, pivot: 0.0 };
    assert_eq!(mass_matrix(&model, &zero).unwrap().into_ltdl().unwrap_err(), expected);
    let error = forward_dynamics(&model, &zero, &zero, &zero).unwrap_err();
    assert_eq!(error, Error::NotPositiveDefinite(expected));
    assert!(error.to_string().contains("pivot 0e0 at dof 2"), "{error}");
    // Armature is inertia enough.
    model.armature[2] = 0.1;
    assert!(forward_dynamics(&model, &zero, &zero, &zero).is_ok());
}

/// Which dof of a free or a spherical joint meets no inertia: a free joint's translation comes first.
#[test]
fn free_and_spherical_bodies_without_inertia_are_named_with_their_dof() {
    let inertia = |mass: f64, about_com: [f64; 6]| RigidBodyInertia::from_com(mass, Vec3::zero(), Sym3::from_array(about_com));
    let (nothing, point) = (RigidBodyInertia::zero(), inertia(2.0, [0.0; 6]));
    let rod_along_z = inertia(2.0, [0.5, 0.0, 0.0, 0.5, 0.0, 0.0]);
    let weightless = inertia(0.0, [0.5, 0.0, 0.0, 0.5, 0.0, 0.5]);
    let cases = [
        (JointType::Free, nothing, 0),
        (JointType::Free, weightless, 0),
        (JointType::Free, point, 3),
        (JointType::Free, rod_along_z, 5),
        (JointType::Spherical, nothing, 0),
        (JointType::Spherical, point, 0),
        (JointType::Spherical, rod_along_z, 2),
    ];
    for (kind, inertia, dof) in cases {
        let mut model = balls(&[kind]);
        let states = StateBatch::random(&model, 1, 1);
        let (q, v, tau) = (states.q(0), states.v(0), states.tau(0));
        assert!(forward_dynamics(&model, q, v, tau).is_ok());
        model.inertias[0] = inertia;
        let error = forward_dynamics(&model, q, v, tau).unwrap_err();
        assert_eq!(error, Error::NotPositiveDefinite(NotPositiveDefinite { dof, pivot: 0.0 }), "{kind:?}");
    }
}

#[test]
fn massless_spherical_and_free_tips_are_named() {
    for robot in [3, 8] {
        let mut model = build(&ROBOTS[robot].1);
        let last = (0..model.topology.bodies()).rfind(|&i| model.topology.joints()[i].kind.nv() > 1).unwrap();
        for inertia in &mut model.inertias[last..] {
            *inertia = featherbench_spatial::RigidBodyInertia::zero();
        }
        model.armature.fill(0.0);
        let states = StateBatch::random(&model, 1, 1);
        let error = forward_dynamics(&model, states.q(0), states.v(0), states.tau(0)).unwrap_err();
        assert!(matches!(error, Error::NotPositiveDefinite(NotPositiveDefinite { pivot: 0.0, .. })), "{error}");
    }
}

/// NaN and infinity anywhere in the input give an error or NaN, on every robot.
#[test]
fn numbers_that_are_not_finite_do_no_harm() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, 1, 1);
        for bad in [f64::NAN, f64::INFINITY] {
            for k in [0, model.topology.nv() / 2, model.topology.nv() - 1] {
                let mut q = states.q(0).to_vec();
                q[k] = bad;
                let mut v = states.v(0).to_vec();
                v[k] = bad;
                let poisoned = |values: &[f64]| values.iter().any(|x| !x.is_finite());
                assert!(poisoned(&inverse_dynamics(&model, states.q(0), &v, states.a(0)).unwrap()), "{name}");
                let answer = forward_dynamics(&model, states.q(0), &v, states.tau(0));
                assert!(answer.map_or(true, |a| poisoned(&a)), "{name}");
                let answer = forward_dynamics(&model, &q, states.v(0), states.tau(0));
                assert!(answer.map_or(true, |a| poisoned(&a)), "{name}");
                let answer = mass_matrix(&model, &q).unwrap().into_ltdl();
                assert!(
                    answer.map_or(true, |ltdl| poisoned(ltdl.factors().values()) || first_does_not_matter(&model, k)),
                    "{name}, q[{k}]"
                );
            }
        }
        assert_eq!(states.cases, [Case::Random]);
    }
}

/// Whether number `k` of q belongs to a root joint. The mass matrix does not depend on these numbers.
fn first_does_not_matter(model: &Model<f64>, k: usize) -> bool {
    model.topology.joints().iter().any(|joint| joint.parent.is_none() && (joint.q..joint.q + joint.kind.nq()).contains(&k))
}
