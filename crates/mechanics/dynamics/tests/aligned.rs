//! Joints along coordinate axes: the axes of their bodies are relabelled, and the kernels have a text of their own for them. No answer may
//! show it.

use crate::common;

use common::{Kind, Recipe, build, distance, gap, largest, robot, within, wrenches};
use featherbench_dynamics::{
    Aba, BatchError, Bias, Kinematics, PackedAba, PackedCrba, PackedModel, PackedRnea, Refined, Rnea, TreeSparse, centroidal_momentum,
    energy, jacobian, mass_matrix,
};
use featherbench_model::{Axis, Description, JointKind, JointType, Label, Model};
use featherbench_robots::{Random, StateBatch};
use featherbench_spatial::{Compensated, DoubleDouble, Force, Mat3, Quaternion, Real, Sym3, Vec3};

const AXES: [([f64; 3], Label); 6] = [
    ([1.0, 0.0, 0.0], Label::X),
    ([0.0, 1.0, 0.0], Label::Y),
    ([0.0, 0.0, 1.0], Label::Z),
    ([-1.0, 0.0, 0.0], Label::MinusX),
    ([0.0, -1.0, 0.0], Label::MinusY),
    ([0.0, 0.0, -1.0], Label::MinusZ),
];

/// Five kinds and six axes: thirty bodies have every pair.
const RECIPE: Recipe = Recipe {
    kinds: &[Kind::Revolute, Kind::Prismatic, Kind::Helical, Kind::Spherical, Kind::Cylindrical],
    bodies: 30,
    branched: true,
    armature: true,
};

/// The axis of a joint, if its kind has one to choose.
fn axis_mut(kind: &mut JointType) -> Option<&mut [f64; 3]> {
    match kind {
        JointType::Revolute { axis }
        | JointType::Prismatic { axis }
        | JointType::Cylindrical { axis }
        | JointType::Helical { axis, .. } => Some(axis),
        _ => None,
    }
}

/// A robot all of whose axes are coordinate axes of their bodies.
pub fn aligned() -> Description {
    let mut description = robot(&RECIPE, 5);
    for (i, body) in description.bodies.iter_mut().enumerate() {
        if let Some(axis) = axis_mut(&mut body.joint.kind) {
            *axis = AXES[i % AXES.len()].0;
        }
    }
    description
}

/// The same robot with other body frames: the axes of body i are turned by the i-th rotation, so that its joint's axis is a skew one.
fn turned(description: &Description, rotations: &[Mat3<f64>]) -> Description {
    let mut turned = description.clone();
    for (body, &g) in turned.bodies.iter_mut().zip(rotations) {
        let parent = body.parent.map_or(Mat3::identity(), |parent| rotations[parent]);
        let into = |v: [f64; 3]| g.transpose_mul(Vec3::from_array(v)).to_array();
        let placement = &mut body.joint.placement;
        placement.rotation = (parent.transpose() * Mat3::from_array(placement.rotation) * g).to_array();
        placement.translation = parent.transpose_mul(Vec3::from_array(placement.translation)).to_array();
        (body.com, body.inertia) = (into(body.com), Sym3::from_array(body.inertia).rotate(g.transpose()).to_array());
        if let Some(axis) = axis_mut(&mut body.joint.kind) {
            *axis = into(*axis);
        }
    }
    turned
}

/// A rotation per described body. The velocity of a spherical joint is in body axes, so these stay.
fn rotations(description: &Description) -> Vec<Mat3<f64>> {
    let mut random = Random::new(9, 9);
    let turn = |kind: JointType| match kind {
        JointType::Spherical => Mat3::identity(),
        _ => Quaternion::from_array(random.direction::<4>()).to_rotation(),
    };
    description.bodies.iter().map(|body| body.joint.kind).map(turn).collect()
}

#[test]
fn a_coordinate_axis_is_compiled_as_z_without_rounding() {
    let description = aligned().canonical().unwrap();
    let model = Model::<f64>::build(&description).unwrap();
    let wide = Model::<DoubleDouble>::build(&description).unwrap();
    let (mut revolute, mut prismatic) = (0, 0);
    for (body, &last) in description.bodies.iter().zip(&model.described) {
        let label = model.labels[last];
        let parent = body.parent.map_or(Label::Z, |parent| model.labels[model.described[parent]]);
        let first = last + 1 - body.joint.kind.nv().min(if body.joint.kind == JointType::Spherical { 1 } else { 2 });
        let rotation = label.rotation_to_described(model.placements[first].rotation);
        let rotation = parent.rotation_to_described(rotation.transpose()).transpose();
        assert_eq!(rotation.to_array(), body.joint.placement.rotation);
        assert_eq!(parent.to_described(model.placements[first].translation).to_array(), body.joint.placement.translation);
        assert_eq!(wide.labels[last], label);
        let (kind, subspace) = (model.topology.joints()[last].kind, model.subspaces[last]);
        match kind {
            JointKind::Revolute(axis) => {
                revolute += 1;
                assert_eq!((axis, subspace.ang.to_array()), (Axis::Z, [0.0, 0.0, 1.0]));
            }
            JointKind::Prismatic(axis) => {
                prismatic += 1;
                assert_eq!((axis, subspace.lin.to_array()), (Axis::Z, [0.0, 0.0, 1.0]));
            }
            _ => assert_eq!(label, Label::Z),
        }
    }
    assert_eq!((revolute, prismatic), (6, 12), "a cylindrical joint ends with a prismatic one");

    let skew = Model::<f64>::build(&turned(&description, &rotations(&description))).unwrap();
    let is_aligned = |kind: JointKind| matches!(kind, JointKind::Revolute(Axis::Z) | JointKind::Prismatic(Axis::Z));
    assert!(skew.labels.iter().all(|label| *label == Label::Z) && !skew.topology.joints().iter().any(|joint| is_aligned(joint.kind)));
}

