//! A robot with loops: the description of its tree, and the joints that close the loops.

use crate::attachment::Attachment;
use crate::constraint::{Constraint, Constraints, Law};
use crate::graph::{BadGraph, Edge, Graph};
use crate::malformed::BadConstraint;
use featherbench_model::{Description, JointType, Loop, LoopEnd, LoopKind, LoopMotion, Malformed, Model};
use featherbench_spatial::{Transform, Vec3};
use thiserror::Error;

/// A robot with loops: its graph, its compiled tree, and a constraint for each loop joint.
#[derive(Clone, Debug)]
pub struct Mechanism {
    /// Links and joints.
    pub graph: Graph,
    /// The tree.
    pub model: Model<f64>,
    /// Those of the description's loops that are joints, then those of the others.
    pub constraints: Constraints,
}

/// Why a description with loops is no robot.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BadMechanism {
    /// The tree is malformed.
    #[error(transparent)]
    Tree(#[from] Malformed),
    /// Links and joints are no robot.
    #[error(transparent)]
    Graph(#[from] BadGraph),
    /// A constraint is none.
    #[error(transparent)]
    Constraint(#[from] BadConstraint),
}

impl Mechanism {
    /// The robot of a description with its own loops. Those that are joints close cycles of the graph.
    ///
    /// # Errors
    /// [`BadMechanism`], which names the body, joint or loop.
    ///
    /// ```
    /// use featherbench_constrained::{Constrained, Kkt, Mechanism};
    /// use featherbench_model::{Loop, LoopKind};
    /// use featherbench_robots::Family;
    /// // The last of three joints turns as far as the first.
    /// let mut chain = Family::parse("chain:n=3")?.generate()?;
    /// let polynomial = [0.0, 1.0, 0.0, 0.0, 0.0];
    /// chain.loops = vec![Loop { name: "coupled".into(), kind: LoopKind::Mimic { follower: 2, leader: 0, polynomial } }];
    /// let coupled = Mechanism::of(&chain)?;
    /// let mut dynamics = Constrained::new(&coupled.model, &coupled.constraints)?;
    /// let acceleration = dynamics.run(&[0.1, 0.2, 0.1], &[0.0; 3], &[0.0; 3], &Kkt::default())?.acceleration;
    /// assert!((acceleration[2] - acceleration[0]).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(description: &Description) -> Result<Self, BadMechanism> {
        let canonical = description.canonical()?;
        let model: Model<f64> = Model::build(&canonical)?;
        let links = canonical.bodies.iter().map(|body| body.name.clone()).collect();
        let mut edges: Vec<Edge> = Vec::new();
        for (child, body) in canonical.bodies.iter().enumerate() {
            // A joint without a name of its own has that of its body.
            let name = if body.joint.name.is_empty() { body.name.clone() } else { body.joint.name.clone() };
            edges.push(Edge { name, parent: body.parent, child: Some(child), freedom: body.joint.kind.nv(), cut: false });
        }
        for Loop { name, kind } in &canonical.loops {
            if let LoopKind::Joint { ends: [parent, child], motion } = kind {
                let (name, freedom) = (name.clone(), motion.freedom());
                edges.push(Edge { name, parent: parent.body, child: child.body, freedom, cut: true });
            }
        }
        let graph = Graph::new(links, edges)?;
        let (joints, others): (Vec<&Loop>, Vec<&Loop>) = canonical.loops.iter().partition(|tie| matches!(tie.kind, LoopKind::Joint { .. }));
        let constraint = |tie: &Loop| Constraint { name: tie.name.clone(), law: law(&tie.kind, &model) };
        let list = joints.into_iter().chain(others).map(constraint).collect();
        let constraints = Constraints::new(&model.topology, list)?;
        Ok(Self { graph, model, constraints })
    }
}

/// Grübler's count in a plane, of the loops that are joints: `Σ freedom − 3·loops`, where a joint's freedom is what it leaves in the plane. A
/// point that is held leaves one rotation there, and takes two freedoms.
///
/// `None` if the robot does not move in one plane: at zero coordinates every axis of rotation has one direction, and every slide is across it.
///
/// ```
/// use featherbench_constrained::{gruebler_in_plane, systems::Ladder};
/// assert_eq!(gruebler_in_plane(&Ladder::default().description()), Some(1));
/// ```
pub fn gruebler_in_plane(description: &Description) -> Option<i64> {
    let canonical = description.canonical().ok()?;
    let z = Vec3::new(0.0, 0.0, 1.0);
    let (mut turning, mut sliding, mut either) = (Vec::new(), Vec::new(), Vec::new());
    let (mut places, mut freedom): (Vec<Transform<f64>>, i64) = (Vec::new(), 0);
    for body in &canonical.bodies {
        let place = body.joint.placement.to_transform();
        let place = body.parent.map_or(place, |parent| places[parent].compose(&place));
        match body.joint.kind {
            JointType::Revolute { axis } => turning.push(place.rotation * Vec3::from_array(axis)),
            JointType::Prismatic { axis } => sliding.push(place.rotation * Vec3::from_array(axis)),
            JointType::Planar => turning.push(place.rotation * z),
            _ => return None,
        }
        freedom += body.joint.kind.nv() as i64;
        places.push(place);
    }
    for Loop { kind, .. } in &canonical.loops {
        let LoopKind::Joint { ends: [end, _], motion } = kind else { continue };
        let place = end.placement.to_transform();
        let axis = end.body.map_or(place, |body| places[body].compose(&place)).rotation * z;
        let left = match motion {
            LoopMotion::Fixed => 0,
            LoopMotion::Spherical => 1,
            LoopMotion::Revolute => {
                turning.push(axis);
                1
            }
            LoopMotion::Prismatic => {
                sliding.push(axis);
                1
            }
            LoopMotion::Cylindrical => {
                either.push(axis);
                1
            }
            LoopMotion::Planar => {
                turning.push(axis);
                3
            }
        };
        freedom += left - 3;
    }
    // Files give directions with six digits or more.
    let parallel = |a: Vec3<f64>, b: Vec3<f64>| a.cross(b).norm() <= 1e-6;
    let across = |a: Vec3<f64>, b: Vec3<f64>| a.dot(b).abs() <= 1e-6;
    let normal = *turning.first()?;
    let flat = turning.iter().all(|&axis| parallel(axis, normal))
        && sliding.iter().all(|&axis| across(axis, normal))
        && either.iter().all(|&axis| parallel(axis, normal) || across(axis, normal));
    flat.then_some(freedom)
}

/// The law of a loop of a canonical description.
fn law(kind: &LoopKind, model: &Model<f64>) -> Law {
    let attach = |end: &LoopEnd| Attachment { body: end.body.map(|body| model.described[body]), placement: end.placement.to_transform() };
    let dof = |body: usize| model.topology.joints()[model.described[body]].v;
    match kind {
        LoopKind::Joint { ends: [first, second], motion } => Law::Joint { first: attach(first), second: attach(second), motion: *motion },
        LoopKind::Point { ends: [first, second], axes } => Law::Point { first: attach(first), second: attach(second), axes: *axes },
        LoopKind::Distance { ends: [first, second], length } => {
            Law::Distance { first: attach(first), second: attach(second), length: *length }
        }
        LoopKind::Gear { terms, offset } => {
            Law::Gear { terms: terms.iter().map(|&(body, coefficient)| (dof(body), coefficient)).collect(), offset: *offset }
        }
        LoopKind::Mimic { follower, leader, polynomial } => {
            Law::Mimic { follower: dof(*follower), leader: dof(*leader), polynomial: *polynomial }
        }
    }
}
