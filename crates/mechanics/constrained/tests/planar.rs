//! Grübler's count in a plane is the mobility of planar robots whose rows are independent, whatever joints close their loops.

use featherbench_constrained::{Mechanism, Mobility, gruebler_in_plane};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Loop, LoopEnd, LoopKind, LoopMotion, Placement};
use featherbench_robots::Random;
use featherbench_spatial::{Mat3, Transform, Vec3};

const DRAWN: u64 = 240;

/// A rotation about a drawn direction.
fn rotation(random: &mut Random) -> Mat3<f64> {
    let angle: f64 = random.uniform(-3.0, 3.0);
    Transform::axis_rotation(Vec3::from_array(random.direction()), angle.sin(), angle.cos())
}

/// A frame at a pose of the robot, given in a body's frame.
fn on(place: &Transform<f64>, frame: &Transform<f64>, body: Option<usize>) -> LoopEnd {
    LoopEnd { body, placement: Placement::from_transform(&place.inverse().compose(frame)) }
}

/// One to three chains of three to five joints in a plane that is turned anywhere, each closed to the world by a drawn joint.
fn drawn(random: &mut Random) -> Description {
    let plane = Transform::new(rotation(random), Vec3::from_array(random.direction()));
    let mut robot = Description { name: "planar".into(), ..Description::default() };
    for chain in 0..1 + random.below(3) {
        let mut place = plane;
        let length = 3 + random.below(3);
        // Two parallel slides, or three, would be a special position; one slide of a chain is not.
        let slides = random.below(length + 1);
        for k in 0..length {
            let along: f64 = random.uniform(-3.0, 3.0);
            let turn = Transform::axis_rotation(Vec3::new(0.0, 0.0, 1.0), along.sin(), along.cos());
            let step = Transform::new(turn, Vec3::new(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-0.3, 0.3)));
            let parent = (k > 0).then(|| robot.bodies.len() - 1);
            let here = place.compose(&step);
            let placement = if parent.is_none() { here } else { step };
            let kind = match k == slides {
                true => JointType::Prismatic { axis: [1.0, 0.0, 0.0] },
                false => JointType::Revolute { axis: [0.0, 0.0, 1.0] },
            };
            place = here;
            robot.bodies.push(BodyDescription {
                name: format!("b{chain}{k}"),
                parent,
                mass: 1.0,
                inertia: [1.0, 0.0, 0.0, 1.0, 0.0, 1.0],
                joint: JointDescription {
                    name: format!("j{chain}{k}"),
                    kind,
                    placement: Placement::from_transform(&placement),
                    ..JointDescription::default()
                },
                com: [0.0; 3],
            });
        }
        let motion = [LoopMotion::Spherical, LoopMotion::Revolute, LoopMotion::Fixed, LoopMotion::Spherical][random.below(4)];
        let last = robot.bodies.len() - 1;
        let point = Vec3::new(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 0.0);
        let frame = place.compose(&Transform::new(Mat3::identity(), point));
        let ends = [on(&place, &frame, Some(last)), on(&Transform::identity(), &frame, None)];
        robot.loops.push(Loop { name: format!("loop{chain}"), kind: LoopKind::Joint { ends, motion } });
    }
    robot
}

#[test]
fn the_count_in_a_plane_is_the_mobility() {
    for k in 0..DRAWN {
        let random = &mut Random::new(44, k);
        let robot = drawn(random);
        let Mechanism { model, constraints, .. } = Mechanism::of(&robot).unwrap();
        let mobility = Mobility::at(&model, &constraints, &vec![0.0; model.topology.nq()]).unwrap();
        assert_eq!(gruebler_in_plane(&robot), Some(mobility.freedom() as i64), "{k}: {:?}", robot.loops);
        // Out of the plane there is no such count.
        let mut bent = robot.clone();
        bent.bodies[0].joint.kind = JointType::Revolute { axis: [0.6, 0.0, 0.8] };
        assert_eq!(gruebler_in_plane(&bent), None, "{k}");
    }
}
