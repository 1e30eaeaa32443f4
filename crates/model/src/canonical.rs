//! The canonical form of a description: valid, fixed joints merged, bodies in depth-first order.

use crate::{BodyDescription, Description, Frame, JointType, Malformed, Placement};
use spatial::{Mat3, Sym3, Transform, Vec3};

impl Description {
    /// The canonical form: validated, fixed joints merged into their parents (each merged body leaving a frame), depth-first order with
    /// siblings in their given order. Idempotent, and the identity on a description that is canonical already.
    ///
    /// # Errors
    /// [`Malformed`], naming the body and field.
    pub fn canonical(&self) -> Result<Self, Malformed> {
        self.validate()?;
        let order = self.depth_first();
        let mut result = Self { bodies: Vec::with_capacity(order.len()), frames: Vec::new(), ..self.clone() };

        // For each given body: the body that it became part of, and its placement there.
        let mut home: Vec<(Option<usize>, Transform<f64>)> = vec![(None, Transform::identity()); self.bodies.len()];
        for given in order {
            let body = &self.bodies[given];
            let (parent, on_parent) = body.parent.map_or((None, Transform::identity()), |parent| home[parent]);
            let placement = on_parent.compose(&body.joint.placement.to_transform());
            if body.joint.kind == JointType::Fixed {
                home[given] = (parent, placement);
                result.frames.push(Frame { name: body.name.clone(), body: parent, placement: Placement::from_transform(&placement) });
                if let Some(parent) = parent {
                    result.bodies[parent].absorb(body, &placement);
                }
            } else {
                home[given] = (Some(result.bodies.len()), Transform::identity());
                let mut moved = body.clone();
                moved.parent = parent;
                // Untouched unless something was merged above, so that a canonical description stays the same to the bit.
                if on_parent != Transform::identity() {
                    moved.joint.placement = Placement::from_transform(&placement);
                }
                result.bodies.push(moved);
            }
        }
        for frame in &self.frames {
            let (body, on_body) = frame.body.map_or((None, Transform::identity()), |body| home[body]);
            let placement = if on_body == Transform::identity() {
                frame.placement
            } else {
                Placement::from_transform(&on_body.compose(&frame.placement.to_transform()))
            };
            result.frames.push(Frame { name: frame.name.clone(), body, placement });
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
    /// As a spatial transform.
    pub fn to_transform(&self) -> Transform<f64> {
        Transform::new(Mat3::from_array(self.rotation), Vec3::from_array(self.translation))
    }

    /// From a spatial transform.
    pub fn from_transform(x: &Transform<f64>) -> Self {
        Self { rotation: x.rotation.to_array(), translation: x.translation.to_array() }
    }
}
