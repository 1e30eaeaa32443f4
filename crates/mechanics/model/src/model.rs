//! The compiled model: a topology with its parameters.

use crate::orthonormal::{rotation, unit};
use crate::{Axis, Description, JointKind, JointType, Label, Malformed, Topology, Warning};
use featherbench_spatial::{Lift, Mat3, Motion, Real, RigidBodyInertia, Sym3, Transform, Vec3};
use std::array::from_fn;

/// A robot as the kernels use it: primitive joints in depth-first order, parameters over the scalar `P`.
///
/// The axes of a body are labelled so that its joint turns about, or slides along, z, if the described axis is a coordinate axis or the
/// opposite of one ([`Axis::Z`]). Helical, spherical and free joints keep the described axes. Placements, subspaces and inertias are in these *compiled* axes. What users give and get in body axes is in
/// the described ones, and `labels` leads from one to the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Model<P> {
    /// The tree.
    pub topology: Topology,
    /// How the described axes of each body are called in the compiled model.
    pub labels: Vec<Label>,
    /// Joint frame in the parent's frame, in compiled axes of both, per body.
    pub placements: Vec<Transform<P>>,
    /// Constant motion subspace of each screw joint in compiled body axes (unused for spherical and free joints), per body. Of a joint with
    /// [`Axis::Z`] the kernels do not read it.
    pub subspaces: Vec<Motion<P>>,
    /// Rigid-body inertia at the body's origin in compiled body axes, per body.
    pub inertias: Vec<RigidBodyInertia<P>>,
    /// Armature per dof.
    pub armature: Vec<P>,
    /// Gravitational acceleration in world axes.
    pub gravity: Vec3<P>,
    /// Viscous damping per dof; no kernel reads it.
    pub damping: Vec<f64>,
    /// Dry friction per dof; no kernel reads it.
    pub friction: Vec<f64>,
    /// Position limits of each number of q; infinite where there is none.
    pub limits: Vec<(f64, f64)>,
    /// The compiled body of each described body.
    pub described: Vec<usize>,
    /// The warnings of validation.
    pub warnings: Vec<Warning>,
}

impl<P: Real> Model<P> {
    /// Compiles a description; inertias, axes and rotations are formed in the arithmetic of `P`.
    ///
    /// Canonical axes and rotations are rounded to doubles. A scalar with more digits gets the unit vectors and rotations that these
    /// doubles stand for; `f64` takes the doubles as they are.
    ///
    /// The description need not be canonical: fixed joints are merged and the bodies put in depth-first order.
    ///
    /// # Errors
    /// [`Malformed`] when the description is no tree of bodies with finite, meaningful numbers, or has bodies that deform.
    #[inline(never)]
    pub fn build(description: &Description) -> Result<Self, Malformed> {
        description.must_be_rigid()?;
        let canonical = description.with_canonical_bodies()?;
        // Exact where each joint has one dof, and too small by the other dofs elsewhere.
        let count = canonical.bodies.len();
        let mut tree = Vec::with_capacity(count);
        let mut model = Self {
            topology: Topology::new(&[]).ok_or(Malformed::Empty)?,
            labels: Vec::with_capacity(count),
            placements: Vec::with_capacity(count),
            subspaces: Vec::with_capacity(count),
            inertias: Vec::with_capacity(count),
            armature: Vec::with_capacity(count),
            gravity: vec3(canonical.gravity),
            damping: Vec::with_capacity(count),
            friction: Vec::with_capacity(count),
            limits: Vec::with_capacity(count),
            described: Vec::with_capacity(count),
            warnings: description.normalised().chain(canonical.warnings()).collect(),
        };
        for body in &canonical.bodies {
            let joint = &body.joint;
            let primitives = compile(joint.kind);
            let mut parent = body.parent.map(|parent| model.described[parent]);
            let turned = rotation(joint.placement.rotation);
            let turned = from_fn(|k| P::from_exact(turned.rounded[k], turned.exact[k]));
            let mut placement = Transform::new(Mat3::from_array(turned), vec3(joint.placement.translation));
            for (k, &Primitive { kind, label, subspace }) in primitives.iter().enumerate() {
                let last = k + 1 == primitives.len();
                let parent_label = parent.map_or(Label::Z, |parent| model.labels[parent]);
                tree.push((parent, kind));
                parent = Some(tree.len() - 1);
                model.labels.push(label);
                model.placements.push(label.placement_to_compiled(parent_label, placement));
                placement = Transform::identity();
                model.subspaces.push(subspace);
                let about_com = Sym3::from_array(body.inertia.map(P::from_f64));
                let inertia = RigidBodyInertia::from_com(P::from_f64(body.mass), vec3(body.com), about_com);
                model.inertias.push(if last { label.inertia_to_compiled(inertia) } else { RigidBodyInertia::zero() });
            }
            model.described.push(tree.len() - 1);
            let nv = joint.kind.nv();
            model.armature.extend(per_dof(&joint.armature, nv, 0.0).map(P::from_f64));
            model.damping.extend(per_dof(&joint.damping, nv, 0.0));
            model.friction.extend(per_dof(&joint.friction, nv, 0.0));
            // Quaternions have no limits; of every other joint, nq = nv.
            let limited = if joint.kind.nq() == nv { nv } else { 0 };
            let lower = per_dof(&joint.lower[..joint.lower.len().min(limited)], joint.kind.nq(), f64::NEG_INFINITY);
            let upper = per_dof(&joint.upper[..joint.upper.len().min(limited)], joint.kind.nq(), f64::INFINITY);
            model.limits.extend(lower.zip(upper));
        }
        model.topology = Topology::new(&tree).ok_or(Malformed::Empty)?;
        Ok(model)
    }

