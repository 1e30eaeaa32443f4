//! A robot in multi-precision: the numbers of a description, with exact directions and rotations.
//!
//! Computes: masses, centres, inertias, translations, pitches, armature and gravity are exactly the doubles of the *canonical* description.
//! Doubles only approximate a direction or a rotation. So an axis u is replaced by u/|u|, a quaternion p by p/|p|, and a rotation R by its
//! orthogonal polar factor, the limit of R ← ½(R + R⁻ᵀ).
//! Without that the question would have no answer beyond 1e-16: formulations that are equal for rigid bodies differ for sheared ones.
//! Source: Higham, *Functions of Matrices* (2008), §8.3. Cost: O(bodies), a few dozen vector products each.

use crate::space::{Mat3, Vec3};
use crate::{Error, Mp, Precision};
use featherbench_model::{BodyDescription, Description, JointType};
use std::array::from_fn;

/// A joint's kind with its exact parameters.
#[derive(Clone, Debug)]
pub(crate) enum Kind {
    Revolute(Vec3<Mp>),
    Prismatic(Vec3<Mp>),
    Helical(Vec3<Mp>, Mp),
    Spherical,
    Free,
    Planar,
    Universal,
    Translation,
    Cylindrical(Vec3<Mp>),
    EulerZyx,
}

/// A body and the joint that carries it.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub name: String,
    pub parent: Option<usize>,
    pub mass: Mp,
    /// Centre of mass in body axes.
    pub com: Vec3<Mp>,
    /// Inertia about the centre of mass in body axes.
    pub inertia: Mat3<Mp>,
    /// The joint frame in the parent's.
    pub rotation: Mat3<Mp>,
    pub translation: Vec3<Mp>,
    pub kind: Kind,
    /// The name of the kind.
    pub word: &'static str,
    /// Where the joint's numbers begin in q and v, and how many it has of v.
    pub q: usize,
    pub v: usize,
    pub nv: usize,
}

/// A robot whose parameters are multi-precision numbers.
///
/// The coordinates are the neutral ones of `CONVENTIONS.md`.
#[derive(Clone, Debug)]
pub struct Robot {
    pub(crate) precision: Precision,
    pub(crate) gravity: Vec3<Mp>,
    pub(crate) bodies: Vec<Body>,
    pub(crate) armature: Vec<Mp>,
    nq: usize,
    nv: usize,
}

impl Robot {
    /// The robot of a description.
    ///
    /// # Errors
    /// [`Error::Malformed`] when the description is not a robot, [`Error::NoDirection`] when an axis or rotation is singular.
    pub fn new(description: &Description, precision: Precision) -> Result<Self, Error> {
        let canonical = description.canonical()?;
        let vector = |v: [f64; 3]| exact_vector(precision, "description", v);
        let mut robot =
            Self { precision, gravity: vector(canonical.gravity)?, bodies: Vec::new(), armature: Vec::new(), nq: canonical.nq(), nv: 0 };
        let mut q = 0;
        for body in &canonical.bodies {
            let kind = body.joint.kind;
            robot.bodies.push(exact_body(precision, body, q, robot.nv)?);
            for dof in 0..kind.nv() {
                let armature = body.joint.armature.get(dof).copied().unwrap_or(0.0);
                robot.armature.push(precision.number(armature).ok_or(Error::NotFinite { array: "armature", index: robot.nv + dof })?);
            }
            q += kind.nq();
            robot.nv += kind.nv();
        }
        Ok(robot)
    }

    /// Length of q.
    pub fn nq(&self) -> usize {
        self.nq
    }

    /// Degrees of freedom.
    pub fn nv(&self) -> usize {
        self.nv
    }

    /// Moving bodies.
    pub fn bodies(&self) -> usize {
        self.bodies.len()
    }

    /// The precision of its computations.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Doubles as exact numbers.
    ///
    /// # Errors
    /// [`Error::NotFinite`].
    pub fn numbers(&self, array: &'static str, values: &[f64]) -> Result<Vec<Mp>, Error> {
        values.iter().enumerate().map(|(index, &x)| self.precision.number(x).ok_or(Error::NotFinite { array, index })).collect()
    }

