//! Scenes: free bodies of rapier (maximal coordinates) with spheres and boxes over a half space.
//!
//! A contact of rapier is a damped spring that is solved implicitly by Gauss–Seidel sweeps over substeps. They aim at a relative velocity
//! that removes the penetration with the spring's rate. Then comes one more sweep without it. Friction has a round cone. Bodies have no
//! damping and do not sleep.

use crate::refusal::{Refusal, failed};
use featherbench_protocol::{Block, Message};
use featherbench_scenes::{Body, Geometry, Scene};
use rapier3d_f64::math::{Pose, Rotation, Vector};
use rapier3d_f64::prelude::{
    ColliderBuilder, ContactManifold, ContactPair, FrictionModel, IntegrationParameters, MassProperties, PhysicsWorld, RigidBody,
    RigidBodyBuilder, RigidBodyHandle, SpringCoefficients,
};
use serde_json::{Map, Value, json};

/// The most steps of a motion.
const MOST_STEPS: usize = 1_000_000;
/// Points of a manifold that share one friction of the simplified model.
const GROUP: usize = 4;

/// A way to move scenes: a friction model and the substeps of a step.
struct Variant {
    name: &'static str,
    friction: FrictionModel,
    substeps: usize,
}

/// Rapier's own settings; Coulomb's friction at each point; the same with sixteen times the substeps.
const VARIANTS: [Variant; 3] = [
    Variant { name: "simplified", friction: FrictionModel::Simplified, substeps: 4 },
    Variant { name: "coulomb", friction: FrictionModel::Coulomb, substeps: 4 },
    Variant { name: "coulomb_64_substeps", friction: FrictionModel::Coulomb, substeps: 64 },
];

impl Variant {
    fn parameters(&self, dt: f64) -> IntegrationParameters {
        IntegrationParameters {
            dt,
            friction_model: self.friction,
            num_solver_iterations: self.substeps,
            ..IntegrationParameters::default()
        }
    }

    /// What rows tell.
    fn settings(&self) -> Value {
        let it = self.parameters(1.0);
        let friction = match self.friction {
            FrictionModel::Simplified => "round cone, one force and one twist for up to four points",
            FrictionModel::Coulomb => "round cone at each point",
        };
        let spring = |of: SpringCoefficients<f64>| json!({"frequency": of.natural_frequency, "damping_ratio": of.damping_ratio});
        json!({
            "contact": format!("damped springs by sweeps over substeps, {friction}"),
            "coordinates": "maximal",
            "integrator": "semi-implicit Euler in each substep",
            "substeps": it.num_solver_iterations,
            "sweeps": it.num_internal_pgs_iterations,
            "sweeps_without_bias": it.num_internal_stabilization_iterations,
            "friction_in_bias_pass": it.friction_in_bias_pass,
            "spring": spring(it.contact_softness),
            "spring_on_fixed": spring(it.static_contact_softness),
            "warm_start": it.warmstart_coefficient,
            "largest_correction": it.normalized_max_corrective_velocity,
            "prediction": it.normalized_prediction_distance,
            "forces_told": "normal: mean of the step; tangential: of its last substep, that of a group at its points in equal parts",
        })
    }
}

/// The part of `hello` about scenes: variant → settings.
pub fn offered() -> Map<String, Value> {
    VARIANTS.iter().map(|variant| (variant.name.to_owned(), variant.settings())).collect()
}

/// The answer to the operation `scene`.
pub fn simulate(request: &Message) -> Result<Message, Refusal> {
    let name = request.text("variant");
    let variant = VARIANTS.iter().find(|variant| variant.name == name);
    let variant = variant.ok_or_else(|| Refusal::Unsupported(format!("rapier has no variant '{name}' of contact")))?;
    let whole = |key: &str| request.header.get(key).and_then(Value::as_u64).and_then(|number| usize::try_from(number).ok());
    let (steps, every) = (whole("steps").unwrap_or(0), request.header.get("every").map_or(Some(1), |_| whole("every")).unwrap_or(0));
    if every == 0 || steps < every || steps > MOST_STEPS {
        return Err(failed(format!("'steps' and 'every' must be whole numbers with 0 < every <= steps <= {MOST_STEPS}")));
    }
    let dt = request.header.get("dt").and_then(Value::as_f64).filter(|dt| dt.is_finite() && *dt > 0.0);
    let dt = dt.ok_or_else(|| failed("'dt' must be a positive number of seconds"))?;
    let mut scene = request.header.get("scene").cloned().ok_or_else(|| failed("there is no scene"))?;
    // A name says nothing about the motion: a scene without one is as good.
    if let Some(scene) = scene.as_object_mut() {
        scene.entry("name").or_insert_with(|| "scene".into());
    }
    let scene: Scene = serde_json::from_value(scene).map_err(|error| failed(format!("the scene is malformed: {error}")))?;
    scene.check().map_err(failed)?;
    let (mut world, bodies) = build(&scene, variant.parameters(dt));
    let mut motion = Vec::with_capacity(13 * bodies.len() * (steps / every));
    for step in 1..=steps {
        world.step();
        if step.is_multiple_of(every) {
            for &body in &bodies {
                motion.extend(numbers(&world.bodies[body]));
            }
        }
    }
    let substeps = variant.substeps as f64 / dt;
    let pushes: Vec<[f64; 8]> =
        world.contact_pairs().flat_map(|pair| pushes(&world, &bodies, pair, [1.0 / dt, substeps], variant.friction)).collect();
    let contacts = Block::new("contacts", &[pushes.len(), 8], &pushes.concat());
    Ok(Message::new(json!({}), vec![Block::new("motion", &[steps / every, bodies.len(), 13], &motion), contacts]))
}

