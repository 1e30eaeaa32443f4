//! The canonical form of a description: valid, axes and rotations normalised, fixed joints merged, bodies in depth-first order.

use crate::orthonormal::{nearest_rotation, rotation, unit};
use crate::{
    BodyDescription, Continuum, Description, Frame, JointDescription, JointType, LoopDefect, LoopEnd, Malformed, Placement, ResidualLaw,
};
use featherbench_spatial::{DoubleDouble, Mat3, Real, Sym3, Transform, Vec3};
use std::borrow::Cow;

impl Description {
    /// The canonical form: validated, axes and rotations of joints normalised, fixed joints merged into their parents, depth-first order.
    /// Each merged body leaves a frame. Siblings keep their order. A canonical description is its own canonical form.
    ///
    /// A written axis stands for the unit vector along it, a written rotation for the nearest one. Both, and the products of merged
    /// placements, are formed with 32 digits and rounded once. A change by more than an ulp is a [`Warning`](crate::Warning) of the
    /// description as given.
    ///
    /// # Errors
    /// [`Malformed`], naming the body and field.
    pub fn canonical(&self) -> Result<Self, Malformed> {
        self.validate()?;
        self.made_canonical()
    }

    /// A description with the canonical bodies, without a copy where they are canonical as given. Its frames, loops and continua may differ.
    pub(crate) fn with_canonical_bodies(&self) -> Result<Cow<'_, Self>, Malformed> {
        self.validate()?;
        if self.has_canonical_bodies() { Ok(Cow::Borrowed(self)) } else { self.made_canonical().map(Cow::Owned) }
    }

    /// Whether there is a body, each joint moves, bodies are in depth-first order, and axes and rotations are normalised.
    fn has_canonical_bodies(&self) -> bool {
        let mut path: Vec<usize> = Vec::new();
        for (i, BodyDescription { parent, joint, .. }) in self.bodies.iter().enumerate() {
            while path.last().copied() != *parent {
                if path.pop().is_none() {
                    return false;
                }
            }
            path.push(i);
            let unit_axis = joint.kind.axis().is_none_or(|axis| unit(axis).rounded == axis);
            let matrix = joint.placement.rotation;
            if joint.kind == JointType::Fixed || !unit_axis || rotation(matrix).rounded != matrix {
                return false;
            }
        }
        !self.bodies.is_empty()
    }

    /// The canonical form of a valid description.
    fn made_canonical(&self) -> Result<Self, Malformed> {
        let order = self.depth_first();
        let mut result = Self {
            name: self.name.clone(),
            gravity: self.gravity,
            bodies: Vec::with_capacity(order.len()),
            frames: Vec::new(),
            loops: Vec::with_capacity(self.loops.len()),
            continua: Vec::with_capacity(self.continua.len()),
            residuals: self.residuals.clone(),
            uncertain: self.uncertain.clone(),
            provenance: self.provenance.clone(),
        };

        // For each given body: the body that it became part of, and its placement there.
        let mut home: Vec<(Option<usize>, Transform<DoubleDouble>)> = vec![(None, Transform::identity()); self.bodies.len()];
        for given in order {
            let body = &self.bodies[given];
            let (parent, on_parent) = body.parent.map_or((None, Transform::identity()), |parent| home[parent]);
            let written = rotation(body.joint.placement.rotation);
            let exact = Transform::new(Mat3::from_array(written.exact), wide(body.joint.placement.translation));
            // Normalised numbers to which nothing was merged stay the same to the bit.
            let (exact, placement) = if on_parent == Transform::identity() {
                (exact, Placement { rotation: written.rounded, ..body.joint.placement })
            } else {
                let merged = merged(&on_parent, &exact);
                (merged, narrow(&merged))
            };
            if body.joint.kind == JointType::Fixed {
                home[given] = (parent, exact);
                result.frames.push(Frame { name: body.name.clone(), body: parent, placement });
                if let Some(parent) = parent {
                    result.bodies[parent].absorb(body, &placement.to_transform());
                }
            } else {
                home[given] = (Some(result.bodies.len()), Transform::identity());
                let mut moved = body.clone();
                moved.parent = parent;
                moved.joint.normalise();
                moved.joint.placement = placement;
                result.bodies.push(moved);
            }
        }
        for frame in &self.frames {
            let (body, on_body) = frame.body.map_or((None, Transform::identity()), |body| home[body]);
            result.frames.push(Frame { name: frame.name.clone(), body, placement: frame.placement.on(&on_body) });
        }
        for (index, given) in self.loops.iter().enumerate() {
            let mut tie = given.clone();
            if let Some(ends) = tie.ends_mut() {
                for end in ends.iter_mut() {
                    let (body, on_body) = end.body.map_or((None, Transform::identity()), |body| home[body]);
                    *end = LoopEnd { body, placement: end.placement.on(&on_body) };
                }
                if ends[0].body == ends[1].body {
                    return Err(Malformed::Loop { name: given.name.clone(), index, defect: LoopDefect::SameBody });
                }
            }
            // Their joints move: so each has a body of its own.
            tie.joints_mut().into_iter().for_each(|body| *body = home[*body].0.unwrap_or(*body));
            result.loops.push(tie);
        }
        for given in &self.continua {
            let (body, on_body) = given.body.map_or((None, Transform::identity()), |body| home[body]);
            result.continua.push(Continuum { body, placement: given.placement.on(&on_body), ..given.clone() });
        }
        for residual in &mut result.residuals {
            if let (ResidualLaw::Payload { com, inertia, .. }, [carrier]) = (&mut residual.law, residual.bodies.as_mut_slice()) {
                let (body, on_body) = home[*carrier];
                *carrier = body.unwrap_or(*carrier);
                if on_body != Transform::identity() {
                    let placement: Transform<f64> = on_body.lift();
                    *com = placement.point(Vec3::from_array(*com)).to_array();
                    *inertia = Sym3::from_array(*inertia).rotate(placement.rotation).to_array();
                }
                continue;
            }
            // Their joints move: so each has a body of its own.
            residual.bodies.iter_mut().for_each(|body| *body = home[*body].0.unwrap_or(*body));
        }
        // Their bodies move: so each is a body of its own.
        for target in result.uncertain.variables.iter_mut().flat_map(|variable| &mut variable.on) {
            target.body = home[target.body].0.unwrap_or(target.body);
        }
        if result.bodies.is_empty() {
            return Err(Malformed::Empty);
        }
        Ok(result)
    }

    /// The bodies in depth-first order. The description must be a forest rooted at the world.
    fn depth_first(&self) -> Vec<usize> {
        let mut children = vec![Vec::new(); self.bodies.len()];
        let mut stack = Vec::new();
        for (i, body) in self.bodies.iter().enumerate().rev() {
            match body.parent {
                Some(parent) => children[parent].push(i),
                None => stack.push(i),
            }
        }
        let mut order = Vec::with_capacity(self.bodies.len());
        while let Some(body) = stack.pop() {
            order.push(body);
            stack.append(&mut children[body]);
        }
        order
    }
}

