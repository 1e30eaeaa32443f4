//! Arbitrary descriptions, most of them wrong in some way.

use featherbench_model::{BodyDescription, Description, Frame, JointDescription, JointType, Placement, Uncertain};
use proptest::prelude::*;

/// Numbers as users may write them: mostly ordinary, sometimes zero, negative, huge, infinite or NaN.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![20 => -2.0..2.0, 4 => Just(0.0), 2 => Just(1.0), 1 => any::<f64>()]
}

fn numbers<const N: usize>() -> impl Strategy<Value = [f64; N]> {
    proptest::collection::vec(number(), N).prop_map(|list| std::array::from_fn(|k| list[k]))
}

fn axis() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![4 => Just([1.0, 0.0, 0.0]), 4 => Just([0.0, 0.6, 0.8]), 1 => numbers()]
}

fn kind() -> impl Strategy<Value = JointType> {
    prop_oneof![
        Just(JointType::Fixed),
        axis().prop_map(|axis| JointType::Revolute { axis }),
        axis().prop_map(|axis| JointType::Prismatic { axis }),
        (axis(), number()).prop_map(|(axis, pitch)| JointType::Helical { axis, pitch }),
        Just(JointType::Spherical),
        Just(JointType::Free),
        Just(JointType::Planar),
        Just(JointType::Universal),
        Just(JointType::Translation),
        axis().prop_map(|axis| JointType::Cylindrical { axis }),
        Just(JointType::EulerZyx),
    ]
}

fn placement() -> impl Strategy<Value = Placement> {
    let rotation = prop_oneof![8 => Just([0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]), 1 => numbers()];
    (rotation, numbers()).prop_map(|(rotation, translation)| Placement { rotation, translation })
}

fn list() -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![8 => Just(Vec::new()), 2 => proptest::collection::vec(0.0..1.0, 1..4), 1 => proptest::collection::vec(number(), 0..7)]
}

prop_compose! {
    fn any_body(count: usize)(
        (name, parent) in (0..100 * count, prop_oneof![3 => Just(None), 5 => (0..count).prop_map(Some), 1 => (0..2 * count).prop_map(Some)]),
        (mass, com, inertia) in (prop_oneof![8 => 0.0..3.0, 1 => number()], numbers(), numbers()),
        (kind, placement) in (kind(), placement()),
        (armature, damping, lower, upper, effort) in (list(), list(), list(), list(), list()),
    ) -> BodyDescription {
        let joint = JointDescription { name: format!("j{name}"), kind, placement, armature, damping, lower, upper, effort, ..JointDescription::default() };
        BodyDescription { name: format!("b{name}"), parent, mass, com, inertia, joint }
    }
}

/// A description of up to seven bodies. Few are valid.
pub fn any_description() -> impl Strategy<Value = Description> {
    (0_usize..8).prop_flat_map(|count| {
        let bodies = proptest::collection::vec(any_body(count.max(1)), count);
        let frames = proptest::collection::vec((proptest::option::of(0..count + 1), placement()), 0..2);
        (bodies, frames, numbers()).prop_map(|(bodies, frames, gravity)| Description {
            name: "anything".to_owned(),
            gravity,
            bodies,
            frames: frames.into_iter().map(|(body, placement)| Frame { name: "frame".to_owned(), body, placement }).collect(),
            loops: Vec::new(),
            continua: Vec::new(),
            residuals: Vec::new(),
            uncertain: Uncertain::default(),
            provenance: None,
        })
    })
}
