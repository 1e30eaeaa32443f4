//! The pairs of bodies of two import results.

use super::fields::Precision;
use featherbench_model::{BodyDescription, Description, JointType, Placement, Uncertain};

/// For each body of `ours`, its partner in `theirs`: by its name, else by its joint's name, else by its place in the tree.
pub(super) fn pairs(ours: &Description, theirs: &Description, precision: Precision) -> Vec<Option<usize>> {
    let mut pairing = Pairing { precision, partner: vec![None; ours.bodies.len()], taken: vec![false; theirs.bodies.len()] };
    let by = |same: &dyn Fn(&BodyDescription, &BodyDescription) -> bool, pairing: &mut Pairing| {
        for (i, body) in ours.bodies.iter().enumerate().filter(|(i, _)| pairing.partner[*i].is_none()).collect::<Vec<_>>() {
            if let Some(j) = (0..theirs.bodies.len()).find(|&j| !pairing.taken[j] && same(body, &theirs.bodies[j])) {
                pairing.join(i, j);
            }
        }
    };
    by(&|a, b| a.name == b.name, &mut pairing);
    by(&|a, b| !a.joint.name.is_empty() && a.joint.name == b.joint.name, &mut pairing);
    pairing.upwards(ours, theirs);
    pairing.downwards(ours, theirs);
    pairing.partner
}

struct Pairing {
    precision: Precision,
    partner: Vec<Option<usize>>,
    taken: Vec<bool>,
}

impl Pairing {
    fn join(&mut self, i: usize, j: usize) {
        self.partner[i] = Some(j);
        self.taken[j] = true;
    }

    /// Parents of partners are partners: the massless bodies of a chain have no names of their own.
    fn upwards(&mut self, ours: &Description, theirs: &Description) {
        for i in (0..ours.bodies.len()).rev() {
            let Some(j) = self.partner[i] else { continue };
            if let (Some(above), Some(theirs_above)) = (ours.bodies[i].parent, theirs.bodies[j].parent)
                && self.partner[above].is_none()
                && !self.taken[theirs_above]
                && ours.bodies[above].joint.kind.name() == theirs.bodies[theirs_above].joint.kind.name()
            {
                self.join(above, theirs_above);
            }
        }
    }

    /// The remaining children of partners are partners in their order, if their number is the same and they have the same joints.
    fn downwards(&mut self, ours: &Description, theirs: &Description) {
        for above in std::iter::once(None).chain((0..ours.bodies.len()).map(Some)) {
            let theirs_above = match above {
                None => None,
                Some(i) => match self.partner[i] {
                    Some(j) => Some(j),
                    None => continue,
                },
            };
            // A body without a name in the file has one that each program invents: the same mass on the same joint is the same body.
            for i in (0..ours.bodies.len()).filter(|&i| ours.bodies[i].parent == above && invented(&ours.bodies[i])).collect::<Vec<_>>() {
                let same = |&j: &usize| {
                    theirs.bodies[j].parent == theirs_above && !self.taken[j] && alike(&ours.bodies[i], &theirs.bodies[j], self.precision)
                };
                if self.partner[i].is_none()
                    && let Some(j) = (0..theirs.bodies.len()).find(same)
                {
                    self.join(i, j);
                }
            }
            let left: Vec<usize> =
                (0..ours.bodies.len()).filter(|&i| ours.bodies[i].parent == above && self.partner[i].is_none()).collect();
            let right: Vec<usize> =
                (0..theirs.bodies.len()).filter(|&j| theirs.bodies[j].parent == theirs_above && !self.taken[j]).collect();
            let kind = |body: &BodyDescription| body.joint.kind.name();
            let level =
                left.len() == right.len() && left.iter().zip(&right).all(|(&i, &j)| kind(&ours.bodies[i]) == kind(&theirs.bodies[j]));
            if level {
                left.into_iter().zip(right).for_each(|(i, j)| self.join(i, j));
            }
        }
    }
}

/// Whether the reference invented the name of a body: the file has none.
fn invented(body: &BodyDescription) -> bool {
    body.name.strip_prefix("body ").is_some_and(|number| number.parse::<usize>().is_ok())
}

/// Whether two bodies have the same kind of joint and, to rounding, the same mass.
fn alike(a: &BodyDescription, b: &BodyDescription, precision: Precision) -> bool {
    let same_mass = a.mass > 0.0 && (a.mass - b.mass).abs() <= precision.rounding() * a.mass;
    a.joint.kind.name() == b.joint.kind.name() && same_mass
}

/// The robot with planar and universal joints written as chains of one-dof joints, with massless bodies between: some engines have them so.
/// Coordinates and their order stay the same. Loops are left out: trees are compared.
pub(super) fn chained(description: &Description) -> Description {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let (slide, turn) = (|axis| JointType::Prismatic { axis }, |axis| JointType::Revolute { axis });
    let bodies = Vec::with_capacity(description.bodies.len());
    let mut result = Description {
        bodies,
        frames: Vec::new(),
        loops: Vec::new(),
        residuals: Vec::new(),
        uncertain: Uncertain::default(),
        ..description.clone()
    };
    let mut place = Vec::with_capacity(description.bodies.len());
    for body in &description.bodies {
        let mut parent = body.parent.map(|parent: usize| place[parent]);
        let kinds = match body.joint.kind {
            JointType::Planar => vec![slide(x), slide(y), turn(z)],
            JointType::Universal => vec![turn(x), turn(y)],
            other => vec![other],
        };
        let alone = kinds.len() == 1;
        for (k, &kind) in kinds.iter().enumerate() {
            let last = k + 1 == kinds.len();
            let mut link =
                if last { body.clone() } else { BodyDescription { mass: 0.0, com: [0.0; 3], inertia: [0.0; 6], ..body.clone() } };
            link.parent = parent;
            link.joint.kind = kind;
            if !last {
                link.name = format!("{}/{k}", body.name);
            }
            if k > 0 {
                link.joint.placement = Placement::default();
            }
            if !alone {
                let joint = &mut link.joint;
                let lists = [&mut joint.armature, &mut joint.damping, &mut joint.friction, &mut joint.lower, &mut joint.upper];
                for list in lists.into_iter().chain([&mut joint.velocity, &mut joint.effort]) {
                    *list = list.get(k).copied().into_iter().collect();
                }
            }
            parent = Some(result.bodies.len());
            result.bodies.push(link);
        }
        place.push(result.bodies.len() - 1);
    }
    let frame = |frame: &featherbench_model::Frame| featherbench_model::Frame { body: frame.body.map(|body| place[body]), ..frame.clone() };
    result.frames = description.frames.iter().map(frame).collect();
    result
}
