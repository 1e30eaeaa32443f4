//! Residuals in files: exact round trips, the canonical form, errors that name the place, and exports that say what they leave out.

use crate::support::{assert_round_trip, chain, placed, refused};
use featherbench_formats::{OnLoss, Reason, mjcf, neutral, urdf};
use featherbench_model::{DescribedResidual, Description, JointType, ResidualLaw};

/// A residual of every law.
fn every() -> Vec<DescribedResidual> {
    let third = 1.0 / 3.0;
    let laws = [
        (vec![2, 0], ResidualLaw::Viscous { coefficient: vec![0.1 + 0.2, -0.0] }),
        (vec![1], ResidualLaw::Coulomb { force: vec![third], width: vec![1e-300] }),
        (vec![3, 1], ResidualLaw::Dry { force: vec![0.0, third] }),
        (
            vec![0],
            ResidualLaw::Stribeck { coulomb: vec![1.0], stiction: vec![1.5], speed: vec![0.1], viscous: vec![0.0], width: vec![0.01] },
        ),
        (vec![2], ResidualLaw::Spring { stiffness: vec![4.0], damping: vec![0.0], rest: vec![-third] }),
        (vec![0], ResidualLaw::SeriesElastic { stiffness: vec![100.0], damping: vec![0.0], motor: vec![0.2] }),
        (vec![1], ResidualLaw::Lag { time: vec![0.01] }),
        (vec![3, 2], ResidualLaw::Delay { periods: 3 }),
        (vec![3], ResidualLaw::Payload { mass: 0.5, com: [0.1, -0.2, third], inertia: [1.0, 0.0, 0.0, 1.0, 0.0, 1.0] }),
        (
            vec![1, 3],
            ResidualLaw::Linear {
                position: vec![1.0, -1.0, -1.0, 1.0],
                velocity: vec![],
                acceleration: vec![third; 4],
                constant: vec![0.0, -0.0],
            },
        ),
    ];
    laws.into_iter()
        .enumerate()
        .map(|(k, (bodies, law))| DescribedResidual { name: format!("the \"{}\" {k}", law.name()), bodies, law })
        .collect()
}

