//! Stacks of boxes and standing robots: their known answers by a second route, and contacts of boxes on boxes.

use featherbench_dynamics::{Jacobian, Kinematics, bias_force};
use featherbench_robots::Family;
use featherbench_scenes::systems::{BoxStack, Standing};
use featherbench_scenes::{Body, Geometry, OwnSolver, Scene, Shape, simulate, touches};
use featherbench_spatial::Vec3;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

fn standing() -> [Standing; 2] {
    [Standing::quadruped(), Standing::humanoid()]
}

/// Mass, centre and inertia by the sum over the described bodies, with the parallel-axis theorem: another route than M(q).
#[test]
fn a_locked_robot_is_the_sum_of_its_bodies() {
    for robot in standing() {
        let locked = robot.locked().unwrap();
        let description = Family::parse(robot.robot).unwrap().generate().unwrap();
        let still = vec![0.0; locked.model.topology.nv()];
        let mut kinematics = Kinematics::new(&locked.model.topology);
        kinematics.run(&locked.model, &locked.q, &still, &still).unwrap();
        let bodies: Vec<(f64, Vector3<f64>, Matrix3<f64>)> = description
            .bodies
            .iter()
            .enumerate()
            .map(|(k, body)| {
                let place = kinematics.body(locked.model.described[k]).unwrap().placement;
                let world = |v: [f64; 3]| Vector3::from((place.rotation * Vec3::from_array(v)).to_array());
                let axes = Matrix3::from_columns(&[world([1.0, 0.0, 0.0]), world([0.0, 1.0, 0.0]), world([0.0, 0.0, 1.0])]);
                let [xx, xy, xz, yy, yz, zz] = body.inertia;
                let inertia = axes * Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) * axes.transpose();
                (body.mass, world(body.com) + Vector3::from(place.translation.to_array()), inertia)
            })
            .collect();
        let mass: f64 = bodies.iter().map(|body| body.0).sum();
        let centre = bodies.iter().map(|body| body.0 * body.1).sum::<Vector3<f64>>() / mass;
        let about = |(mass, at, inertia): &(f64, Vector3<f64>, Matrix3<f64>)| {
            let arm = at - centre;
            inertia + *mass * (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose())
        };
        let inertia: Matrix3<f64> = bodies.iter().map(about).sum();
        // Some tens of roundings of numbers up to 60 kg and 15 kg m².
        assert!((locked.mass - mass).abs() < 1e-12 && (locked.centre - centre).norm() < 1e-13, "{}", robot.name);
        assert!((locked.inertia - inertia).norm() < 1e-12, "{}: {} {}", robot.name, locked.inertia, inertia);
        // It stands: no foot is below the ground, three at least are on it, and the centre is between them.
        let heights: Vec<f64> = locked.feet.iter().zip(&robot.feet).map(|(at, foot)| at.z - foot.radius).collect();
        assert!(heights.iter().all(|height| height.abs() < 1e-12), "{}: {heights:?}", robot.name);
        let range = |axis: usize| {
            let along: Vec<f64> = locked.feet.iter().map(|foot| foot[axis]).collect();
            (
                along.iter().copied().fold(f64::INFINITY, featherbench_spatial::smaller),
                along.iter().copied().fold(f64::NEG_INFINITY, featherbench_spatial::larger),
            )
        };
        for axis in [0, 1] {
            let (low, high) = range(axis);
            assert!(low + 0.02 < centre[axis] && centre[axis] < high - 0.02, "{} {axis}: {low} {} {high}", robot.name, centre[axis]);
        }
    }
}

/// Statics of the whole mechanism by inverse dynamics: with the contacts' forces and the push, the free joint carries nothing, and the joints
/// hold with τ = C(q, 0) − Σ Jᵀ f, within their effort limits.
#[test]
fn inverse_dynamics_leaves_the_free_joint_without_force() {
    for robot in standing() {
        let locked = robot.locked().unwrap();
        let question = robot.question();
        let motion = simulate(&question.scene, 1e-3, 20, 20, &mut OwnSolver::newton()).unwrap();
        assert!(motion.pushes.len() >= 3, "{}", robot.name);
        let topology = &locked.model.topology;
        let still = vec![0.0; topology.nv()];
        let mut tau = bias_force(&locked.model, &locked.q, &still).unwrap();
        let mut kinematics = Kinematics::new(topology);
        kinematics.run(&locked.model, &locked.q, &still, &still).unwrap();
        let description = Family::parse(robot.robot).unwrap().generate().unwrap();
        let mut jacobian = Jacobian::new(topology);
        let mut hold = |body: usize, at: Vector3<f64>, force: Vector3<f64>| {
            let origin = Vector3::from(kinematics.body(body).unwrap().placement.translation.to_array());
            let (arm, force) = (at - origin, Vec3::from_array(force.into()));
            for (dof, column) in jacobian.run(&locked.model, &locked.q, body).unwrap().iter().enumerate() {
                let moved = column.lin + column.ang.cross(Vec3::from_array(arm.into()));
                tau[dof] -= moved.x * force.x + moved.y * force.y + moved.z * force.z;
            }
        };
        for push in &motion.pushes {
            // The foot whose centre is above the contact.
            let far = |foot: usize| (locked.feet[foot] - push.at).xy().norm();
            let nearest = (1..locked.feet.len()).fold(0, |best, foot| if far(foot) < far(best) { foot } else { best });
            let body = description.bodies.iter().position(|body| body.name == robot.feet[nearest].body).unwrap();
            hold(locked.model.described[body], push.at, push.force);
        }
        // The push is on the trunk, at the centre of mass.
        hold(locked.model.described[0], locked.centre, question.scene.bodies[0].force.into());
        let weight = locked.mass * 9.81;
        // The residual of the steps' contact problems, 1e-12 of the impulses, over 1 ms and with arms up to 1 m.
        assert!(tau[..6].iter().all(|force| force.abs() < 1e-8 * weight), "{} {:?}", robot.name, &tau[..6]);
        for (body, force) in description.bodies.iter().skip(1).zip(&tau[6..]) {
            assert!(force.abs() <= body.joint.effort[0], "{} {} {force}", robot.name, body.name);
        }
    }
}

