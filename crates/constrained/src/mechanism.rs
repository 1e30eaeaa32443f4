//! A robot with loops: the description of its tree, and the joints that close the loops.

use crate::attachment::Attachment;
use crate::constraint::{Constraint, Constraints, Law, LoopMotion};
use crate::graph::{BadGraph, Edge, Graph};
use crate::malformed::BadConstraint;
use featherbench_model::{Description, Malformed, Model, Placement};
use featherbench_spatial::Transform;
use thiserror::Error;

/// A joint that closes a loop, between bodies of a description.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopJoint {
    /// Its name.
    pub name: String,
    /// The name of the first body, or of a frame of the description; `None` for the world. Rows have its axes.
    pub first: Option<String>,
    /// The joint's frame on it. Its axis is z.
    pub first_placement: Placement,
    /// The name of the second body, or of a frame of the description; `None` for the world.
    pub second: Option<String>,
    /// The joint's frame on it. Its axis is z.
    pub second_placement: Placement,
    /// What it leaves free.
    pub motion: LoopMotion,
}

/// A robot with loops: its graph, its compiled tree, and a constraint for each loop joint.
#[derive(Clone, Debug)]
pub struct Mechanism {
    /// Links and joints.
    pub graph: Graph,
    /// The tree.
    pub model: Model<f64>,
    /// The loop joints, then the other constraints.
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
    /// A loop joint on a body that does not exist.
    #[error("loop joint '{joint}': there is no body or frame '{body}'")]
    NoBody {
        /// The loop joint.
        joint: String,
        /// The name given.
        body: String,
    },
}

impl Mechanism {
    /// The robot of a description and its loop joints. Fixed joints are merged, as in the model. `others` are the constraints that are
    /// no joints between links, such as gears; they take the compiled model.
    ///
    /// # Errors
    /// [`BadMechanism`], which names the body, joint or constraint.
    ///
    /// ```
    /// use featherbench_constrained::{LoopJoint, LoopMotion, Mechanism};
    /// use featherbench_model::Placement;
    /// use featherbench_robots::Family;
    /// let chain = Family::parse("chain:n=4")?.generate()?;
    /// let (first, second) = (None, Some(chain.bodies[3].name.clone()));
    /// let place = Placement::default();
    /// let motion = LoopMotion::Spherical;
    /// let closing = LoopJoint { name: "tip".into(), first, first_placement: place, second, second_placement: place, motion };
    /// let ring = Mechanism::new(&chain, &[closing], |_| Vec::new())?;
    /// assert_eq!((ring.graph.loops(), ring.constraints.rows()), (1, 3));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        description: &Description,
        loops: &[LoopJoint],
        others: impl FnOnce(&Model<f64>) -> Vec<Constraint>,
    ) -> Result<Self, BadMechanism> {
        let canonical = description.canonical()?;
        let model: Model<f64> = Model::build(&canonical)?;
        let find =
            |joint: &LoopJoint, name: &Option<String>, placement: &Placement| -> Result<(Option<usize>, Transform<f64>), BadMechanism> {
                let Some(name) = name else { return Ok((None, placement.to_transform())) };
                if let Some(body) = canonical.bodies.iter().position(|body| body.name == *name) {
                    return Ok((Some(body), placement.to_transform()));
                }
                // A merged body has left a frame.
                let frame = canonical.frames.iter().find(|frame| frame.name == *name);
                let frame = frame.ok_or_else(|| BadMechanism::NoBody { joint: joint.name.clone(), body: name.clone() })?;
                Ok((frame.body, frame.placement.to_transform().compose(&placement.to_transform())))
            };
        let links = canonical.bodies.iter().map(|body| body.name.clone()).collect();
        let mut edges: Vec<Edge> = Vec::new();
        for (child, body) in canonical.bodies.iter().enumerate() {
            // A joint without a name of its own has that of its body.
            let name = if body.joint.name.is_empty() { body.name.clone() } else { body.joint.name.clone() };
            edges.push(Edge { name, parent: body.parent, child: Some(child), freedom: body.joint.kind.nv(), cut: false });
        }
        let mut list = Vec::new();
        for joint in loops {
            let (parent, first) = find(joint, &joint.first, &joint.first_placement)?;
            let (child, second) = find(joint, &joint.second, &joint.second_placement)?;
            edges.push(Edge { name: joint.name.clone(), parent, child, freedom: joint.motion.freedom(), cut: true });
            let attach = |body: Option<usize>, placement| Attachment { body: body.map(|body| model.described[body]), placement };
            let law = Law::Joint { first: attach(parent, first), second: attach(child, second), motion: joint.motion };
            list.push(Constraint { name: joint.name.clone(), law });
        }
        let graph = Graph::new(links, edges)?;
        list.extend(others(&model));
        let constraints = Constraints::new(&model.topology, list)?;
        Ok(Self { graph, model, constraints })
    }
}