    pub(crate) fn check(array: &'static str, found: usize, expected: usize) -> Result<(), Error> {
        if found == expected { Ok(()) } else { Err(Error::Length { array, found, expected }) }
    }
}

pub(crate) fn exact_vector(precision: Precision, array: &'static str, v: [f64; 3]) -> Result<Vec3<Mp>, Error> {
    let [x, y, z] = v.map(|x| precision.number(x));
    match (x, y, z) {
        (Some(x), Some(y), Some(z)) => Ok(Vec3([x, y, z])),
        _ => Err(Error::NotFinite { array, index: 0 }),
    }
}

fn exact_body(precision: Precision, body: &BodyDescription, q: usize, v: usize) -> Result<Body, Error> {
    let vector = |v: [f64; 3]| exact_vector(precision, "description", v);
    let axis = |axis: [f64; 3]| {
        let axis = vector(axis)?;
        let length = axis.dot(&axis).sqrt();
        if length.is_zero() {
            Err(Error::NoDirection { body: body.name.clone(), what: "the axis" })
        } else {
            Ok(Vec3(axis.0.map(|x| x / &length)))
        }
    };
    let kind = match body.joint.kind {
        JointType::Revolute { axis: u } => Kind::Revolute(axis(u)?),
        JointType::Prismatic { axis: u } => Kind::Prismatic(axis(u)?),
        JointType::Helical { axis: u, pitch } => Kind::Helical(axis(u)?, vector([pitch, 0.0, 0.0])?.0[0].clone()),
        JointType::Spherical => Kind::Spherical,
        JointType::Free => Kind::Free,
        JointType::Planar => Kind::Planar,
        JointType::Universal => Kind::Universal,
        JointType::Translation => Kind::Translation,
        JointType::Cylindrical { axis: u } => Kind::Cylindrical(axis(u)?),
        JointType::EulerZyx => Kind::EulerZyx,
        JointType::Fixed => return Err(Error::Unsupported { body: body.name.clone(), kind: "fixed" }),
    };
    let [xx, xy, xz, yy, yz, zz] = body.inertia;
    let r = body.joint.placement.rotation;
    let rows = Mat3([vector([r[0], r[1], r[2]])?, vector([r[3], r[4], r[5]])?, vector([r[6], r[7], r[8]])?]);
    let rotation =
        nearest_rotation(precision, rows).ok_or(Error::NoDirection { body: body.name.clone(), what: "the placement's rotation" })?;
    Ok(Body {
        name: body.name.clone(),
        parent: body.parent,
        mass: vector([body.mass, 0.0, 0.0])?.0[0].clone(),
        com: vector(body.com)?,
        inertia: Mat3([vector([xx, xy, xz])?, vector([xy, yy, yz])?, vector([xz, yz, zz])?]),
        rotation,
        translation: vector(body.joint.placement.translation)?,
        word: body.joint.kind.name(),
        kind,
        q,
        v,
        nv: body.joint.kind.nv(),
    })
}

/// The orthogonal polar factor, by Newton's iteration R ← ½(R + R⁻ᵀ): the error is squared in each step.
fn nearest_rotation(precision: Precision, mut r: Mat3<Mp>) -> Option<Mat3<Mp>> {
    // From 1e-6, which a description may deviate, to 2^-bits: log2(bits/20) steps, and two more.
    let steps = 3 + usize::BITS - (precision.get() / 20).leading_zeros();
    for _ in 0..steps {
        let [a, b, c] = &r.0;
        let cofactors = Mat3([b.cross(c), c.cross(a), a.cross(b)]);
        let determinant = a.dot(&cofactors.0[0]);
        if determinant.is_zero() || determinant.is_negative() {
            return None;
        }
        r = Mat3(from_fn(|i| Vec3(from_fn(|j| (&r.0[i].0[j] + &cofactors.0[i].0[j] / &determinant).half()))));
    }
    Some(r)
}