#[test]
fn every_law_round_trips() {
    let robot = Description { residuals: every(), ..chain(4) };
    assert_round_trip(&robot);
    let text = neutral::to_string(&robot).unwrap();
    assert!(text.contains(r#""law":{"type":"viscous","coefficient":[0.30000000000000004,-0.0]}"#), "{text}");
    assert!(!text.contains("\"velocity\":[]"), "an empty list is not written");
}

/// Oracles compute with the rigid bodies, whose content hash does not change.
#[test]
fn the_line_for_oracles_is_that_of_the_rigid_bodies() {
    let robot = Description { residuals: every(), ..chain(4) };
    assert_eq!(neutral::to_line(&robot), neutral::to_line(&chain(4)));
    assert!(!neutral::to_string(&chain(4)).unwrap().contains("residuals"));
}

/// The committed robots with residuals are what this version writes.
#[test]
fn committed_robots_are_written_so() {
    for name in ["worn-arm", "driven-arm"] {
        let path = format!("{}/../../../datasets/models/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let robot = neutral::read(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(robot.residuals.len() >= 4);
        assert_eq!(neutral::to_string(&robot), Ok(std::fs::read_to_string(&path).unwrap()));
        assert_eq!(robot.canonical(), Ok(robot));
    }
}

/// Bodies in another order, and a payload on a flange that is fixed: the canonical form names the moving bodies, and turns the payload with it.
#[test]
fn the_canonical_form_keeps_their_meaning() {
    let mut robot = chain(4);
    let last = robot.bodies.len();
    let mut flange = robot.bodies[3].clone();
    (flange.name, flange.parent, flange.joint.kind) = ("flange".into(), Some(3), JointType::Fixed);
    (flange.mass, flange.inertia) = (0.0, [0.0; 6]);
    // A quarter turn about z, 1 m along x.
    flange.joint.placement.rotation = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    flange.joint.placement.translation = [1.0, 0.0, 0.0];
    robot.bodies.push(flange);
    let law = ResidualLaw::Payload { mass: 0.5, com: [0.25, 0.0, 0.0], inertia: [1.0, 0.0, 0.0, 2.0, 0.0, 3.0] };
    robot.residuals = vec![DescribedResidual { name: "tool".into(), bodies: vec![last], law }];
    let canonical = robot.canonical().unwrap();
    let ResidualLaw::Payload { com, inertia, .. } = &canonical.residuals[0].law else { panic!("a payload") };
    assert_eq!((canonical.residuals[0].bodies.as_slice(), *com), ([3].as_slice(), [1.0, 0.25, 0.0]));
    assert_eq!(*inertia, [2.0, 0.0, 0.0, 1.0, 0.0, 3.0]);

    // Children first: the residual of a body stays with it.
    let mut turned = chain(4);
    turned.bodies.reverse();
    turned.bodies.iter_mut().for_each(|body| body.parent = body.parent.map(|parent| 3 - parent));
    turned.residuals =
        vec![DescribedResidual { name: "f".into(), bodies: vec![0, 2], law: ResidualLaw::Viscous { coefficient: vec![7.0, 5.0] } }];
    assert_eq!(turned.canonical().unwrap().residuals[0].bodies, [3, 1]);
}

const GOOD: &str = r#"{"format":1,"name":"r","gravity":[0,0,-9.81],
 "bodies":[
  {"name":"base","mass":1,"com":[0,0,0],"inertia":[1,0,0,1,0,1],"parent":-1,"joint":{"name":"f","type":"fixed","placement":P}},
  {"name":"a","mass":1,"com":[0.5,0,0],"inertia":[1,0,0,1,0,1],"parent":0,"joint":{"name":"h","type":"revolute","axis":[0,1,0],"placement":P}},
  {"name":"b","mass":1,"com":[0.5,0,0],"inertia":[1,0,0,1,0,1],"parent":1,
   "joint":{"name":"s","type":"spherical","placement":P,"armature":[0,0.1,0]}}
 ],
 "residuals":[
  {"name":"grease","bodies":[1],"law":{"type":"viscous","coefficient":[0.5]}},
  {"name":"drive","bodies":[1],"law":{"type":"lag","time":[0.1]}}]}"#;

#[test]
fn bad_residuals_are_named_by_file_line_and_field() {
    let good = placed(GOOD);
    assert_eq!(neutral::parse(&good, "good.json").unwrap().residuals.len(), 2);
    let viscous = r#""bodies":[1],"law":{"type":"viscous","coefficient":[0.5]}"#;
    let with = |bodies: &str, law: &str| format!(r#""bodies":{bodies},"law":{{{law}}}"#);
    let series = r#""type":"series_elastic","stiffness":[9],"damping":[0],"motor":[1]"#;
    let cases: &[(String, &[&str])] = &[
        (
            with("[1]", r#""type":"sticky","coefficient":[0.5]"#),
            &["f.json:9:", "residuals[0].law", "unknown variant `sticky`", "`stribeck`"],
        ),
        (with("[1]", r#""type":"viscous""#), &["residuals[0].law", "missing field `coefficient`"]),
        (with("[1]", r#""type":"viscous","coefficient":[0.5],"width":[1]"#), &["unknown field `width`, expected `coefficient`"]),
        (
            with("[1]", r#""type":"viscous","coefficient":[0.5,1]"#),
            &["f.json:9:", "residuals[0] 'grease': law.coefficient has 2 numbers; 1 are due"],
        ),
        (with("[1]", r#""type":"viscous","coefficient":[-0.5]"#), &["law.coefficient[0] is -0.5; it must not be negative"]),
        (with("[1]", r#""type":"coulomb","force":[1],"width":[0]"#), &["law.width[0] is 0; it must be positive"]),
        (with("[]", r#""type":"dry","force":[]"#), &["bodies: the residual acts on no joint"]),
        (with("[3]", r#""type":"dry","force":[1]"#), &["body 3 does not exist (there are 3 bodies"]),
        (with("[1,1]", r#""type":"dry","force":[1,1]"#), &["body 1 is named twice"]),
        (with("[0]", r#""type":"dry","force":[]"#), &["body 0 is fixed to its parent"]),
        (with("[0]", r#""type":"payload","mass":1,"com":[0,0,0],"inertia":[0,0,0,0,0,0]"#), &["body 0 does not move, so its payload"]),
        (with("[1,2]", r#""type":"payload","mass":1,"com":[0,0,0],"inertia":[0,0,0,0,0,0]"#), &["carried by one body, and 2 are named"]),
        (with("[1]", r#""type":"payload","mass":-1,"com":[0,0,0],"inertia":[0,0,0,0,0,0]"#), &["law.mass[0] is -1"]),
        (with("[1]", r#""type":"payload","mass":1,"com":[0,0],"inertia":[0,0,0,0,0,0]"#), &["residuals[0].law", "invalid length 2"]),
        (
            with("[1]", r#""type":"stribeck","coulomb":[2],"stiction":[1],"speed":[1],"viscous":[0],"width":[1]"#),
            &["law.stiction[0] is 1, below law.coulomb[0], 2"],
        ),
        (with("[2]", &series.replace("[9]", "[9,9,9]")), &["the spherical joint of body 2 has 4 numbers of q for 3 dofs"]),
        (with("[1]", series), &["residuals[1] 'drive'", "has another drive"]),
        (with("[1]", r#""type":"delay","periods":1"#), &["residuals[1] 'drive'", "has another drive"]),
        (with("[1]", r#""type":"delay","periods":-1"#), &["residuals[0].law", "-1"]),
        (with("[2]", r#""type":"spring","stiffness":[1,1,1],"damping":[0,0,0],"rest":[0,0,0]"#), &["law.rest has 3 numbers; 4 are due"]),
        (with("[1,2]", r#""type":"linear","velocity":[1,2,3]"#), &["law.velocity has 3 numbers; 16 are due for the 4 dofs"]),
    ];
    for (change, parts) in cases {
        let error = refused(&good.replace(viscous, change));
        assert!(parts.iter().all(|part| error.contains(part)), "{change}\n{error}");
    }
    let twice = good.replace("\"drive\"", "\"grease\"");
    assert!(refused(&twice).contains("residuals[1] 'grease': another residual has the same name"));
    let armature =
        good.replace(viscous, &with("[1]", series)).replace(r#"{"name":"drive","bodies":[1],"law":{"type":"lag","time":[0.1]}}"#, "");
    let armature = armature.replace("}},\n  ]}", "}}]}").replace(r#""axis":[0,1,0],"#, r#""axis":[0,1,0],"armature":[0.1],"#);
    let error = refused(&armature);
    assert!(error.contains("has armature, and law.motor holds"), "{error}");
}

#[test]
fn exports_say_that_they_leave_residuals_out() {
    let robot = Description { residuals: every(), ..chain(4) };
    let (_, of_urdf) = urdf::to_string(&robot, OnLoss::LeaveOut).unwrap();
    let (_, of_mjcf) = mjcf::to_string(&robot, OnLoss::LeaveOut).unwrap();
    for losses in [of_urdf, of_mjcf] {
        assert_eq!(losses.iter().filter(|loss| loss.reason == Reason::Residual).count(), 10);
    }
    assert!(urdf::to_string(&robot, OnLoss::Refuse).is_err());
}