#[test]
fn labels_are_rotations_that_take_z_to_their_axis() {
    let axes = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
    for (axis, label) in AXES {
        assert_eq!(Label::of_axis(axis), Some(label));
        let [x, y, z] = axes.map(|axis| label.to_described(axis));
        assert_eq!((x.cross(y), z.to_array()), (z, axis));
        let v = Vec3::new(0.3, -0.7, 1.1);
        assert_eq!(label.to_compiled(label.to_described(v)), v);
        assert_eq!(label.force_to_compiled(Force::new(x, y)), Force::new(axes[0], axes[1]));
    }
    for none in [[1.0, 1e-300, 0.0], [0.6, 0.8, 0.0], [0.0; 3], [f64::NAN; 3]] {
        assert_eq!(Label::of_axis(none), None);
    }
}

#[test]
fn answers_do_not_depend_on_the_axes_of_a_body() {
    let description = aligned();
    let rotations = rotations(&description);
    let (a, b) = (Model::<f64>::build(&description).unwrap(), Model::build(&turned(&description, &rotations)).unwrap());
    let t = &a.topology;
    let mut owner = vec![0; t.bodies()];
    for (i, &last) in a.described.iter().enumerate().rev() {
        owner[..=last].fill(i);
    }
    let forces = wrenches(&a, 4);
    let into = |(f, i): (&Force<f64>, &usize)| Force::new(rotations[*i].transpose_mul(f.ang), rotations[*i].transpose_mul(f.lin));
    let forces = [forces.clone(), forces.iter().zip(&owner).map(into).collect()];
    let states = StateBatch::random(&a, 5, 3);
    for k in 0..states.count() {
        let (q, v, acceleration, tau) = (states.q(k), states.v(k), states.a(k), states.tau(k));
        let answers = [&a, &b].into_iter().zip(&forces).map(|(model, forces)| {
            let (packed, mut out) = (PackedModel::new(model), vec![0.0; t.nv()]);
            let mut answers: Vec<(&str, Vec<f64>)> = Vec::new();
            Rnea::new(t).run(model, q, v, acceleration, Some(forces), &mut out).unwrap();
            answers.push(("id", out.clone()));
            Bias::new(t).run(model, q, v, Some(forces), &mut out).unwrap();
            answers.push(("bias", out.clone()));
            PackedRnea::new(&packed).run(&packed, q, v, acceleration, Some(forces), &mut out).unwrap();
            answers.push(("id, packed", out.clone()));
            PackedAba::new(&packed).run(&packed, q, v, tau, Some(forces), &mut out).unwrap();
            answers.push(("fd, packed", out.clone()));
            Refined::<Compensated>::new(t, 2).run(model, q, v, tau, Some(forces), &mut out).unwrap();
            answers.push(("fd, refined", out.clone()));
            let mut aba = Aba::new(t);
            aba.run(model, q, v, tau, Some(forces), &mut out).unwrap();
            answers.push(("fd", out.clone()));
            aba.solve(model, tau, &mut out).unwrap();
            answers.push(("solution", out.clone()));
            answers.push(("M", mass_matrix(model, q).unwrap().values().to_vec()));
            let mut matrix = TreeSparse::new(t);
            PackedCrba::new(&packed).run(&packed, q, &mut matrix).unwrap();
            answers.push(("M, packed", matrix.values().to_vec()));
            let energies = energy(model, q, v).unwrap();
            answers.push(("energy", vec![energies.kinetic, energies.potential]));
            answers.push(("momentum", centroidal_momentum(model, q, v).unwrap().momentum.to_array().to_vec()));
            let columns = jacobian(model, q, t.bodies() - 1).unwrap();
            answers.push(("Jacobian", columns.into_iter().flat_map(|column| column.to_array()).collect()));
            answers
        });
        let [one, other]: [Vec<_>; 2] = answers.collect::<Vec<_>>().try_into().unwrap();
        for ((what, one), (_, other)) in one.iter().zip(&other) {
            // κ(M) is below 1e4; the other numbers are sums of a few hundred
            within(what, distance(one, other) / largest(one), 1e-12);
        }
        let (mut one, mut other) = (Kinematics::new(t), Kinematics::new(t));
        one.run(&a, q, v, acceleration).unwrap();
        other.run(&b, q, v, acceleration).unwrap();
        for ((one, other), &i) in one.iter().zip(other.iter()).zip(&owner) {
            let (x, y) = (one.placement, other.placement);
            within("rotation", distance(&(x.rotation * rotations[i]).to_array(), &y.rotation.to_array()), 1e-14);
            within("position", distance(&x.translation.to_array(), &y.translation.to_array()), 1e-13);
            within("velocity", gap(one.velocity, other.velocity), 1e-12);
            within("acceleration", gap(one.acceleration, other.acceleration), 1e-11);
        }
    }
}

