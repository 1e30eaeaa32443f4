//! From links and joints to a description.

use super::elements::{Joint, Link, Mimicry, Robot};
use super::error::{At, NoteAt, UrdfProblem};
use super::{Base, Options};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Loop, LoopKind, Malformed, Placement, Warning};
use featherbench_spatial::{Mat3, Transform, Vec3};
use std::collections::HashMap;

/// The joint of a floating base.
pub(super) const ROOT_JOINT: &str = "root_joint";
/// Gravity, which URDF does not give, m/s².
pub(super) const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// The canonical description of a robot.
pub(super) fn assemble(robot: &Robot, options: &Options, notes: &mut Vec<NoteAt>) -> Result<Description, At> {
    let connected = Connected::new(robot)?;
    let base = match connected.floating_base(robot) {
        Some(joint) if options.base == Base::Floating => {
            let (root, name) = (&robot.links[connected.root].name, &joint.described.name);
            let text =
                format!("link '{root}' has no inertia and carries the robot on the floating joint '{name}': that joint is the base's");
            notes.push(NoteAt::new(joint.offset, text));
            Base::Fixed
        }
        _ => options.base,
    };
    let description = describe(robot, &connected, base);
    let canonical = description.canonical().map_err(|malformed| locate(robot, malformed))?;
    // Rotations come from angles: their doubles deviate by no more than rounding.
    for warning in description.normalised() {
        let Warning::Normalised { joint, field: "axis", .. } = &warning else { continue };
        let offset = robot.joints.iter().find(|known| known.described.name == *joint).map_or(0, |known| known.offset);
        notes.push(NoteAt { offset, text: warning.to_string(), warning: Some(warning) });
    }
    check_masses(robot, &canonical, options, notes)?;
    Ok(canonical)
}

/// The child and parent link of each joint: indices instead of names.
struct Connected {
    root: usize,
    /// (parent link, child link) of each joint.
    ends: Vec<(usize, usize)>,
}

impl Connected {
    fn new(robot: &Robot) -> Result<Self, At> {
        let index: HashMap<&str, usize> = robot.links.iter().enumerate().map(|(k, link)| (link.name.as_str(), k)).collect();
        let mut carrier: Vec<Option<usize>> = vec![None; robot.links.len()];
        let mut ends = Vec::with_capacity(robot.joints.len());
        for (k, joint) in robot.joints.iter().enumerate() {
            let find = |link: &str, role| {
                let unknown = UrdfProblem::UnknownLink { joint: joint.described.name.clone(), link: link.to_owned(), role };
                index.get(link).copied().ok_or_else(|| unknown.at(joint.offset))
            };
            let (parent, child) = (find(&joint.parent, "parent")?, find(&joint.child, "child")?);
            if let Some(first) = carrier[child].replace(k) {
                let (first, second) = (robot.joints[first].described.name.clone(), joint.described.name.clone());
                return Err(UrdfProblem::TwoParents { link: joint.child.clone(), first, second }.at(joint.offset));
            }
            ends.push((parent, child));
        }

        // Each link has at most one joint to a parent. A link that cannot be reached from a root belongs to a cycle or its branches.
        let mut grounded = vec![false; robot.links.len()];
        for start in 0..robot.links.len() {
            let (mut path, mut at) = (Vec::new(), start);
            while !grounded[at] {
                let Some(joint) = carrier[at] else {
                    grounded[at] = true;
                    break;
                };
                if path.len() > robot.links.len() {
                    let problem =
                        UrdfProblem::Cycle { link: robot.links[at].name.clone(), joint: robot.joints[joint].described.name.clone() };
                    return Err(problem.at(robot.joints[joint].offset));
                }
                path.push(at);
                at = ends[joint].0;
            }
            path.into_iter().for_each(|link| grounded[link] = true);
        }
        let mut roots = (0..robot.links.len()).filter(|&link| carrier[link].is_none());
        match (roots.next(), roots.next()) {
            (Some(root), None) => Ok(Self { root, ends }),
            (Some(first), Some(second)) => {
                let alone = ends.iter().all(|&(parent, _)| parent != second);
                let name = |link: usize| robot.links[link].name.clone();
                Err(UrdfProblem::TwoRoots { first: name(first), second: name(second), alone }.at(robot.links[second].offset))
            }
            // Without a root every link has a parent, and the loop above has found the cycle; or there are no links.
            (None, _) => Err(UrdfProblem::NoLinks.at(0)),
        }
    }
}

impl Connected {
    /// The joint of an existing floating base: the only joint of a root without inertia, such as a link `world`.
    fn floating_base<'a>(&self, robot: &'a Robot) -> Option<&'a Joint> {
        let mut carried = robot.joints.iter().zip(&self.ends).filter(|(_, (parent, _))| *parent == self.root);
        let (joint, _) = carried.next()?;
        let alone = carried.next().is_none() && !robot.links[self.root].has_inertial;
        (alone && joint.described.kind == JointType::Free).then_some(joint)
    }
}