fn pair(height: f64, turn: UnitQuaternion<f64>) -> Vec<featherbench_scenes::Touch> {
    let cube = |name: &str, half: f64, z: f64| {
        let mut body = Body::new(name, 1.0, 1.0, [0.0, 0.0, z]);
        body.shapes.push(Shape { geometry: Geometry::Box { half: [half; 3] }, at: [0.0; 3] });
        body
    };
    let bodies = vec![cube("low", 0.5, 5.0), cube("high", 0.4, height)];
    let scene = Scene { name: "pair".into(), gravity: [0.0; 3], friction: 0.5, restitution: 0.0, bodies };
    let positions: Vec<Vector3<f64>> = scene.bodies.iter().map(|body| body.position.into()).collect();
    touches(&scene, &positions, &[UnitQuaternion::identity(), turn], 0.01)
}

#[test]
fn boxes_touch_with_corners_on_faces() {
    let level = pair(5.899, UnitQuaternion::identity());
    assert_eq!(level.len(), 4);
    for touch in &level {
        // The upper one is on the lower: its normal is up, and it is 1 mm inside.
        assert!(touch.on == 1 && touch.from == Some(0) && (touch.normal - Vector3::z()).norm() < 1e-15, "{touch:?}");
        assert!(
            (touch.gap + 1e-3).abs() < 1e-15 && (touch.at.z - 5.4995).abs() < 1e-15 && (touch.at.x.abs() - 0.4).abs() < 1e-15,
            "{touch:?}"
        );
    }
    // Turned about the vertical by an eighth, the corners are 0.4 √2 from the axis: over the faces' edges, which do not count.
    assert!(pair(5.899, UnitQuaternion::from_scaled_axis(Vector3::z() * std::f64::consts::FRAC_PI_4)).is_empty());
    // On one corner: 0.4 √3 below the centre.
    let on_corner = UnitQuaternion::rotation_between(&Vector3::new(1.0, 1.0, 1.0), &Vector3::z()).unwrap();
    let corner = pair(5.5 + 0.4 * 3.0_f64.sqrt(), on_corner);
    assert!(corner.len() == 1 && corner[0].gap.abs() < 1e-14 && corner[0].at.xy().norm() < 1e-14, "{corner:?}");
    // Apart.
    assert!(pair(5.92, UnitQuaternion::identity()).is_empty());
}

/// Friction holds a box on a box up to its angle, and no further.
#[test]
fn a_box_on_a_box_slides_beyond_the_angle_of_friction() {
    for (slope, slides) in [(0.4_f64, false), (0.55, true)] {
        // tan 0.4 = 0.423 and tan 0.55 = 0.613 with μ = 0.5.
        let stack = BoxStack { boxes: 2, ..BoxStack::default() };
        let mut scene = stack.question().scene;
        scene.gravity = [9.81 * slope.sin(), 0.0, -9.81 * slope.cos()];
        // The lower one is held against gravity, and against the friction of what slides on it.
        scene.bodies[0].force = [-9.81 * slope.sin() - 0.5 * 9.81 * slope.cos() * if slides { 1.0 } else { 0.0 }, 0.0, 0.0];
        let motion = simulate(&scene, 1e-3, 100, 100, &mut OwnSolver::newton()).unwrap();
        let way = motion.position(0, 1).x - motion.position(0, 0).x;
        let due = if slides { 9.81 * (slope.sin() - 0.5 * slope.cos()) * 0.1 * 0.1 / 2.0 } else { 0.0 };
        // Order one over a hundred steps.
        assert!((way - due).abs() <= 0.02 * due + 1e-9, "{slope}: {way} {due}");
    }
}
