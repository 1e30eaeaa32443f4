//! Generated robots: counts against closed forms, canonical, repeatable, physical.

use featherbench_model::{Description, JointType, Model};
use featherbench_robots::{BadFamily, Base, Family, Joints, Kind, Shape};

fn generate(spec: &str) -> Description {
    Family::parse(spec).and_then(|family| family.generate()).unwrap_or_else(|error| panic!("{spec}: {error}"))
}

fn build(spec: &str) -> Model<f64> {
    Model::build(&generate(spec)).unwrap_or_else(|error| panic!("{spec}: {error}"))
}

/// Every family with several parameters; their bits are pinned below.
const SPECS: [&str; 33] = [
    "chain",
    "chain:n=1",
    "chain:n=36,layout=spatial",
    "chain:n=20,layout=spatial,tip_scale=1e6,base=free",
    "chain:n=20,tip_scale=1e-6,base_offset=1e6",
    "tree",
    "tree:n=1,base=free",
    "tree:n=40,seed=3,spread=0,armature=true",
    "tree:n=40,seed=3,spread=1,joints=all",
    "tree:n=60,seed=4,spread=0.5,joints=all,base=free,armature=true",
    "binary_tree:depth=1",
    "binary_tree",
    "star",
    "snake",
    "snake:n=1",
    "centipede",
    "centipede:segments=3,leg=0",
    "platform:robots=10,n=3",
    "humanoid",
    "humanoid:hand_mass=1000",
    "quadruped",
    "hand",
    "joints:kind=helical",
    "joints:kind=planar,base=free",
    "joints:kind=spherical,base=free",
    "joints:kind=mixed",
    "joints:kind=mixed,base=free",
    "joints:kind=translation",
    "joints:kind=cylindrical,shape=single",
    "joints:kind=euler_zyx,base=free,armature=true",
    "joints:kind=free,base=free",
    "joints:kind=all",
    "joints:kind=all,base=free,armature=true",
];

/// Closed forms: stored numbers of M are n + Σ(d_k − 1), its factorization takes Σ d_k(d_k − 1)/2 multiply-subtracts.
#[test]
fn counts_are_those_of_the_closed_forms() {
    let expected = [
        ("chain:n=30", 30, 465, 4_495),
        ("chain:n=36,layout=spatial", 36, 666, 7_770),
        ("humanoid", 36, 351, 1_787),
        ("quadruped", 18, 117, 375),
        ("hand", 26, 191, 685),
        ("star:n=30", 30, 30, 0),
        ("binary_tree:depth=6", 63, 321, 702),
        ("binary_tree:depth=8", 255, 1_793, 5_630),
        ("binary_tree:depth=10", 1_023, 9_217, 37_886),
        // 6 dofs of depths 1 to 6, then n − 1 of depths 7 to n + 5
        ("snake:n=11", 16, 136, 680),
        ("centipede:segments=4,leg=3", 33, 273, 1_112),
        // the base, and 100 times depths 7 to 13
        ("platform", 706, 7_021, 32_935),
    ];
    for (spec, n, stored, products) in expected {
        let topology = build(spec).topology;
        let depths = (0..topology.nv()).map(|dof| topology.dof_depth(dof));
        assert_eq!(topology.nv(), n, "{spec}");
        assert_eq!(topology.stored(), stored, "{spec}");
        assert_eq!(depths.map(|d| d * (d - 1) / 2).sum::<usize>(), products, "{spec}");
    }
}

#[test]
fn a_free_base_adds_six_dofs_and_one_body() {
    for spec in ["chain:n=7,layout=spatial", "tree:n=7,joints=all,spread=0.5"] {
        let (fixed, free) = (generate(spec), generate(&format!("{spec},base=free")));
        assert_eq!(free.bodies.len(), fixed.bodies.len() + 1, "{spec}");
        assert_eq!(free.nv(), fixed.nv() + 6, "{spec}");
        assert_eq!(free.bodies[0].joint.kind, JointType::Free, "{spec}");
        assert!(free.bodies[1..].iter().all(|body| body.parent.is_some()), "{spec}");
    }
}

#[test]
fn generated_robots_are_canonical_and_physical() {
    for spec in SPECS {
        let robot = generate(spec);
        assert_eq!(robot.canonical().as_ref(), Ok(&robot), "{spec}: canonical() must be the identity");
        assert_eq!(robot.warnings(), [], "{spec}");
        assert!(Model::<f64>::build(&robot).is_ok(), "{spec}");
        assert!(!robot.name.is_empty() && robot.frames.is_empty() && robot.provenance.is_none(), "{spec}");
    }
}

#[test]
fn names_tell_the_robots_apart() {
    let mut names: Vec<String> = SPECS.iter().map(|spec| generate(spec).name).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), SPECS.len());
}

