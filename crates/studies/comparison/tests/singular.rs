//! Robots with a motion that has no kinetic energy are told with the joints that make it; others are not.

use featherbench_bench::Robot;
use featherbench_comparison::import::singular;
use featherbench_model::{BodyDescription, Description, JointType};
use featherbench_results::ModelOrigin;
use featherbench_robots::{Family, Random};
use featherbench_spatial::Vec3;

const FAMILIES: [&str; 6] = ["chain:n=1", "chain:n=4", "chain:n=9,base=free", "binary_tree:depth=3", "humanoid", "chain:n=30"];
const DRAWN: u64 = 240;

fn told(description: &Description) -> Option<String> {
    let robot = Robot::new(&description.canonical().unwrap(), "drawn", ModelOrigin::Generated, 3, 1).unwrap();
    singular(&robot)
}

/// The robot with a hinge more at a body: it turns first, about an axis that is `tilt` rad away from that of the body's own hinge.
fn doubled(robot: &Description, i: usize, tilt: f64) -> Description {
    let mut bodies = robot.bodies.clone();
    let JointType::Revolute { axis } = bodies[i].joint.kind else { panic!("no hinge") };
    let across = Vec3::from_array(axis).cross(Vec3::from_array(if axis[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }));
    let tilted = (Vec3::from_array(axis) * tilt.cos() + across * (tilt.sin() / across.norm())).to_array();
    let mut extra = BodyDescription { mass: 0.0, com: [0.0; 3], inertia: [0.0; 6], ..bodies[i].clone() };
    extra.name = "extra".into();
    extra.joint.name = "extra_joint".into();
    extra.joint.kind = JointType::Revolute { axis: tilted };
    extra.joint.armature = vec![0.0];
    bodies[i].joint.placement = featherbench_model::Placement::default();
    bodies[i].joint.armature = vec![0.0];
    bodies[i].parent = Some(i);
    bodies.insert(i, extra);
    for body in &mut bodies[i + 1..] {
        body.parent = body.parent.map(|parent| if parent >= i && body.name != robot.bodies[i].name { parent + 1 } else { parent });
    }
    Description { bodies, frames: Vec::new(), ..robot.clone() }
}

#[test]
fn two_hinges_on_one_axis_are_told_by_name_and_two_on_two_axes_are_not() {
    let mut hinges = 0;
    for k in 0..DRAWN {
        let mut random = Random::new(44, k);
        let robot = Family::parse(FAMILIES[k as usize % FAMILIES.len()]).unwrap().generate().unwrap();
        assert_eq!(told(&robot), None, "{}", robot.name);
        let turning: Vec<usize> =
            (0..robot.bodies.len()).filter(|&i| matches!(robot.bodies[i].joint.kind, JointType::Revolute { .. })).collect();
        let i = turning[random.below(turning.len())];
        let text = told(&doubled(&robot, i, 0.0)).unwrap_or_else(|| panic!("{k}: {} is not told", robot.name));
        let own = &robot.bodies[i].joint.name;
        let own = if own.is_empty() { &robot.bodies[i].name } else { own };
        let names = text.split("of the joints ").nth(1).unwrap().split(" has no").next().unwrap();
        let mut names: Vec<&str> = names.split(", ").collect();
        names.sort_unstable();
        let mut due = [own.as_str(), "extra_joint"];
        due.sort_unstable();
        assert_eq!(names, due, "{k}: {text}");
        // The pivot of two axes is the square of their angle, times what the body's inertia about both axes allows.
        let tilt = 10_f64.powf(random.uniform(-3.0, -0.5));
        assert_eq!(told(&doubled(&robot, i, tilt)), None, "{k}: {} tilted by {tilt}", robot.name);
        hinges += 1;
    }
    assert_eq!(hinges, DRAWN);
}