/// The bodies: the root, then the children in the order of the joints.
fn describe(robot: &Robot, connected: &Connected, base: Base) -> Description {
    let mut bodies = Vec::with_capacity(robot.links.len());
    let mut place = vec![0; robot.links.len()];
    // Parents may come after their children in the file: each link gets its index first. A planar joint takes two indices.
    let mut next = 1;
    for (joint, &(_, child)) in robot.joints.iter().zip(&connected.ends) {
        next += usize::from(plane(joint).is_some());
        place[child] = next;
        next += 1;
    }
    let root = match base {
        Base::Fixed => JointType::Fixed,
        Base::Floating => JointType::Free,
    };
    let root_joint = JointDescription { name: ROOT_JOINT.to_owned(), kind: root, ..JointDescription::default() };
    bodies.push(body(&robot.links[connected.root], None, root_joint));
    for (joint, &(parent, child)) in robot.joints.iter().zip(&connected.ends) {
        let (parent, link) = (Some(place[parent]), &robot.links[child]);
        let described = joint.described.clone();
        match plane(joint) {
            None => bodies.push(body(link, parent, described)),
            Some(turn) => {
                // The plane's frame moves, and the link is fixed to it with its own axes.
                let on_plane = described.placement.to_transform().compose(&Transform::new(turn, Vec3::zero()));
                let described = JointDescription { placement: Placement::from_transform(&on_plane), ..described };
                let name = format!("{}_plane", link.name);
                bodies.push(BodyDescription { name: name.clone(), parent, mass: 0.0, com: [0.0; 3], inertia: [0.0; 6], joint: described });
                let back = Placement { rotation: turn.transpose().to_array(), ..Placement::default() };
                let fixed = JointDescription { name: format!("{name}_joint"), placement: back, ..JointDescription::default() };
                bodies.push(body(link, Some(bodies.len() - 1), fixed));
            }
        }
    }
    let loops = mimics(robot, connected, &place);
    Description { name: robot.name.clone(), gravity: GRAVITY, bodies, loops, ..Description::default() }
}

/// The loops of joints that follow others. A loop has the name of the joint that follows.
fn mimics(robot: &Robot, connected: &Connected, place: &[usize]) -> Vec<Loop> {
    let body_of: HashMap<&str, usize> =
        robot.joints.iter().zip(&connected.ends).map(|(joint, &(_, child))| (joint.described.name.as_str(), place[child])).collect();
    let tie = |joint: &Joint| {
        let Mimicry { of, line: Some([offset, multiplier]), .. } = joint.mimics.as_ref()? else { return None };
        let (follower, leader) = (*body_of.get(joint.described.name.as_str())?, *body_of.get(of.as_str())?);
        let polynomial = [*offset, *multiplier, 0.0, 0.0, 0.0];
        Some(Loop { name: joint.described.name.clone(), kind: LoopKind::Mimic { follower, leader, polynomial } })
    };
    robot.joints.iter().filter_map(tie).collect()
}

fn body(link: &Link, parent: Option<usize>, joint: JointDescription) -> BodyDescription {
    BodyDescription { name: link.name.clone(), parent, mass: link.mass, com: link.com, inertia: link.inertia, joint }
}

/// For a planar joint whose axis is not z: the rotation that takes z to the axis.
fn plane(joint: &Joint) -> Option<Mat3<f64>> {
    let axis = joint.normal.filter(|&axis| axis != [0.0, 0.0, 1.0])?;
    let z = Vec3::from_array(axis);
    let z = z * (1.0 / z.norm());
    // x: the coordinate axis farthest from z, orthogonalised.
    let [a, b, c] = axis.map(f64::abs);
    let helper = if a <= b && a <= c {
        [1.0, 0.0, 0.0]
    } else if b <= c {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    };
    let y = z.cross(Vec3::from_array(helper));
    let y = y * (1.0 / y.norm());
    Some(Mat3::from_rows(y.cross(z), y, z).transpose())
}

/// A malformed description, with the position of its link.
fn locate(robot: &Robot, malformed: Malformed) -> At {
    let link = malformed.about().and_then(|name| robot.links.iter().find(|link| link.name == name));
    // Numbers of joints are named by the body that the joint carries.
    let joint = link.and_then(|link| robot.joints.iter().find(|joint| joint.child == link.name));
    At { offset: joint.map(|joint| joint.offset).or(link.map(|link| link.offset)), problem: malformed.into() }
}

/// An error if a moving body has no mass; a note if that is allowed.
fn check_masses(robot: &Robot, canonical: &Description, options: &Options, notes: &mut Vec<NoteAt>) -> Result<(), At> {
    for body in canonical.bodies.iter().filter(|body| body.mass == 0.0) {
        let link = robot.links.iter().find(|link| link.name == body.name);
        let (offset, has_inertial) = link.map_or((0, true), |link| (link.offset, link.has_inertial));
        if !options.allow_massless {
            let (link, joint) = (body.name.clone(), body.joint.name.clone());
            return Err(UrdfProblem::Massless { link, joint, has_inertial }.at(offset));
        }
        notes.push(NoteAt::new(offset, format!("link '{}' moves and has no mass", body.name)));
    }
    Ok(())
}