/// All numbers and names of a robot as one FNV-1a hash.
fn fingerprint(robot: &Description) -> u64 {
    let mut bytes = Vec::new();
    let mut put = |text: &str, numbers: &[f64]| {
        bytes.extend(text.bytes());
        numbers.iter().for_each(|x| bytes.extend(x.to_bits().to_le_bytes()));
    };
    put(&robot.name, &robot.gravity);
    for body in &robot.bodies {
        let joint = &body.joint;
        put(&body.name, &[body.mass, body.parent.map_or(-1.0, |parent| parent as f64)]);
        put(&joint.name, &body.com);
        put(joint.kind.name(), &body.inertia);
        put("axis", &joint.kind.axis().unwrap_or_default());
        put("pitch", &[if let JointType::Helical { pitch, .. } = joint.kind { pitch } else { 0.0 }]);
        put("placement", &joint.placement.rotation);
        put("at", &joint.placement.translation);
        for list in [&joint.armature, &joint.damping, &joint.friction, &joint.lower, &joint.upper, &joint.velocity, &joint.effort] {
            put("list", list);
        }
    }
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Pinned: rows name robots by family and parameters. So a generator must never change without notice.
#[test]
fn bits_are_pinned() {
    let pinned = [
        ("chain:n=20,layout=spatial,tip_scale=1e6,base=free", 14_660_440_490_540_843_237),
        ("tree:n=60,seed=4,spread=0.5,joints=all,base=free,armature=true", 9_409_489_239_280_068_402),
        ("binary_tree", 6_070_496_488_050_137_049),
        ("star", 15_849_369_524_077_210_708),
        ("snake", 11_318_042_323_959_441_040),
        ("centipede", 14_249_208_906_993_107_279),
        ("platform", 10_478_732_478_382_275_536),
        ("humanoid", 13_519_685_228_342_680_898),
        ("quadruped", 13_574_642_916_772_521_181),
        ("hand", 10_588_947_188_295_049_794),
        ("joints:kind=mixed", 17_566_905_254_947_910_651),
        ("joints:kind=all,base=free,armature=true", 329_552_944_216_800_178),
    ];
    let found: Vec<(&str, u64)> = pinned.iter().map(|&(spec, _)| (spec, fingerprint(&generate(spec)))).collect();
    assert_eq!(found, pinned);
}

#[test]
fn chains_are_dyadic() {
    let robot = generate("chain:n=5,layout=spatial,tip_scale=1024");
    let numbers = robot
        .bodies
        .iter()
        .flat_map(|body| body.com.into_iter().chain(body.inertia).chain([body.mass]).chain(body.joint.placement.translation));
    for x in numbers.chain(robot.gravity) {
        assert_eq!(f64::from(x as f32), x, "exact in single precision too");
    }
    assert_eq!(robot.bodies[4].mass, 1024.0);
    assert_eq!(robot.bodies[4].inertia, [8.0, 0.0, 0.0, 32.0, 0.0, 32.0]);
    assert_eq!(robot.bodies[3].mass, 1.0);
    let axes: Vec<_> = robot.bodies.iter().filter_map(|body| body.joint.kind.axis()).collect();
    assert_eq!(axes[..4], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
}

#[test]
fn random_trees_obey_their_parameters() {
    let depth = |spec| generate(spec).depth();
    assert_eq!(depth("tree:n=50,spread=0"), 50);
    assert!(depth("tree:n=50,spread=1") < 15);
    // The mean depth is about 2/spread.
    let middle = depth("tree:n=2000,spread=0.1");
    assert!((20..200).contains(&middle), "{middle}");
    let kinds = |spec| {
        let mut names: Vec<_> = generate(spec).bodies.iter().map(|body| body.joint.kind.name()).collect();
        names.sort_unstable();
        names.dedup();
        names
    };
    assert_eq!(kinds("tree:n=50"), ["revolute"]);
    assert_eq!(kinds("tree:n=100,joints=all"), ["helical", "planar", "prismatic", "revolute", "spherical", "universal"]);
    // Body k depends on the seed and k only.
    let (short, long) = (generate("tree:n=10,seed=9"), generate("tree:n=30,seed=9"));
    assert_eq!(short.bodies, long.bodies[..10]);
    assert_ne!(short.bodies, generate("tree:n=10,seed=8").bodies);
    // The switch for armature changes nothing else.
    let mut with = generate("tree:n=10,seed=9,armature=true");
    assert!(with.bodies.iter().all(|body| body.joint.armature.len() == 1));
    with.bodies.iter_mut().for_each(|body| body.joint.armature.clear());
    assert_eq!(with.bodies, short.bodies);
}

#[test]
fn joint_robots_show_their_joint_in_the_middle_and_at_the_tips() {
    for &kind in Kind::ALL {
        for &base in Base::ALL {
            let robot = Family::Joints(Joints { kind, base, ..Joints::default() }).generate().expect("every combination exists");
            let is_parent = |i: usize| robot.bodies.iter().any(|body| body.parent == Some(i));
            let shown: Vec<usize> =
                (1..robot.bodies.len()).filter(|&i| !kind.is_single() || robot.bodies[i].joint.kind.name() == kind.name()).collect();
            assert!(shown.iter().any(|&i| is_parent(i)), "{} in the middle", robot.name);
            assert!(shown.iter().filter(|&&i| !is_parent(i)).count() >= 2, "{} at the tips", robot.name);
        }
    }
}

#[test]
fn the_mix_of_all_shows_every_joint_and_armature_changes_nothing_else() {
    let mut robot = generate("joints:kind=all,base=free,armature=true");
    let shown: std::collections::BTreeSet<&str> = robot.bodies.iter().map(|body| body.joint.kind.name()).collect();
    let single: std::collections::BTreeSet<&str> = Kind::ALL.iter().filter(|kind| kind.is_single()).map(|kind| kind.name()).collect();
    assert_eq!(shown, single);
    for joint in robot.bodies.iter().map(|body| &body.joint) {
        assert_eq!(joint.armature.len(), if joint.kind == JointType::Free { 0 } else { joint.kind.nv() }, "{}", joint.name);
    }
    robot.bodies.iter_mut().for_each(|body| body.joint.armature.clear());
    let without = generate("joints:kind=all,base=free");
    assert_eq!(robot.bodies, without.bodies);
    assert_ne!(robot.name, without.name);
}

#[test]
fn single_joints_stand_on_the_world_or_on_a_free_body() {
    for &kind in Kind::ALL {
        for &base in Base::ALL {
            let robot =
                Family::Joints(Joints { kind, base, shape: Shape::Single, armature: false }).generate().expect("every combination exists");
            assert_eq!(robot.depth(), if base == Base::Free { 2 } else { 1 }, "{}", robot.name);
            assert!(robot.bodies.iter().all(|body| !(kind == Kind::Common && body.joint.kind.name() == "helical")), "{}", robot.name);
        }
    }
}

#[test]
fn the_humanoid_is_its_own_mirror_image() {
    let robot = generate("humanoid");
    let find = |name: &str| robot.bodies.iter().find(|body| body.name == name).unwrap_or_else(|| panic!("no body {name}"));
    for left in robot.bodies.iter().filter(|body| body.name.starts_with("left_")) {
        let right = find(&left.name.replace("left_", "right_"));
        let mirrored = |v: [f64; 3]| [v[0], -v[1], v[2]];
        assert_eq!(right.com, mirrored(left.com));
        assert_eq!(right.joint.placement.translation, mirrored(left.joint.placement.translation));
        assert_eq!((right.mass, right.inertia), (left.mass, left.inertia));
        let width = |lower: &[f64], upper: &[f64]| upper[0] - lower[0];
        assert_eq!(width(&right.joint.lower, &right.joint.upper), width(&left.joint.lower, &left.joint.upper));
    }
    let mass: f64 = robot.bodies.iter().map(|body| body.mass).sum();
    assert!((45.0..65.0).contains(&mass), "{mass} kg");
    assert_eq!(generate("humanoid:hand_mass=1000").bodies.last().map(|body| body.name.clone()), Some("head".to_owned()));
}

#[test]
fn specifications_read_back() {
    for spec in SPECS {
        let family = Family::parse(spec).expect("checked above");
        assert_eq!(Family::parse(&family.to_string()), Ok(family), "{spec}");
    }
}

#[test]
fn bad_specifications_are_named() {
    let message = |spec: &str| Family::parse(spec).map(|_| ()).expect_err(spec).to_string();
    let cases = [
        ("chian", "no family 'chian'; choose one of chain"),
        ("chain:20", "'20' in 'chain:20' is not key=value"),
        ("chain:length=3", "'chain' has no parameter 'length'; it takes n, layout"),
        ("chain:n=3,n=4", "'n' is given twice"),
        ("chain:n=0", "n=0 does not do; give 1 to 1000000"),
        ("chain:n=-3", "n=-3 does not do"),
        ("chain:n=1e9", "n=1e9 does not do"),
        ("chain:layout=round", "layout=round does not do; give one of: planar spatial"),
        ("chain:tip_scale=0", "tip_scale=0"),
        ("chain:tip_scale=NaN", "tip_scale=NaN"),
        ("chain:base_offset=inf", "base_offset=inf"),
        ("tree:spread=1.5", "spread=1.5"),
        ("tree:joints=some", "one of: revolute all common"),
        ("binary_tree:depth=64", "depth=64 does not do; give 1 to 20"),
        ("star:n=0", "n=0"),
        ("humanoid:hand_mass=-1", "hand_mass=-1"),
        ("quadruped:legs=6", "it takes none"),
        ("snake:n=0", "n=0 does not do; give 1 to 1000000"),
        ("centipede:segments=500000,leg=1", "leg=1 does not do; give 0 to 0"),
        ("platform:robots=1000,n=1000", "n=1000 does not do; give 1 to 999"),
        ("joints:kind=fixed", "kind=fixed"),
    ];
    for (spec, part) in cases {
        assert!(message(spec).contains(part), "{spec}: {}", message(spec));
    }
    assert_eq!(Family::parse("chain:n=0"), Family::from_parameters("chain", [("n", "0")]));
    assert!(matches!(Family::parse(""), Err(BadFamily::UnknownFamily { .. })));
}
