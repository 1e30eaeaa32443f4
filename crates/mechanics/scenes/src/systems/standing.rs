//! Generated robots that stand: their joints are locked, so that the contacts' wrench is that of statics.
//!
//! A locked robot is one rigid body. Its mass, centre and inertia are those of the six rows of the free joint in M(q):
//!
//! ```text
//! M_base = [ m 1    −m [c]× ]     rows and columns [linear; angular] in the base's axes, about the base's origin
//!          [ m [c]×  I_o    ]     I_c = I_o − m (c·c 1 − c cᵀ)
//! ```

use super::{Measure, Question, STEPS, level};
use crate::scene::Body;
use featherbench_dynamics::{DimensionError, Kinematics, mass_matrix};
use featherbench_model::{Model, neutral};
use featherbench_robots::Family;
use featherbench_spatial::{Vec3, smaller};
use nalgebra::{Matrix3, Rotation3, SymmetricEigen, UnitQuaternion, Vector3};
use serde::Serialize;
use serde_json::json;

/// A sphere of a robot that touches the ground: on a body, at a point in its described axes, m.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Foot {
    /// The body's name.
    pub body: String,
    /// The sphere's centre.
    pub at: [f64; 3],
    /// Its radius.
    pub radius: f64,
}

/// A generated robot with a free base on its feet, all joints locked, pushed sideways at its centre of mass.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Standing {
    /// The scene's name.
    pub name: &'static str,
    /// The robot, as `featherbench gen` takes it.
    pub robot: &'static str,
    /// Positions of joints, rad, by the end of the moved body's name; the others are zero.
    pub pose: Vec<(&'static str, f64)>,
    /// What touches.
    pub feet: Vec<Foot>,
    /// The push along x and y over the weight.
    pub push: [f64; 2],
    /// μ.
    pub friction: f64,
}

/// A robot as one rigid body, with the base's axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Locked {
    /// kg.
    pub mass: f64,
    /// The centre of mass, m, where the lowest foot touches the ground.
    pub centre: Vector3<f64>,
    /// About the centre, kg m².
    pub inertia: Matrix3<f64>,
    /// The centres of the feet, m.
    pub feet: Vec<Vector3<f64>>,
    /// The configuration.
    pub q: Vec<f64>,
    /// The robot.
    pub model: Model<f64>,
}

impl Standing {
    /// The quadruped with bent legs, pushed by 2 % of its weight forward and 3 % to the left.
    pub fn quadruped() -> Self {
        let legs = ["front_left", "front_right", "hind_left", "hind_right"];
        Self {
            name: "standing_quadruped",
            robot: "quadruped",
            pose: vec![("_thigh", 0.7), ("_shank", -1.4)],
            feet: legs.map(|leg| Foot { body: format!("{leg}_shank"), at: [0.0, 0.0, -0.22], radius: 0.02 }).to_vec(),
            push: [0.02, 0.03],
            friction: 0.6,
        }
    }

    /// The humanoid with bent knees on two flat feet of four points, pushed as the quadruped is.
    pub fn humanoid() -> Self {
        let sole = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let foot =
            |side: &str| sole.map(|(x, y)| Foot { body: format!("{side}_foot"), at: [0.03 + 0.09 * x, 0.03 * y, -0.03], radius: 0.02 });
        Self {
            name: "standing_humanoid",
            robot: "humanoid",
            pose: vec![("_thigh", -0.3), ("_shin", 0.6), ("_ankle", -0.3)],
            feet: ["left", "right"].map(foot).concat(),
            push: [0.02, 0.03],
            friction: 0.6,
        }
    }