/// The scene in a world.
fn build(scene: &Scene, parameters: IntegrationParameters) -> (PhysicsWorld, Vec<RigidBodyHandle>) {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::from(scene.gravity);
    world.integration_parameters = parameters;
    let placed = |collider: ColliderBuilder| collider.density(0.0).friction(scene.friction).restitution(scene.restitution);
    let up = rapier3d_f64::na::Unit::new_unchecked(Vector::Z);
    world.insert_collider(placed(ColliderBuilder::halfspace(up)), None);
    let mut bodies = Vec::with_capacity(scene.bodies.len());
    for body in &scene.bodies {
        let handle = world.insert_body(rigid(body));
        for shape in &body.shapes {
            let collider = match shape.geometry {
                Geometry::Sphere { radius } => ColliderBuilder::ball(radius),
                Geometry::Box { half: [x, y, z] } => ColliderBuilder::cuboid(x, y, z),
            };
            world.insert_collider(placed(collider).translation(Vector::from(shape.at)), Some(handle));
        }
        // Rapier keeps a force until it is reset.
        world.bodies[handle].add_force(Vector::from(body.force), true);
        bodies.push(handle);
    }
    (world, bodies)
}

fn rigid(body: &Body) -> RigidBodyBuilder {
    let mass = MassProperties::new(Vector::ZERO, body.mass, Vector::from(body.inertia));
    let pose = Pose::from_parts(Vector::from(body.position), Rotation::from_array(body.orientation).normalize());
    RigidBodyBuilder::dynamic()
        .pose(pose)
        .linvel(Vector::from(body.linear))
        .angvel(Vector::from(body.angular))
        .additional_mass_properties(mass)
        .gyroscopic_forces_enabled(true)
        .can_sleep(false)
}

/// Position, quaternion (x, y, z, w), linear and angular velocity. A body's origin is its centre of mass.
fn numbers(body: &RigidBody) -> Vec<f64> {
    let pose = body.position();
    let (linear, angular) = (body.linvel().to_array(), body.angvel().to_array());
    [&pose.translation.to_array()[..], &pose.rotation.to_array(), &linear, &angular].concat()
}

/// The forces of a pair's points during the last step. Impulses go to forces by 1/dt of the step and of a substep.
///
/// The manifold's normal points from the first body to the second, so the second is pushed along it. Friction is told for the first body.
fn pushes(world: &PhysicsWorld, bodies: &[RigidBodyHandle], pair: &ContactPair, rates: [f64; 2], friction: FrictionModel) -> Vec<[f64; 8]> {
    let index = |handle: Option<RigidBodyHandle>| bodies.iter().position(|&body| Some(body) == handle);
    let mut found = Vec::new();
    for manifold in pair.solver_manifolds() {
        let (first, second) = (index(manifold.data.rigid_body1), index(manifold.data.rigid_body2));
        let (on, from, sign) = match (first, second) {
            (other, Some(on)) => (on, other, 1.0),
            (Some(on), None) => (on, None, -1.0),
            (None, None) => continue,
        };
        for (point, tangential) in points(manifold, friction) {
            let (place, other) = manifold.data.solver_contact_world_points(point, &world.bodies);
            let normal = manifold.points.get(point.contact_indices()[0] as usize).map_or(0.0, |contact| contact.data.impulse);
            let force = sign * (rates[0] * normal * manifold.data.normal - rates[1] * tangential);
            if force != Vector::ZERO {
                let at = (place + other) / 2.0;
                found.push([on as f64, from.map_or(-1.0, |from| from as f64), at.x, at.y, at.z, force.x, force.y, force.z]);
            }
        }
    }
    found
}

/// The points that the solver saw, each with the friction impulse of the last substep on the first body.
fn points(manifold: &ContactManifold, friction: FrictionModel) -> impl Iterator<Item = (&rapier3d_f64::prelude::SolverContact, Vector)> {
    let seen = &manifold.data.solver_contacts;
    seen.iter().enumerate().map(move |(k, point)| {
        let told =
            manifold.points.get(point.contact_indices()[0] as usize).map_or(Vector::ZERO, |contact| contact.data.warmstart_tangent_world);
        let sharing = match friction {
            FrictionModel::Coulomb => 1,
            FrictionModel::Simplified => GROUP.min(seen.len() - k / GROUP * GROUP),
        };
        (point, told / sharing as f64)
    })
}