fn wide(v: [f64; 3]) -> Vec3<DoubleDouble> {
    Vec3::from_array(v.map(Real::from_f64))
}

/// The nearest doubles.
fn narrow(x: &Transform<DoubleDouble>) -> Placement {
    Placement::from_transform(&x.lift())
}

/// A placement on a body that was merged. It is normalised again: a long product of rotations is orthonormal to fewer than 32 digits.
fn merged(on_parent: &Transform<DoubleDouble>, placement: &Transform<DoubleDouble>) -> Transform<DoubleDouble> {
    let product = on_parent.compose(placement);
    Transform::new(nearest_rotation(product.rotation), product.translation)
}

impl JointDescription {
    /// Makes a unit vector of the axis and a rotation of the placement's matrix, each rounded once.
    ///
    /// Numbers that validation refuses (an axis of length zero, a matrix far from a rotation) give no meaningful result.
    pub fn normalise(&mut self) {
        if let Some(axis) = self.kind.axis_mut() {
            *axis = unit(*axis).rounded;
        }
        self.placement.rotation = rotation(self.placement.rotation).rounded;
    }
}

impl BodyDescription {
    /// Adds another body, fixed at `placement`, to this one's mass, centre of mass and inertia.
    fn absorb(&mut self, other: &Self, placement: &Transform<f64>) {
        if other.mass == 0.0 && other.inertia == [0.0; 6] {
            return;
        }
        let com = Vec3::from_array(self.com);
        let other_com = placement.point(Vec3::from_array(other.com));
        let mass = self.mass + other.mass;
        let joint_com = if mass > 0.0 { (com * self.mass + other_com * other.mass) * (1.0 / mass) } else { com };
        let about_joint = |inertia: Sym3<f64>, mass: f64, at: Vec3<f64>| inertia + Sym3::point_mass(mass, at - joint_com);
        let own = about_joint(Sym3::from_array(self.inertia), self.mass, com);
        let others = about_joint(Sym3::from_array(other.inertia).rotate(placement.rotation), other.mass, other_com);
        self.inertia = (own + others).to_array();
        self.com = joint_com.to_array();
        self.mass = mass;
    }
}

impl Placement {
    /// The same placement with the doubles of the rotation that its matrix stands for. The matrix must be one that validation accepts.
    pub fn normalised(&self) -> Self {
        Self { rotation: rotation(self.rotation).rounded, ..*self }
    }

    /// The placement on the body that its own body became part of, at `on_body` there. The rotation is normalised.
    fn on(&self, on_body: &Transform<DoubleDouble>) -> Self {
        if *on_body == Transform::identity() {
            return self.normalised();
        }
        let exact = Mat3::from_array(rotation(self.rotation).exact);
        narrow(&merged(on_body, &Transform::new(exact, wide(self.translation))))
    }

    /// As a spatial transform.
    pub fn to_transform(&self) -> Transform<f64> {
        Transform::new(Mat3::from_array(self.rotation), Vec3::from_array(self.translation))
    }

    /// From a spatial transform.
    pub fn from_transform(x: &Transform<f64>) -> Self {
        Self { rotation: x.rotation.to_array(), translation: x.translation.to_array() }
    }
}
