//! The small robots of the conformance test: every kind of joint alone, in branched trees, on a fixed and on a free base.

use featherbench_bench::Robot;
use featherbench_model::{Description, JointType};
use featherbench_results::ModelOrigin;
use featherbench_robots::Family;

/// What it tests, the generator's text, and how many of its bodies are kept.
const ROBOTS: [(&str, &str, usize); 27] = [
    ("a revolute joint", "joints:kind=revolute,base=fixed,shape=single", 1),
    ("a chain of revolute joints", "joints:kind=revolute,base=fixed,shape=branched", 4),
    ("a tree of revolute joints", "joints:kind=revolute,base=fixed,shape=branched", usize::MAX),
    ("a tree of revolute joints without armature", "joints:kind=revolute,base=fixed,shape=branched,armature=false", usize::MAX),
    ("a prismatic joint", "joints:kind=prismatic,base=fixed,shape=single", 1),
    ("a tree with prismatic joints", "joints:kind=prismatic,base=fixed,shape=branched", usize::MAX),
    ("a helical joint", "joints:kind=helical,base=fixed,shape=single", 1),
    ("a tree with helical joints", "joints:kind=helical,base=fixed,shape=branched", usize::MAX),
    ("a spherical joint", "joints:kind=spherical,base=fixed,shape=single", 1),
    ("a tree with spherical joints", "joints:kind=spherical,base=fixed,shape=branched", usize::MAX),
    ("a planar joint", "joints:kind=planar,base=fixed,shape=single", 1),
    ("a tree with planar joints", "joints:kind=planar,base=fixed,shape=branched", usize::MAX),
    ("a universal joint", "joints:kind=universal,base=fixed,shape=single", 1),
    ("a tree with universal joints", "joints:kind=universal,base=fixed,shape=branched", usize::MAX),
    ("a translation joint", "joints:kind=translation,base=fixed,shape=single", 1),
    ("a floating tree with translation joints", "joints:kind=translation,base=free,shape=branched", usize::MAX),
    ("a cylindrical joint", "joints:kind=cylindrical,base=fixed,shape=single", 1),
    ("a floating tree with cylindrical joints", "joints:kind=cylindrical,base=free,shape=branched", usize::MAX),
    ("a joint of Euler angles", "joints:kind=euler_zyx,base=fixed,shape=single", 1),
    ("a floating tree with joints of Euler angles", "joints:kind=euler_zyx,base=free,shape=branched", usize::MAX),
    ("a free body", "joints:kind=revolute,base=free,shape=single", 1),
    ("a revolute joint on a free body", "joints:kind=revolute,base=free,shape=single", usize::MAX),
    ("a floating tree of revolute joints", "joints:kind=revolute,base=free,shape=branched", usize::MAX),
    ("a floating tree of revolute joints without armature", "joints:kind=revolute,base=free,shape=branched,armature=false", usize::MAX),
    ("a floating tree with spherical joints", "joints:kind=spherical,base=free,shape=branched", usize::MAX),
    ("a floating tree with every joint from revolute to universal but helical", "joints:kind=common,base=free,shape=branched", usize::MAX),
    ("a floating tree with every joint from revolute to universal", "joints:kind=mixed,base=free,shape=branched", usize::MAX),
];

/// States at which each robot is asked: one of each case. The fast one is twice as far from the first as from the last.
pub(super) const STATES: usize = 6;
/// Seed of the states.
pub(super) const SEED: u64 = 11;

/// The robots, with what each tests. One-dof joints have armature, and all but free joints have damping and dry friction. So a mistake
/// about these is visible. Two robots have no armature, for engines that have none.
pub(super) fn all() -> Result<Vec<(&'static str, Robot)>, String> {
    let robot = |(shows, spec, keep): (&'static str, &str, usize)| {
        let mut description = Family::parse(spec).and_then(|family| family.generate()).map_err(|error| error.to_string())?;
        description.bodies.truncate(keep);
        equip(&mut description, !spec.ends_with("armature=false"));
        let robot = Robot::new(&description, "conformance", ModelOrigin::Generated, STATES, SEED).map_err(|error| error.to_string())?;
        Ok((shows, robot))
    };
    ROBOTS.into_iter().map(robot).collect()
}

fn equip(description: &mut Description, armature: bool) {
    for (i, joint) in description.bodies.iter_mut().map(|body| &mut body.joint).enumerate() {
        let (one, nv) = (joint.kind.nv() == 1, joint.kind.nv());
        if one && armature {
            joint.armature = vec![0.05 + 0.01 * i as f64];
        }
        if joint.kind != JointType::Free {
            joint.damping = vec![0.3; nv];
            joint.friction = vec![0.2; nv];
        }
    }
}
