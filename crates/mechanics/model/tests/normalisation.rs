//! Axes and rotations that are not exactly normalised: what the canonical form makes of them, and which warnings it gives.

use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Label, Model, Placement, Warning};
use featherbench_spatial::{DoubleDouble, Mat3, Quaternion, Real, Transform, Vec3};
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};

/// Random numbers of a seed. The generator of `featherbench_robots` is not for models to use: that crate depends on this one.
struct Draws(TestRng);

impl Draws {
    fn new(seed: u8) -> Self {
        Self(TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]))
    }

    /// Uniform in [low, high).
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 * (0.5 * f64::EPSILON)
    }

    /// Uniform among 0 … count−1.
    fn below(&mut self, count: u32) -> u32 {
        self.0.next_u32() % count
    }

    /// A unit vector, by rejection from the cube.
    fn direction(&mut self) -> [f64; 3] {
        loop {
            let v: [f64; 3] = std::array::from_fn(|_| self.uniform(-1.0, 1.0));
            let square = v.iter().map(|x| x * x).sum::<f64>();
            if (1e-4..=1.0).contains(&square) {
                return v.map(|x| x / square.sqrt());
            }
        }
    }
}

/// The deviation of written numbers: nothing, an ulp of one, and more.
const OFF: [f64; 6] = [0.0, f64::EPSILON, 1e-15, 1e-12, 1e-9, 1e-7];

/// The numbers of a vector, each changed by up to `off` of it.
fn moved<const N: usize>(numbers: [f64; N], off: f64, random: &mut Draws) -> [f64; N] {
    numbers.map(|x| x * (1.0 + off * random.uniform(-1.0, 1.0)))
}

fn axis(random: &mut Draws) -> [f64; 3] {
    match random.below(4) {
        // an axis of romeo, and one whose small components have many digits
        0 => [0.0, -1.0, -4.371_14e-8],
        1 => [1.0, 1e-9 * random.uniform(-1.0, 1.0), 1e-20],
        _ => random.direction(),
    }
}

fn turn(random: &mut Draws) -> [f64; 9] {
    let q: [f64; 4] = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
    let small = q.map(|x| x * 1e-9);
    let q = if random.below(3) == 0 { [small[0], small[1], small[2], 1.0] } else { q };
    Quaternion::from_array(q).to_rotation().to_array()
}

/// Three bodies. The second and third have skew axes and placements that deviate by up to `off`; the first one is fixed in a skew
/// placement.
fn robot(off: f64, random: &mut Draws) -> Description {
    let mut bodies = Vec::new();
    for i in 0..4 {
        let kind = match i {
            0 | 2 => JointType::Fixed,
            1 => JointType::Revolute { axis: moved(axis(random), off, random) },
            _ => JointType::Helical { axis: moved(axis(random), off, random), pitch: 0.1 },
        };
        let placement = Placement { rotation: moved(turn(random), off, random), translation: [0.3, -0.1, 0.2] };
        bodies.push(BodyDescription {
            name: format!("body{i}"),
            parent: (i > 0).then(|| i - 1),
            mass: 1.0,
            com: [0.1, 0.0, 0.0],
            inertia: [0.1, 0.0, 0.0, 0.1, 0.0, 0.1],
            joint: JointDescription { name: format!("joint{i}"), kind, placement, ..JointDescription::default() },
        });
    }
    Description { name: "robot".into(), gravity: [0.0, 0.0, -9.81], bodies, ..Description::default() }
}

/// Largest entry of |RRᵀ − 1|, with 32 digits.
fn skewness<T: Real>(r: Mat3<T>, wide: impl Fn(T) -> DoubleDouble) -> f64 {
    let r = Mat3::from_array(r.to_array().map(wide));
    let gram = r * r.transpose() - Mat3::identity();
    gram.to_array().into_iter().map(|x| x.abs().to_f64()).fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}

#[test]
fn normalising_twice_is_normalising_once_to_the_bit() {
    let mut random = Draws::new(11);
    for off in OFF {
        for _ in 0..500 {
            let written = robot(off, &mut random);
            let once = written.canonical().unwrap();
            let twice = once.canonical().unwrap();
            assert_eq!(once, twice, "off by {off:e}: {written:?}");
            assert_eq!(once.normalised().count(), 0, "off by {off:e}: a canonical description is normalised");
            // An f64 model has these numbers, whichever of the two was compiled.
            let model = Model::<f64>::build(&written).unwrap();
            for (i, body) in once.bodies.iter().enumerate() {
                let parent = body.parent.map_or(Label::Z, |parent| model.labels[parent]);
                let rotation = model.labels[i].rotation_to_described(model.placements[i].rotation);
                let rotation = parent.rotation_to_described(rotation.transpose()).transpose();
                assert_eq!(rotation.to_array(), body.joint.placement.rotation);
                let axis = model.labels[i].to_described(model.subspaces[i].ang);
                assert_eq!(axis.to_array(), body.joint.kind.axis().unwrap());
            }
        }
    }
}

