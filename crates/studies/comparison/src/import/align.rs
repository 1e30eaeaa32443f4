//! One import result written in the frames of the other.
//!
//! A placement that only moves the frame of a body, together with its axis, inertia and children, is not a difference. Examples are a
//! rotation of the body's frame, and a slide of it along a revolute axis. So before two import results are compared, each body of theirs
//! gets the frame that makes it most like ours. There are three candidates:
//! - its own frame;
//! - the frame that coincides with ours in the zero configuration;
//! - the frame in which one of its children is where ours has it.
//!
//! Another frame than its own is used only if it leaves fewer differences.

use super::fields::{Precision, differs, rounding};
use super::{Field, fields};
use featherbench_model::{BodyDescription, Description, JointType, Placement};
use featherbench_spatial::{Sym3, Transform, Vec3};

/// The fields that depend on the choice of a frame.
const GEOMETRIC: [Field; 4] = [Field::Axis, Field::Placement, Field::Com, Field::Inertia];

/// The partners of our bodies, written in our frames; `partner` as [`super::pairs::pairs`] gives it, `reach` the robot's length scale.
pub(super) fn aligned(
    ours: &Description,
    theirs: &Description,
    partner: &[Option<usize>],
    reach: f64,
    precision: Precision,
) -> Vec<Option<BodyDescription>> {
    let aligner = Aligner { ours, theirs, partner, reach, precision };
    let mut gauges = vec![Transform::identity(); ours.bodies.len()];
    let mut result = Vec::with_capacity(ours.bodies.len());
    for i in 0..ours.bodies.len() {
        result.push(partner[i].map(|j| {
            let above = aligner.above(i, j, &gauges);
            gauges[i] = aligner.gauge(i, j, &above);
            written(&theirs.bodies[j], &above, &gauges[i])
        }));
    }
    result
}

struct Aligner<'a> {
    ours: &'a Description,
    theirs: &'a Description,
    partner: &'a [Option<usize>],
    reach: f64,
    precision: Precision,
}

impl Aligner<'_> {
    /// The transform from their parent's frame to ours.
    fn above(&self, i: usize, j: usize, gauges: &[Transform<f64>]) -> Transform<f64> {
        match self.ours.bodies[i].parent {
            Some(parent) if self.partner[parent].is_some() && self.partner[parent] == self.theirs.bodies[j].parent => gauges[parent],
            _ => Transform::identity(),
        }
    }

    /// The frame with the fewest differences; the body's own if no other has fewer.
    fn gauge(&self, i: usize, j: usize, above: &Transform<f64>) -> Transform<f64> {
        let children = || self.children(i, j).map(|(c, d)| place(&self.ours.bodies[c]).compose(&place(&self.theirs.bodies[d]).inverse()));
        let mut best = (self.cost(i, j, above, &Transform::identity()), Transform::identity());
        for gauge in std::iter::once(self.inherited(i, j, above)).chain(children()) {
            if best.0 == 0 || !preserves(self.theirs.bodies[j].joint.kind, &gauge, self.reach, self.precision) {
                continue;
            }
            let cost = self.cost(i, j, above, &gauge);
            if cost < best.0 {
                best = (cost, gauge);
            }
        }
        best.1
    }

    /// The frame that coincides with ours in the zero configuration.
    fn inherited(&self, i: usize, j: usize, above: &Transform<f64>) -> Transform<f64> {
        let gauge = place(&self.ours.bodies[i]).inverse().compose(&above.compose(&place(&self.theirs.bodies[j])));
        // Rounding is not another frame: it would grow from body to body.
        if is_identity(&gauge, self.reach, self.precision) { Transform::identity() } else { gauge }
    }

    /// The number of differences of the body with this frame, and of children that would need a frame of their own.
    fn cost(&self, i: usize, j: usize, above: &Transform<f64>, gauge: &Transform<f64>) -> usize {
        let child = |(c, d): (usize, usize)| {
            let own = self.count(c, d, gauge, &Transform::identity());
            let inherited = self.inherited(c, d, gauge);
            let moved = preserves(self.theirs.bodies[d].joint.kind, &inherited, self.reach, self.precision);
            usize::from(own > 0 && !(moved && self.count(c, d, gauge, &inherited) == 0))
        };
        self.count(i, j, above, gauge) + self.children(i, j).map(child).sum::<usize>()
    }

    fn count(&self, i: usize, j: usize, above: &Transform<f64>, gauge: &Transform<f64>) -> usize {
        let (ours, theirs) = (&self.ours.bodies[i], written(&self.theirs.bodies[j], above, gauge));
        let rounding = rounding(self.ours, i, self.precision);
        GEOMETRIC.into_iter().filter(|&field| differs(fields::size(field, ours, &theirs, self.reach), rounding)).count()
    }

    fn children(&self, i: usize, j: usize) -> impl Iterator<Item = (usize, usize)> {
        let children = (i + 1..self.ours.bodies.len()).filter(move |&c| self.ours.bodies[c].parent == Some(i));
        children.filter_map(move |c| self.partner[c].filter(|&d| self.theirs.bodies[d].parent == Some(j)).map(|d| (c, d)))
    }
}

/// Whether another frame on the moved body keeps the meaning of the joint's coordinates.
fn preserves(kind: JointType, gauge: &Transform<f64>, reach: f64, precision: Precision) -> bool {
    match kind {
        JointType::Prismatic { .. } => true,
        // The line of the axis must still go through the origin.
        JointType::Revolute { axis } | JointType::Helical { axis, .. } => {
            let (axis, shift) = (gauge.rotation * Vec3::from_array(axis), gauge.translation);
            (shift - axis * shift.dot(axis)).norm() <= precision.rounding() * reach
        }
        _ => is_identity(gauge, reach, precision),
    }
}

fn is_identity(gauge: &Transform<f64>, reach: f64, precision: Precision) -> bool {
    let identity = Transform::<f64>::identity().rotation.to_array();
    let turned = gauge.rotation.to_array().iter().zip(identity).any(|(x, y)| (x - y).abs() > precision.rounding());
    !turned && gauge.translation.norm() <= precision.rounding() * reach
}

fn place(body: &BodyDescription) -> Transform<f64> {
    body.joint.placement.to_transform()
}

/// A body whose parent's frame is moved by `above` and whose own is moved by `gauge`.
fn written(body: &BodyDescription, above: &Transform<f64>, gauge: &Transform<f64>) -> BodyDescription {
    let mut body = body.clone();
    let identity = Transform::identity();
    if *above != identity || *gauge != identity {
        body.joint.placement = Placement::from_transform(&above.compose(&place(&body)).compose(&gauge.inverse()));
    }
    if *gauge != identity {
        body.com = gauge.point(Vec3::from_array(body.com)).to_array();
        body.inertia = Sym3::from_array(body.inertia).rotate(gauge.rotation).to_array();
        if let JointType::Revolute { axis } | JointType::Prismatic { axis } | JointType::Helical { axis, .. } = &mut body.joint.kind {
            *axis = (gauge.rotation * Vec3::from_array(*axis)).to_array();
        }
    }
    body
}
