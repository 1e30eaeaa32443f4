//! Planted errors: a relative error of 1e-10 in one number of one body fails the gates, each time.
//!
//! An engine named `double` answers with our own kernels, on a copy of the robot in which one number of one body is wrong. Its read-back is
//! the right robot: so only the answers of its algorithms can show the error. The whole agreement study runs with the gates of
//! `ci/gates.toml`, for every body of several robots and every kind of parameter.

use crate::share::one_of;

use featherbench_bench::measure::worst;
use featherbench_doubles::{Double, beside_native, doubles, gates, red, robot, suite};
use featherbench_model::{BodyDescription, JointType};
use featherbench_results::{Row, Verdict};
use rayon::prelude::*;

/// The planted error: four decades above the gates, and too small to see in a plot.
const PLANTED: f64 = 1e-10;
/// The axis about which placements are rotated: a unit vector along no axis of any robot.
const SKEW: [f64; 3] = [0.48, 0.6, 0.64];

/// The place of the error.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Plant {
    Mass,
    /// One component of the centre of mass.
    Center(usize),
    /// The whole rotational inertia.
    Inertia,
    /// The joint's axis, rotated.
    Axis,
    /// The screw's translation per angle.
    Pitch,
    /// The rotor inertia of the joint's dofs.
    Armature,
    /// The joint's placement on the parent, farther out.
    Translation,
    /// The joint's frame on the parent, rotated.
    Rotation,
}

impl Plant {
    const ALL: [Self; 10] = [
        Self::Mass,
        Self::Center(0),
        Self::Center(1),
        Self::Center(2),
        Self::Inertia,
        Self::Axis,
        Self::Pitch,
        Self::Armature,
        Self::Translation,
        Self::Rotation,
    ];

    /// Whether a body has no number of this kind that a relative error could change.
    fn absent(self, body: &BodyDescription) -> bool {
        match self {
            Self::Mass | Self::Inertia | Self::Rotation => false,
            Self::Center(k) => body.com[k] == 0.0,
            Self::Axis => body.joint.kind.axis().is_none(),
            Self::Pitch => !matches!(body.joint.kind, JointType::Helical { .. }),
            Self::Armature => body.joint.armature.iter().all(|&armature| armature == 0.0),
            Self::Translation => body.joint.placement.translation == [0.0; 3],
        }
    }

    fn sow(self, body: &mut BodyDescription) {
        let grow = |x: &mut f64| *x *= 1.0 + PLANTED;
        let placement = &mut body.joint.placement;
        match self {
            Self::Mass => grow(&mut body.mass),
            Self::Center(k) => grow(&mut body.com[k]),
            Self::Inertia => body.inertia.iter_mut().for_each(grow),
            Self::Axis => {
                if let JointType::Revolute { axis } | JointType::Prismatic { axis } | JointType::Helical { axis, .. } = &mut body.joint.kind
                {
                    *axis = turned(*axis, across(*axis));
                }
            }
            Self::Pitch => {
                if let JointType::Helical { pitch, .. } = &mut body.joint.kind {
                    grow(pitch);
                }
            }
            Self::Armature => body.joint.armature.iter_mut().for_each(grow),
            Self::Translation => placement.translation.iter_mut().for_each(grow),
            // R·(1 + θ[u]×): each row r of R becomes r − θ·u × r.
            Self::Rotation => {
                for row in placement.rotation.chunks_exact_mut(3) {
                    row.copy_from_slice(&turned([row[0], row[1], row[2]], SKEW.map(|x| -x)));
                }
            }
        }
    }
}

/// v + θ·u × v: v rotated by the planted angle about u, except for the square of the angle, 1e-20.
fn turned(v: [f64; 3], u: [f64; 3]) -> [f64; 3] {
    let w = cross(u, v);
    std::array::from_fn(|k| v[k] + PLANTED * w[k])
}

fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// Whether no answer depends on the error. It is so for the rotational inertia of a body without a rotating joint on its path. At any state
/// it is multiplied by angular velocities and accelerations that are exactly zero.
fn unfelt(bodies: &[BodyDescription], body: usize, plant: Plant) -> bool {
    let mut path = std::iter::successors(Some(body), |&body| bodies[body].parent);
    plant == Plant::Inertia && path.all(|body| matches!(bodies[body].joint.kind, JointType::Prismatic { .. }))
}