    /// The same model with parameters in another scalar.
    pub fn lift<Q: Real>(&self) -> Model<Q>
    where
        P: Lift<Q>,
    {
        Model {
            topology: self.topology.clone(),
            labels: self.labels.clone(),
            placements: self.placements.iter().map(|x| x.lift()).collect(),
            subspaces: self.subspaces.iter().map(|s| s.lift()).collect(),
            inertias: self.inertias.iter().map(|i| i.lift()).collect(),
            armature: self.armature.iter().map(|a| a.lift()).collect(),
            gravity: self.gravity.lift(),
            damping: self.damping.clone(),
            friction: self.friction.clone(),
            limits: self.limits.clone(),
            described: self.described.clone(),
            warnings: self.warnings.clone(),
        }
    }

    /// The placement of body `i` in its parent at configuration `q` (the whole vector), in compiled axes of both.
    #[inline(always)]
    pub fn joint_transform<T: Real>(&self, i: usize, q: &[T]) -> Transform<T>
    where
        P: Lift<T>,
    {
        let joint = &self.topology.joints()[i];
        joint.kind.transform(&self.placements[i], &self.subspaces[i], &q[joint.q..])
    }
}

fn vec3<P: Real>(v: [f64; 3]) -> Vec3<P> {
    Vec3::from_array(v.map(P::from_f64))
}

fn per_dof(values: &[f64], count: usize, absent: f64) -> impl Iterator<Item = f64> + '_ {
    (0..count).map(move |k| values.get(k).copied().unwrap_or(absent))
}

/// A primitive joint, with the labels of its body's axes and its motion subspace in the compiled ones.
struct Primitive<P> {
    kind: JointKind,
    label: Label,
    subspace: Motion<P>,
}

/// The primitive joints of a described joint, from the parent outwards.
fn compile<P: Real>(kind: JointType) -> Vec<Primitive<P>> {
    let direction = |axis: [f64; 3]| {
        let axis = unit(axis);
        Vec3::from_array(from_fn(|k| P::from_exact(axis.rounded[k], axis.exact[k])))
    };
    // Where the axis points, the label, and the unit vector of the axis in the axes so labelled.
    let labelled = |axis: [f64; 3]| match Label::of_axis(unit(axis).rounded) {
        Some(label) => (Axis::Z, label, label.to_compiled(direction(axis))),
        None => (Axis::Skew, Label::Z, direction(axis)),
    };
    let turn = |axis: [f64; 3]| {
        let (axis, label, direction) = labelled(axis);
        Primitive { kind: JointKind::Revolute(axis), label, subspace: Motion::new(direction, Vec3::zero()) }
    };
    let slide = |axis: [f64; 3]| {
        let (axis, label, direction) = labelled(axis);
        Primitive { kind: JointKind::Prismatic(axis), label, subspace: Motion::new(Vec3::zero(), direction) }
    };
    let as_described = |kind: JointKind, subspace: Motion<P>| Primitive { kind, label: Label::Z, subspace };
    match kind {
        JointType::Fixed => Vec::new(),
        JointType::Revolute { axis } => vec![turn(axis)],
        JointType::Prismatic { axis } => vec![slide(axis)],
        JointType::Helical { axis, pitch } => {
            let axis = direction(axis);
            vec![as_described(JointKind::Helical, Motion::new(axis, axis * P::from_f64(pitch)))]
        }
        JointType::Spherical => vec![as_described(JointKind::Spherical, Motion::zero())],
        JointType::Free => vec![as_described(JointKind::Free, Motion::zero())],
        row => row.row().into_iter().map(|joint| if joint.turns { turn(joint.axis) } else { slide(joint.axis) }).collect(),
    }
}