    /// The robot as one rigid body. None if the generator has no such robot, it has no free base, or a foot is on no body.
    pub fn locked(&self) -> Option<Locked> {
        let description = Family::parse(self.robot).ok()?.generate().ok()?;
        let model: Model<f64> = Model::build(&description).ok()?;
        let mut q = neutral::<f64>(&model.topology);
        // A free base of seven coordinates, then one of each joint, in the order of the bodies.
        if q.len() != 7 + description.bodies.len() - 1 {
            return None;
        }
        for (body, position) in description.bodies.iter().skip(1).zip(&mut q[7..]) {
            *position = self.pose.iter().find(|(end, _)| body.name.ends_with(end)).map_or(0.0, |pose| pose.1);
        }
        let places = |q: &[f64]| -> Result<Vec<Option<Vector3<f64>>>, DimensionError> {
            let still = vec![0.0; model.topology.nv()];
            let mut kinematics = Kinematics::new(&model.topology);
            kinematics.run(&model, q, &still, &still)?;
            let of = |foot: &Foot| {
                let index = description.bodies.iter().position(|body| body.name == foot.body)?;
                let place = kinematics.body(*model.described.get(index)?)?.placement;
                Some(Vector3::from((place.rotation * Vec3::from_array(foot.at) + place.translation).to_array()))
            };
            Ok(self.feet.iter().map(of).collect())
        };
        let feet = places(&q).ok()?.into_iter().collect::<Option<Vec<_>>>()?;
        let lowest = feet.iter().zip(&self.feet).map(|(at, foot)| at.z - foot.radius).fold(f64::INFINITY, smaller);
        q[2] -= lowest;
        let feet = places(&q).ok()?.into_iter().collect::<Option<Vec<_>>>()?;
        let matrix = mass_matrix(&model, &q).ok()?.to_dense();
        let mass = matrix[(0, 0)];
        // The row of the moment about x has −m c_z under v_y and m c_y under v_z, and so on.
        let from_base = Vector3::new(matrix[(5, 1)], matrix[(3, 2)], matrix[(4, 0)]) / mass;
        let about_origin = Matrix3::from_fn(|row, column| matrix[(3 + row, 3 + column)]);
        let inertia = about_origin - mass * (Matrix3::identity() * from_base.norm_squared() - from_base * from_base.transpose());
        let centre = Vector3::new(q[0], q[1], q[2]) + from_base;
        Some(Locked { mass, centre, inertia, feet, q, model })
    }

    /// The question, which measures:
    ///
    /// - the contacts' wrench against weight and push, about the centre of mass, over the weight and the smallest distance of a foot,
    /// - how far the sum of their normal forces over the weight is from 1,
    /// - how far the robot sinks and drifts, over the height of its centre of mass.
    ///
    /// Where [`Standing::locked`] is none, the scene has no bodies, and every engine refuses it.
    pub fn question(&self) -> Question {
        let locked = self.locked();
        let gravity = 9.81;
        let bodies = locked.iter().map(|robot| self.body(robot, gravity)).collect();
        let (mass, centre) = locked.as_ref().map_or((f64::NAN, Vector3::repeat(f64::NAN)), |robot| (robot.mass, robot.centre));
        let arm = locked.iter().flat_map(|robot| &robot.feet).map(|foot| (foot - centre).xy().norm()).fold(f64::INFINITY, smaller);
        let weight = mass * gravity;
        let due = weight * Vector3::new(-self.push[0], -self.push[1], 1.0);
        Question {
            scene: level(self.name, gravity, self.friction, bodies),
            duration: 0.4,
            dts: STEPS,
            measures: vec![
                Measure::new("wrench_error", "1", 0.0, 1.0, move |motion| {
                    let at = motion.position(motion.last(), 0);
                    let force: Vector3<f64> = motion.pushes.iter().map(|push| push.force).sum();
                    let moment: Vector3<f64> = motion.pushes.iter().map(|push| (push.at - at).cross(&push.force)).sum();
                    ((force - due).norm() + moment.norm() / arm) / weight
                }),
                Measure::new("normal_error", "1", 0.0, 1.0, move |motion| {
                    (motion.pushes.iter().map(|push| push.force.z).sum::<f64>() / weight - 1.0).abs()
                }),
                Measure::new("sinking", "1", 0.0, 1.0, move |motion| (centre.z - motion.position(motion.last(), 0).z) / centre.z),
                Measure::new("drift", "1", 0.0, 1.0, move |motion| (motion.position(motion.last(), 0) - centre).xy().norm() / centre.z),
            ],
            params: json!(self),
        }
    }

    /// The body of the scene: axes are the principal ones.
    fn body(&self, robot: &Locked, gravity: f64) -> Body {
        let eigen = SymmetricEigen::new(robot.inertia);
        let axes = eigen.eigenvectors * eigen.eigenvectors.determinant().signum();
        let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        let weight = robot.mass * gravity;
        let mut body = Body::new(self.robot, robot.mass, 0.0, robot.centre.into());
        body.inertia = eigen.eigenvalues.into();
        body.orientation = turn.coords.into();
        body.force = [self.push[0] * weight, self.push[1] * weight, 0.0];
        for (foot, at) in self.feet.iter().zip(&robot.feet) {
            body = body.with_sphere(foot.radius, (turn.inverse() * (at - robot.centre)).into());
        }
        body
    }
}
