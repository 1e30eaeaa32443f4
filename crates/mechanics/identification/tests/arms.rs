//! The Denavit–Hartenberg numbers of the arms, against robot files that were imported from their makers' packages.

use featherbench_formats::neutral;
use featherbench_identification::{Arm, Gravity};
use featherbench_model::Description;
use featherbench_spatial::{Transform, Vec3};

/// Each joint's axis in the world at q = 0: its direction, and a point of it.
fn axes(robot: &Description, count: usize) -> Vec<[Vec3<f64>; 2]> {
    let mut at: Vec<Transform<f64>> = Vec::new();
    let mut axes = Vec::new();
    for body in robot.bodies.iter().take(count) {
        let own = body.joint.placement.to_transform();
        let place = body.parent.map_or(own, |parent| at[parent].compose(&own));
        let axis = Vec3::from_array(body.joint.kind.axis().expect("an arm of revolute joints"));
        axes.push([place.rotation * axis, place.translation]);
        at.push(place);
    }
    axes
}

/// What the axes have whatever the frames are. Of neighbours: the cosine of their angle, and their distance. Of each: how far the feet of
/// both common normals are apart along it. This is `None` where neighbours are parallel, and feet are anywhere.
fn invariants(axes: &[[Vec3<f64>; 2]]) -> Vec<Option<f64>> {
    // The point of the first axis that is nearest to the second.
    let foot = |[z, p]: [Vec3<f64>; 2], [other, o]: [Vec3<f64>; 2]| {
        let cosine = z.dot(other);
        let apart = o - p;
        let sine = 1.0 - cosine * cosine;
        (sine > 1e-9).then(|| (z.dot(apart) - cosine * other.dot(apart)) / sine)
    };
    let mut found = Vec::new();
    for pair in axes.windows(2) {
        let [first, second] = [pair[0], pair[1]];
        let apart = second[1] - first[1];
        let distance = match (foot(first, second), foot(second, first)) {
            (Some(one), Some(two)) => (apart + second[0] * two - first[0] * one).norm(),
            _ => (apart - first[0] * first[0].dot(apart)).norm(),
        };
        found.extend([Some(first[0].dot(second[0]).abs()), Some(distance)]);
    }
    for three in axes.windows(3) {
        let (before, behind) = (foot(three[1], three[0]), foot(three[1], three[2]));
        found.push(before.zip(behind).map(|(before, behind)| (before - behind).abs()));
    }
    found
}

#[test]
fn arms_are_those_of_robot_files() {
    for (arm, joints) in [(Arm::ur5(), 6), (Arm::panda(), 7)] {
        let file = format!("{}/../../../../datasets/models/{}.json", env!("CARGO_MANIFEST_DIR"), arm.name);
        let theirs = invariants(&axes(&neutral::read(&file).unwrap(), joints));
        let ours = invariants(&axes(&arm.describe(Gravity::Parallel, 1), joints));
        assert_eq!(theirs.len(), 2 * (joints - 1) + joints - 2);
        assert_eq!(ours.len(), theirs.len());
        assert!(theirs.iter().flatten().any(|number| *number > 0.3), "{}: the links have lengths", arm.name);
        for (k, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            // Files have quarter turns with some ten digits, and lengths with six.
            let same = match (ours, theirs) {
                (Some(ours), Some(theirs)) => (ours - theirs).abs() < 1e-6,
                (ours, theirs) => ours.is_none() && theirs.is_none(),
            };
            assert!(same, "{} number {k}: {ours:?} {theirs:?}", arm.name);
        }
    }
}

/// The iiwa's shoulder, elbow and wrist are at 0.34, 0.74 and 1.14 m of the first axis when it is stretched, and its axes turn by quarters.
#[test]
fn the_iiwa_is_as_documented() {
    let axes = axes(&Arm::iiwa().describe(Gravity::Parallel, 1), 7);
    for (joint, height) in [(1, 0.34), (3, 0.74), (5, 1.14)] {
        let [axis, point] = axes[joint];
        // The point of the joint's frame is on the first axis.
        assert!((point - Vec3::from_array([0.0, 0.0, height])).norm() < 1e-15, "{joint}");
        assert!(axis.to_array()[2].abs() < 1e-15);
    }
    assert!([0, 2, 4, 6].iter().all(|&joint| axes[joint][0].to_array()[2].abs() > 1.0 - 1e-15));
}

/// Axes 2 and 3 of the PUMA are parallel. So of their distances along the axes the sum alone counts: 0.1501 m, beside the 0.15005 m of tables with
/// one number for both.
#[test]
fn the_puma_has_one_shoulder_offset() {
    let numbers = Arm::puma560().joints;
    assert!(numbers[2][1] == 0.0 && (numbers[1][2] + numbers[2][2] - 0.15005).abs() < 1e-4);
    // The arm's lengths differ between tables by 1.3 mm: 0.4331 m by measurement, 0.4318 m by drawing.
    assert!(numbers[2][0] == 0.4318 && (numbers[3][2] - 0.4318).abs() < 1.4e-3);
}