#[test]
fn canonical_numbers_are_as_good_as_doubles_can_be_and_wide_models_have_32_digits() {
    let mut random = Draws::new(12);
    // Rounding moves each entry by half an ulp: products of rows by 2⁻⁵², the length of an axis by 2⁻⁵³.
    let rounded = f64::EPSILON * (1.0 + 1e-12);
    for off in OFF {
        for _ in 0..200 {
            let written = robot(off, &mut random);
            let (narrow, wide) = (Model::<f64>::build(&written).unwrap(), Model::<DoubleDouble>::build(&written).unwrap());
            for i in 0..narrow.topology.bodies() {
                assert!(skewness(narrow.placements[i].rotation, DoubleDouble::from_f64) <= rounded, "off by {off:e}");
                assert!(skewness(wide.placements[i].rotation, |x| x) <= 1e-30, "off by {off:e}");
                let length = wide.subspaces[i].ang.norm();
                assert!((length - DoubleDouble::one()).abs().to_f64() <= 1e-30, "off by {off:e}");
                let length = Vec3::from_array(narrow.subspaces[i].ang.to_array().map(DoubleDouble::from_f64)).norm();
                assert!((length - DoubleDouble::one()).abs().to_f64() <= 0.5 * rounded, "off by {off:e}");
                for (narrow, wide) in narrow.placements[i].rotation.to_array().into_iter().zip(wide.placements[i].rotation.to_array()) {
                    assert!((wide.to_f64() - narrow).abs() <= f64::EPSILON, "both are the same rotation");
                }
            }
        }
    }
}

#[test]
fn fixed_joints_are_normalised_before_they_are_merged_and_their_product_again() {
    let mut random = Draws::new(13);
    for off in OFF {
        for _ in 0..100 {
            let written = robot(off, &mut random);
            // The same placements, normalised one by one like those of moving joints.
            let mut alone = written.clone();
            for body in &mut alone.bodies {
                body.joint.kind = JointType::Spherical;
            }
            let alone = alone.canonical().unwrap();
            let exact = |i: usize| {
                let Placement { rotation, translation } = alone.bodies[i].joint.placement;
                Transform::new(
                    Mat3::from_array(rotation.map(DoubleDouble::from_f64)),
                    Vec3::from_array(translation.map(DoubleDouble::from_f64)),
                )
            };
            let merged = written.canonical().unwrap();
            for (i, first) in [(0, 0), (1, 2)] {
                let due = exact(first).compose(&exact(first + 1));
                let found = merged.bodies[i].joint.placement;
                for (found, due) in found.rotation.iter().zip(due.rotation.to_array()) {
                    // Two factors and the product are rounded, each entry of a factor by half an ulp of one.
                    assert!((due - DoubleDouble::from_f64(*found)).abs().to_f64() <= 2.0 * f64::EPSILON, "off by {off:e}");
                }
                assert!(skewness(Mat3::from_array(found.rotation), DoubleDouble::from_f64) <= f64::EPSILON * (1.0 + 1e-12));
            }
        }
    }
}

#[test]
fn what_is_normalised_by_more_than_an_ulp_is_told() {
    let mut romeo = robot(0.0, &mut Draws::new(14));
    romeo.bodies[1].joint.kind = JointType::Revolute { axis: [0.0, -1.0, -4.371_14e-8] };
    romeo.bodies[2].joint.placement.rotation = [1.0, 0.0, 0.0, 0.0, 1.0 + 3e-9, 0.0, 0.0, 0.0, 1.0];
    let told: Vec<Warning> = romeo.normalised().collect();
    let [Warning::Normalised { body, joint, field: "axis", by }, Warning::Normalised { field: "rotation", by: turned, body: fixed, .. }] =
        &told[..]
    else {
        panic!("{told:?}");
    };
    assert_eq!((body.as_str(), joint.as_str(), fixed.as_str()), ("body1", "joint1", "body2"));
    // ½·(4.37114e-8)²
    assert!((by - 9.5534e-16).abs() < 1e-19, "{by:e}");
    assert!((turned - 3e-9).abs() < 1e-16, "{turned:e}");
    assert_eq!(told[0].to_string(), format!("body 'body1': the axis of joint 'joint1' misses unit length by {by:e}; it is normalised"));
    assert_eq!(Model::<f64>::build(&romeo).unwrap().warnings[..2], told, "they travel with the model");
    assert_eq!(romeo.canonical().unwrap().warnings(), [], "what is canonical has nothing left to tell");

    // Rounding leaves an ulp.
    let mut rounded = robot(0.0, &mut Draws::new(15));
    rounded.bodies[1].joint.kind = JointType::Revolute { axis: [0.0, 1.0 + f64::EPSILON, 0.0] };
    assert_eq!(rounded.normalised().collect::<Vec<_>>(), []);
    assert_eq!(rounded.canonical().unwrap().bodies[0].joint.kind, JointType::Revolute { axis: [0.0, 1.0, 0.0] });
}