/// The truth is the same text with 32 digits: relabelling must not cost what the general text does not.
#[test]
fn aligned_joints_are_as_accurate_as_skew_ones() {
    let description = aligned();
    let error = |description: &Description| {
        let (model, wide) = (Model::<f64>::build(description).unwrap(), Model::<DoubleDouble>::build(description).unwrap());
        let (states, t) = (StateBatch::random(&model, 20, 8), &model.topology);
        let (mut out, mut truth) = (vec![0.0; t.nv()], vec![DoubleDouble::zero(); t.nv()]);
        let squares = (0..states.count()).map(|k| {
            Rnea::new(t).run(&model, states.q(k), states.v(k), states.a(k), None, &mut out).unwrap();
            let [q, v, a] = [states.q(k), states.v(k), states.a(k)].map(common::lifted::<DoubleDouble>);
            Rnea::new(t).run(&wide, &q, &v, &a, None, &mut truth).unwrap();
            let truth: Vec<f64> = truth.iter().map(|x| x.to_f64()).collect();
            (distance(&out, &truth) / largest(&truth)).powi(2)
        });
        (squares.sum::<f64>() / 20.0).sqrt()
    };
    let (aligned, skew) = (error(&description), error(&turned(&description, &rotations(&description))));
    within("rms error of aligned joints over that of skew ones", aligned / skew, 1.5);
}

/// Samples of a robot whose axes are known but for an error: some are coordinate axes and others are not.
#[test]
fn samples_may_have_the_axis_of_a_joint_here_along_z_and_there_not() {
    let sample = |k: usize| {
        let mut description = aligned();
        if k % 3 == 1 {
            description.bodies[0].joint.kind = JointType::Revolute { axis: [0.8, 0.6, 0.0] };
        }
        Model::<f64>::build(&description).unwrap()
    };
    let samples: Vec<Model<f64>> = (0..11).map(sample).collect();
    let states = StateBatch::random(&samples[0], samples.len(), 2);
    let nv = samples[0].topology.nv();
    let mut found = vec![0.0; samples.len() * nv];
    let mut batch = featherbench_dynamics::Batch::of_samples(&samples).unwrap();
    // The body of that joint has other compiled axes here and there, and its wrench is given in the described ones.
    let f: Vec<Vec<Force<f64>>> = (0..samples.len() as u64).map(|seed| wrenches(&samples[0], seed)).collect();
    let numbers: Vec<f64> = f.iter().flatten().flat_map(|f| f.to_array()).collect();
    for external in [false, true] {
        batch.forward_dynamics(&states.q, &states.v, &states.tau, external.then_some(&numbers[..]), &mut found).unwrap();
        for (k, (model, found)) in samples.iter().zip(found.chunks(nv)).enumerate() {
            let (mut a, f) = (vec![0.0; nv], external.then_some(&f[k][..]));
            Aba::new(&model.topology).run(model, states.q(k), states.v(k), states.tau(k), f, &mut a).unwrap();
            within("samples", distance(&a, found) / largest(&a), 1e-12);
        }
    }
    // One bad wrench is found although its group is mixed.
    let mut bad = numbers.clone();
    bad[4 * 6 * samples[0].topology.bodies() + 2] = f64::NAN;
    let done = batch.forward_dynamics(&states.q, &states.v, &states.tau, Some(&bad), &mut found);
    assert!(matches!(&done, Err(BatchError::Failed { failures, .. }) if failures.len() == 1 && failures[0].state == 4), "{done:?}");
    let others = found.iter().enumerate().filter(|(place, _)| place / nv != 4);
    assert!(others.clone().count() == 10 * nv && others.clone().all(|(_, a)| a.is_finite()));
    // Robots of another tree are refused still.
    let other = build(&Recipe { bodies: 29, ..RECIPE });
    assert!(featherbench_dynamics::Batch::of_samples(&[samples[0].clone(), other]).is_err());
}
