//! A robot with loops: the description of its tree, and the joints that close the loops.

use crate::attachment::Attachment;
use crate::constraint::{Constraint, Constraints, Law};
use crate::graph::{BadGraph, Edge, Graph};
use crate::malformed::BadConstraint;
use crate::solve::Method;
use crate::{Closed, Dynamics, Error, Tree};
use featherbench_model::{Description, Loop, LoopEnd, LoopKind, LoopMotion, Malformed, Model, Placement};
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
    /// The description's loop joints, further loop joints, the description's other loops, and further constraints, in this order.
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
    /// The robot of a description with its own loops. Those that are joints close cycles of the graph.
    ///
    /// # Errors
    /// [`BadMechanism`], which names the body, joint or loop.
    ///
    /// ```
    /// use featherbench_constrained::{Kkt, Mechanism};
    /// use featherbench_model::{Loop, LoopKind};
    /// use featherbench_robots::Family;
    /// // The last of three joints turns as far as the first.
    /// let mut chain = Family::parse("chain:n=3")?.generate()?;
    /// let polynomial = [0.0, 1.0, 0.0, 0.0, 0.0];
    /// chain.loops = vec![Loop { name: "coupled".into(), kind: LoopKind::Mimic { follower: 2, leader: 0, polynomial } }];
    /// let coupled = Mechanism::of(&chain)?;
    /// let mut acceleration = [0.0; 3];
    /// let kkt = Kkt::default();
    /// coupled.dynamics(&kkt)?.acceleration(&[0.1, 0.2, 0.1], &[0.0; 3], &[0.0; 3], &mut acceleration)?;
    /// assert!((acceleration[2] - acceleration[0]).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(description: &Description) -> Result<Self, BadMechanism> {
        Self::new(description, &[], |_| Vec::new())
    }

    /// What the graph's states accelerate by: the tree's own dynamics where nothing ties it, else those that `method` solves for.
    ///
    /// # Errors
    /// As [`Closed::new`].
    pub fn dynamics<'a>(&'a self, method: &'a dyn Method) -> Result<Box<dyn Dynamics + 'a>, Error> {
        if self.constraints.list().is_empty() {
            return Ok(Box::new(Tree::new(&self.model)));
        }
        Ok(Box::new(Closed::new(&self.model, &self.constraints, method)?))
    }

    /// The robot of a description with its own loops and with `loops`. Fixed joints are merged, as in the model. `others` are further
    /// constraints that are no joints between links, such as gears; they take the compiled model.
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
        let mut close = |name: &String, ends: [(Option<usize>, Transform<f64>); 2], motion: LoopMotion| {
            let [parent, child] = ends.map(|(body, _)| body);
            edges.push(Edge { name: name.clone(), parent, child, freedom: motion.freedom(), cut: true });
            let attach = |(body, placement): (Option<usize>, _)| Attachment { body: body.map(|body| model.described[body]), placement };
            let [first, second] = ends.map(attach);
            list.push(Constraint { name: name.clone(), law: Law::Joint { first, second, motion } });
        };
        for Loop { name, kind } in &canonical.loops {
            if let LoopKind::Joint { ends, motion } = kind {
                close(name, ends.map(|LoopEnd { body, placement }| (body, placement.to_transform())), *motion);
            }
        }
        for joint in loops {
            let first = find(joint, &joint.first, &joint.first_placement)?;
            let second = find(joint, &joint.second, &joint.second_placement)?;
            close(&joint.name, [first, second], joint.motion);
        }
        let graph = Graph::new(links, edges)?;
        list.extend(canonical.loops.iter().filter_map(|tie| Some(Constraint { name: tie.name.clone(), law: law(&tie.kind, &model)? })));
        list.extend(others(&model));
        let constraints = Constraints::new(&model.topology, list)?;
        Ok(Self { graph, model, constraints })
    }
}

/// The law of a loop of a canonical description that is no joint.
fn law(kind: &LoopKind, model: &Model<f64>) -> Option<Law> {
    let attach = |end: &LoopEnd| Attachment { body: end.body.map(|body| model.described[body]), placement: end.placement.to_transform() };
    let dof = |body: usize| model.topology.joints()[model.described[body]].v;
    match kind {
        LoopKind::Joint { .. } => None,
        LoopKind::Point { ends: [first, second], axes } => Some(Law::Point { first: attach(first), second: attach(second), axes: *axes }),
        LoopKind::Distance { ends: [first, second], length } => {
            Some(Law::Distance { first: attach(first), second: attach(second), length: *length })
        }
        LoopKind::Gear { terms, offset } => {
            Some(Law::Gear { terms: terms.iter().map(|&(body, coefficient)| (dof(body), coefficient)).collect(), offset: *offset })
        }
        LoopKind::Mimic { follower, leader, polynomial } => {
            Some(Law::Mimic { follower: dof(*follower), leader: dof(*leader), polynomial: *polynomial })
        }
    }
}
