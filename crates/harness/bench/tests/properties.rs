//! The properties of robots: of generated ones, of ones with altered bodies, and of files.

use featherbench_bench::{FileBase, FileContent, FileFormat, Robot};
use featherbench_model::{Description, JointType};
use featherbench_results::{Base, Feature, ModelOrigin, Properties};
use featherbench_robots::Family;

fn description(spec: &str) -> Description {
    Family::parse(spec).unwrap().generate().unwrap()
}

fn robot(description: &Description) -> Robot {
    Robot::new(description, "test", ModelOrigin::Generated, 6, 1).unwrap()
}

fn of(spec: &str) -> Properties {
    robot(&description(spec)).properties()
}

/// The features of a robot with an altered description.
fn altered(spec: &str, alter: impl FnOnce(&mut Description)) -> Vec<Feature> {
    let mut description = description(spec);
    alter(&mut description);
    robot(&description).properties().features
}

#[test]
fn joints_armature_and_base_are_those_of_the_description() {
    let tree = of("tree:n=16,seed=4,joints=common,base=free,armature=true");
    assert_eq!(tree.base, Base::Free);
    assert!(tree.offset < 1.0, "{}", tree.offset);
    assert!(tree.joints.contains(&"free".to_owned()) && tree.joints.is_sorted());
    assert!(!tree.armature.contains(&"free".to_owned()) && tree.armature.contains(&"revolute".to_owned()));
    let chain = of("chain:n=7,layout=spatial");
    assert_eq!((chain.base, chain.dofs, chain.joints, chain.armature), (Base::Fixed, 7, vec!["revolute".to_owned()], Vec::new()));
    let far = of("chain:n=5,layout=spatial,base_offset=1e4");
    assert!(far.offset > 9e3, "{}", far.offset);
    let heavy = of("chain:n=5,layout=planar,tip_scale=1e6").mass_ratio;
    assert!((heavy / 1e6 - 1.0).abs() < 1e-9, "{heavy}");
}

#[test]
fn a_common_robot_has_no_features() {
    for spec in ["chain:n=5,layout=spatial", "humanoid", "tree:n=20,seed=1"] {
        assert_eq!(of(spec).features, [], "{spec}");
    }
}

#[test]
fn joints_have_features() {
    assert_eq!(of("joints:kind=free,base=fixed").features, [Feature::FreeJointOnBody]);
    assert_eq!(of("joints:kind=revolute,base=free").features, []);
    assert_eq!(of("joints:kind=revolute,base=free,armature=true").features, [Feature::SkewArmature]);
    let straight = altered("joints:kind=revolute,base=fixed,armature=true", |description| {
        for body in &mut description.bodies {
            body.joint.kind = JointType::Revolute { axis: [0.0, 1.0, 0.0] };
        }
    });
    assert_eq!(straight, []);
}

#[test]
fn bodies_have_features() {
    let nothing = |description: &mut Description, body: usize| {
        let body = &mut description.bodies[body];
        (body.mass, body.com, body.inertia) = (0.0, [0.0; 3], [0.0; 6]);
    };
    let chain = "chain:n=4,layout=planar";
    let turn = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let straight = |description: &mut Description| {
        for body in &mut description.bodies {
            body.joint.placement.rotation = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        }
    };
    let folded = altered(chain, |description| {
        straight(description);
        nothing(description, 1);
    });
    assert_eq!(folded, [Feature::JointChain]);
    let turned = altered(chain, |description| {
        straight(description);
        nothing(description, 1);
        description.bodies[2].joint.placement.rotation = turn;
    });
    assert_eq!(turned, [Feature::ImpossibleBody]);
    let leaf = altered(chain, |description| nothing(description, 3));
    assert!(leaf.contains(&Feature::ImpossibleBody) && leaf.contains(&Feature::SingularMass), "{leaf:?}");
    let armed = altered(chain, |description| {
        nothing(description, 3);
        description.bodies[3].joint.armature = vec![0.1];
    });
    assert!(!armed.contains(&Feature::SingularMass), "{armed:?}");
    let thin = altered(chain, |description| description.bodies[2].inertia = [1.0, 0.0, 0.0, 1.0, 0.0, 3.0]);
    assert_eq!(thin, [Feature::ImpossibleBody]);
}

#[test]
fn rest_and_condition_have_features() {
    let weightless = altered("chain:n=3,layout=planar", |description| description.gravity = [0.0; 3]);
    assert!(weightless.contains(&Feature::Balanced), "{weightless:?}");
    assert_eq!(of("chain:n=100,layout=planar").features, [Feature::BeyondSingle]);
    assert_eq!(of("chain:n=20,layout=planar").features, []);
}

/// The features of a file's robot.
fn of_file(name: &str, text: &str, format: FileFormat) -> Vec<Feature> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    let file = FileContent::read(&path, format).unwrap().file(FileBase::Fixed).unwrap();
    robot(&description("chain:n=3,layout=spatial")).from_file(file).properties().features
}

#[test]
fn files_have_features() {
    let urdf = |inside: &str| of_file("r.urdf", &format!("<robot name='r'>{inside}</robot>"), FileFormat::Urdf);
    let inertia = |ixx: &str, iyy: &str| {
        urdf(&format!(
            "<link name='a'><inertial><mass value='1'/><inertia ixx='{ixx}' ixy='0' ixz='0' iyy='{iyy}' iyz='0' izz='1'/></inertial></link>"
        ))
    };
    assert_eq!(inertia("1", "1"), []);
    assert_eq!(inertia("0", "1"), []);
    assert_eq!(inertia("1", "-0.1"), [Feature::NegativeMoment]);
    let joint = |kind: &str, name: &str| urdf(&format!("<joint name='j' type='{kind}'><mimic joint='{name}'/></joint>"));
    assert_eq!(joint("revolute", "j"), []);
    assert_eq!(joint("fixed", "j"), [Feature::FixedMimic]);
    assert_eq!(joint("revolute", "k"), [Feature::UnknownMimic]);

    let mjcf = |inside: &str| of_file("r.xml", &format!("<mujoco model='r'>{inside}</mujoco>"), FileFormat::Mjcf);
    assert_eq!(mjcf(""), []);
    assert_eq!(of_file("r.xml", "<mujoco/>", FileFormat::Mjcf), [Feature::Unnamed]);
    assert_eq!(mjcf("<worldbody><site/></worldbody>"), [Feature::WorldSite]);
    assert_eq!(mjcf("<asset><hfield/></asset>"), [Feature::HeightField]);
    assert_eq!(mjcf("<worldbody><body><geom type='mesh'/></body></worldbody>"), [Feature::MeshWithoutInertial]);
    assert_eq!(mjcf("<asset><mesh file='a.obj'/></asset>"), []);
    assert_eq!(mjcf("<asset><mesh file='a.stl'/></asset>"), [Feature::MeshFormat]);
}

/// Several roots count in MJCF alone: a parser of URDF has one root link.
#[test]
fn roots_count_in_mjcf() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.xml");
    std::fs::write(&path, "<mujoco model='r'/>").unwrap();
    let star = robot(&description("star:n=4"));
    assert_eq!(star.properties().features, []);
    for (format, expected) in [(FileFormat::Urdf, Vec::new()), (FileFormat::Mjcf, vec![Feature::SeveralRoots])] {
        let file = FileContent::read(&path, format).unwrap().file(FileBase::Fixed).unwrap();
        assert_eq!(star.clone().from_file(file).properties().features, expected);
    }
}
