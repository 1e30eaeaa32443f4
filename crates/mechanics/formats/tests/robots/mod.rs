//! Robots of any shape for round trips: extreme and ordinary numbers, names that need escaping, frames in any order.

use featherbench_model::{BodyDescription, Description, Frame, JointDescription, JointType, Placement};
use proptest::prelude::*;
use proptest::sample::Index;

/// The joints that a robot may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Revolute,
    Prismatic,
    Planar,
    Free,
}

/// Numbers: mostly ordinary, some tiny, huge, zero or negative zero.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![12 => -2.0..2.0, 2 => Just(0.0), 1 => Just(-0.0), 1 => (-1.0..1.0, -300..300).prop_map(|(x, e): (f64, i32)| x * 10_f64.powi(e))]
}

fn numbers<const N: usize>() -> impl Strategy<Value = [f64; N]> {
    proptest::collection::vec(number(), N).prop_map(|list| std::array::from_fn(|k| list[k]))
}

/// A direction of length one to rounding.
fn axis() -> impl Strategy<Value = [f64; 3]> {
    let drawn = [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64].prop_filter_map("a direction", |v| {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        (length > 0.1).then(|| v.map(|x| x / length))
    });
    prop_oneof![1 => Just([0.0, 0.0, 1.0]), 1 => Just([-1.0, 0.0, 0.0]), 4 => drawn]
}

/// A rotation of a quaternion: often skew, sometimes the identity, a quarter turn or close to one about y.
fn rotation() -> impl Strategy<Value = [f64; 9]> {
    let skew = [-1.0..1.0, -1.0..1.0, -1.0..1.0, 0.1..1.0_f64].prop_map(|q| {
        let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        of_quaternion(q.map(|x| x / length))
    });
    let steep = (-17..-1, -1.0..1.0).prop_map(|(e, x): (i32, f64)| {
        let (sin, cos) = (std::f64::consts::FRAC_PI_4 + x * 10_f64.powi(e)).sin_cos();
        of_quaternion([0.0, sin, 0.0, cos])
    });
    prop_oneof![4 => skew, 2 => steep, 1 => Just(Placement::default().rotation), 1 => Just([0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0])]
}

fn of_quaternion([x, y, z, w]: [f64; 4]) -> [f64; 9] {
    let (xx, yy, zz) = (2.0 * x * x, 2.0 * y * y, 2.0 * z * z);
    let (xy, xz, yz) = (2.0 * x * y, 2.0 * x * z, 2.0 * y * z);
    let (wx, wy, wz) = (2.0 * w * x, 2.0 * w * y, 2.0 * w * z);
    [1.0 - yy - zz, xy - wz, xz + wy, xy + wz, 1.0 - xx - zz, yz - wx, xz - wy, yz + wx, 1.0 - xx - yy]
}

fn placement() -> impl Strategy<Value = Placement> {
    (rotation(), numbers()).prop_map(|(rotation, translation)| Placement { rotation, translation })
}

/// Per-dof lists for one degree of freedom; others take equal numbers.
fn list() -> impl Strategy<Value = Option<f64>> {
    proptest::option::weighted(0.7, 0.0..10.0)
}

prop_compose! {
    fn body(kinds: &'static [Kind])(
        name in "[a-zé&<>\"' ./0-9-]{1,6}",
        parent in proptest::option::weighted(0.9, any::<Index>()),
        (kind, axis, placement) in (proptest::sample::select(kinds), axis(), placement()),
        (mass, com, inertia) in (0.0..5.0, numbers(), numbers()),
        (damping, friction, limits) in (list(), list(), proptest::collection::vec(list(), 4)),
    ) -> (Option<Index>, BodyDescription) {
        let kind = match kind {
            Kind::Revolute => JointType::Revolute { axis },
            Kind::Prismatic => JointType::Prismatic { axis },
            Kind::Planar => JointType::Planar,
            Kind::Free => JointType::Free,
        };
        let one = |x: Option<f64>| if kind.nv() == 1 { x.into_iter().collect() } else { Vec::new() };
        let joint = JointDescription {
            name: name.clone(),
            kind,
            placement,
            armature: Vec::new(),
            damping: one(damping),
            friction: one(friction),
            lower: one(limits[0].map(|x| -x)),
            upper: one(limits[1]),
            velocity: one(limits[2]),
            effort: one(limits[3]),
        };
        (parent, BodyDescription { name, parent: None, mass, com, inertia, joint })
    }
}

/// A tree of up to twelve bodies with these joints, and frames on any of them.
pub fn of(kinds: &'static [Kind]) -> impl Strategy<Value = Description> {
    let frames = proptest::collection::vec((proptest::option::of(any::<Index>()), placement()), 0..5);
    (proptest::collection::vec(body(kinds), 1..12), frames, ".{0,8}").prop_map(|(drawn, frames, name)| {
        let mut bodies: Vec<BodyDescription> = Vec::new();
        for (k, (parent, mut body)) in drawn.into_iter().enumerate() {
            body.parent = parent.filter(|_| k > 0).map(|parent| parent.index(k));
            body.name.push_str(&k.to_string());
            body.joint.name = format!("{} joint", body.name);
            bodies.push(body);
        }
        let frame = |(k, (body, placement)): (usize, (Option<Index>, Placement))| {
            let body = body.map(|body| body.index(bodies.len()));
            Frame { name: format!("frame {k}"), body, placement }
        };
        let frames = frames.into_iter().enumerate().map(frame).collect();
        let name = name.chars().filter(|c| !c.is_control() && !matches!(c, '$' | '\u{fffe}' | '\u{ffff}')).collect();
        Description { name, gravity: [0.0; 3], bodies, frames, ..Description::default() }
    })
}