/// A unit vector perpendicular to this one.
fn across(v: [f64; 3]) -> [f64; 3] {
    let w = cross(SKEW, v);
    let length = w.iter().map(|x| x * x).sum::<f64>().sqrt();
    w.map(|x| x / length)
}

/// Plants every kind of error. Asserts that each one fails, and that the right engine passes.
#[track_caller]
fn convicts(spec: &str) {
    let robot = robot(spec);
    assert!(robot.depth <= 20, "deeper robots are measured, not gated");
    let gates = gates("");
    let honest = beside_native(&robot, &gates, Double::of(&robot));
    let suite = suite(&honest);
    let is_red = |records: &[Row]| !red(&suite.conditions(&gates, records, true)).is_empty();
    for row in honest.iter().filter(|row| row.relation.is_some() || row.verdict != Verdict::Info) {
        assert_eq!(row.verdict, Verdict::Pass, "{} of {}: {}", row.quantity, row.engine, row.reason);
    }
    assert!(!is_red(&honest));

    let bodies = &robot.description.bodies;
    let mut plants: Vec<(usize, Plant)> = (0..bodies.len())
        .flat_map(|body| Plant::ALL.map(|plant| (body, plant)))
        .filter(|&(body, plant)| !plant.absent(&bodies[body]))
        .collect();
    // By day every third of them, and the first of each kind.
    let (mut place, mut seen) = (0, Vec::new());
    plants.retain(|&(_, plant)| {
        let first = !seen.contains(&plant);
        seen.push(plant);
        place += 1;
        first || (place - 1) % one_of(3) == 0
    });
    let margins: Vec<Result<f64, String>> = plants
        .par_iter()
        .map(|&(body, plant)| {
            let records = beside_native(&robot, &gates, Double::altered(&robot, |description| plant.sow(&mut description.bodies[body])));
            if unfelt(bodies, body, plant) {
                return if records == honest { Ok(f64::NEG_INFINITY) } else { Err(format!("{plant:?} of {} is felt", bodies[body].name)) };
            }
            let failed = doubles(&records, Verdict::Fail);
            let convicted = !failed.is_empty() && is_red(&records);
            let margin = -failed.iter().filter_map(|row| row.margin).map(|margin| -margin).fold(f64::NEG_INFINITY, worst);
            if convicted { Ok(margin) } else { Err(format!("{plant:?} of {} escapes", bodies[body].name)) }
        })
        .collect();
    let wrong: Vec<&String> = margins.iter().filter_map(|margin| margin.as_ref().err()).collect();
    assert!(wrong.is_empty(), "{} of {}: {wrong:#?}", wrong.len(), plants.len());
    let closest = plants.iter().zip(&margins).max_by(|a, b| a.1.as_ref().unwrap().total_cmp(b.1.as_ref().unwrap()));
    if let Some(((body, plant), Ok(margin))) = closest {
        println!(
            "{spec}: {} plants; {plant:?} of {} comes closest, {:.1} decades beyond its gate",
            plants.len(),
            bodies[*body].name,
            -margin
        );
    }
}

#[test]
fn every_plant_in_every_kind_of_joint_on_a_fixed_base() {
    convicts("joints:kind=mixed,base=fixed");
}

#[test]
fn every_plant_in_every_kind_of_joint_on_a_free_base() {
    convicts("joints:kind=mixed,base=free");
}

#[test]
fn every_plant_in_a_random_tree() {
    convicts("tree:n=20,joints=all,base=fixed,armature=true");
}

#[test]
fn every_plant_in_a_random_free_tree() {
    convicts("tree:n=16,joints=all,base=free,seed=5");
}

#[test]
fn every_plant_in_the_humanoid() {
    convicts("humanoid");
}

#[test]
fn every_plant_in_the_quadruped() {
    convicts("quadruped");
}

#[test]
fn every_plant_in_a_chain() {
    convicts("chain:n=10,layout=spatial");
}

#[test]
fn every_plant_in_the_hand() {
    convicts("hand");
}

#[test]
fn every_plant_in_a_chain_of_twenty() {
    convicts("chain:n=20");
}

#[test]
fn every_plant_in_a_chain_with_a_heavy_tip() {
    convicts("chain:n=8,layout=spatial,tip_scale=1000,base=free");
}

#[test]
fn every_plant_in_a_binary_tree() {
    convicts("binary_tree:depth=4");
}
