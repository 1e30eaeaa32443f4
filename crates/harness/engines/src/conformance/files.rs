//! The op `import`: the oracle imports files that we wrote. Its import result is tested, and its answers about the robot that it then has.
//!
//! A parser may edit a robot. So a robot that differs from the file is not a fault here (`featherbench compare` says where engines differ).
//! What is tested: the answers are those of the robot that the oracle reports, in the order in which it reports it.

use super::answers::{self, Answers};
use super::exchange::Exchange;
use super::values::Scene;
use super::{Standing, robots};
use crate::oracle::hello::Methods;
use featherbench_bench::{FileBase, FileFormat, Import, Quantity, Robot};
use featherbench_formats::{OnLoss, mjcf, urdf, usd};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Placement};
use featherbench_protocol::Message;
use featherbench_results::ModelOrigin;
use featherbench_robots::Family;
use serde_json::{Value, json};
use std::path::Path;

/// The quantities that are asked of an imported robot.
const AS_READ: [Quantity; 6] = [
    Quantity::InverseDynamics,
    Quantity::Bias,
    Quantity::MassMatrix,
    Quantity::MassMatrixProbe,
    Quantity::ForwardDynamics,
    Quantity::KineticEnergy,
];
/// The causes that a note may give.
const CAUSES: [&str; 23] = [
    "mass_edited",
    "com_edited",
    "inertia_edited",
    "balanceinertia",
    "bounds",
    "geometry_dropped",
    "from_geometry",
    "free_armature",
    "tendon_armature",
    "actuator_armature",
    "fused",
    "root_welded",
    "bad_value",
    "rotor_inertia",
    "mimic",
    "mimic_otherwise",
    "mimic_dropped",
    "gravity_ignored",
    "not_a_rotation",
    "not_a_mass",
    "no_joints",
    "not_compared",
    "warning",
];
/// The tolerance for numbers of order one. The parser may diagonalise inertias and turn rotations into angles.
const SAME: f64 = 1e-9;
/// More nested elements than an oracle accepts.
const NESTED: usize = 501;
/// A case that our own URDF files never have, as their root is the world: a root that a free base moves. A link is fixed to it.
const FLOATING: &str = r#"<robot name="floating">
  <link name="trunk">
    <inertial><origin xyz="0.02 -0.01 0.05" rpy="0 0 0"/><mass value="4"/>
      <inertia ixx="0.05" ixy="0.002" ixz="-0.001" iyy="0.06" iyz="0.003" izz="0.04"/></inertial>
  </link>
  <link name="lamp">
    <inertial><origin xyz="0 0 0.03" rpy="0 0 0"/><mass value="0.5"/>
      <inertia ixx="0.002" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.002"/></inertial>
  </link>
  <link name="arm">
    <inertial><origin xyz="0.2 0.01 0" rpy="0 0 0"/><mass value="1"/>
      <inertia ixx="0.002" ixy="0.0005" ixz="0" iyy="0.02" iyz="0.0001" izz="0.021"/></inertial>
  </link>
  <joint name="socket" type="fixed"><origin xyz="0.1 0 0.2" rpy="0 0 0.5"/><parent link="trunk"/><child link="lamp"/></joint>
  <joint name="shoulder" type="continuous">
    <origin xyz="0 0.2 0.1" rpy="0.3 -0.2 0.1"/><parent link="trunk"/><child link="arm"/><axis xyz="0 0.6 0.8"/></joint>
</robot>
"#;

/// The robot of [`dyadic`].
const SDF: &str = r#"<sdf version="1.6"><model name="dyadic">
  <link name="upper"><pose>0 0 0.5 0 0 0</pose>
    <inertial><pose>0.25 0 -0.125 0 0 0</pose><mass>2</mass>
      <inertia><ixx>0.5</ixx><ixy>0</ixy><ixz>0</ixz><iyy>0.625</iyy><iyz>0</iyz><izz>0.25</izz></inertia></inertial></link>
  <link name="lower"><pose>0.5 0.25 0 0 0 0</pose>
    <inertial><pose>0 0.125 0.25 0 0 0</pose><mass>0.5</mass>
      <inertia><ixx>0.125</ixx><ixy>0</ixy><ixz>0</ixz><iyy>0.25</iyy><iyz>0</iyz><izz>0.1875</izz></inertia></inertial></link>
  <joint name="shoulder" type="revolute"><parent>world</parent><child>upper</child><axis><xyz>0 1 0</xyz></axis></joint>
  <joint name="slide" type="prismatic"><parent>upper</parent><child>lower</child><axis><xyz>1 0 0</xyz></axis></joint>
</model></sdf>
"#;

/// A robot whose numbers single precision holds.
fn dyadic() -> Description {
    let body = |name: &str, parent, joint: &str, kind, translation, (mass, com, inertia): (f64, [f64; 3], [f64; 6])| BodyDescription {
        name: name.into(),
        parent,
        joint: JointDescription {
            name: joint.into(),
            kind,
            placement: Placement { translation, ..Placement::default() },
            ..JointDescription::default()
        },
        mass,
        com,
        inertia,
    };
    let turns = JointType::Revolute { axis: [0.0, 1.0, 0.0] };
    let slides = JointType::Prismatic { axis: [1.0, 0.0, 0.0] };
    let upper = (2.0, [0.25, 0.0, -0.125], [0.5, 0.0, 0.0, 0.625, 0.0, 0.25]);
    let lower = (0.5, [0.0, 0.125, 0.25], [0.125, 0.0, 0.0, 0.25, 0.0, 0.1875]);
    Description {
        name: "dyadic".into(),
        gravity: [0.0, 0.0, -9.81],
        bodies: vec![
            body("upper", None, "shoulder", turns, [0.0, 0.0, 0.5], upper),
            body("lower", Some(0), "slide", slides, [0.5, 0.25, -0.5], lower),
        ],
        ..Description::default()
    }
}

/// A file that we wrote.
struct Written {
    shows: &'static str,
    name: &'static str,
    format: FileFormat,
    base: FileBase,
    text: String,
    /// The robot in it.
    robot: Description,
}

/// A branched tree of the family `joints`, with joint names that no parser uses itself.
fn tree(kind: &str, base: &str) -> Result<Description, String> {
    let family = Family::parse(&format!("joints:kind={kind},base={base},shape=branched"));
    let mut robot = family.and_then(|family| family.generate()).map_err(|error| error.to_string())?;
    robot.bodies.iter_mut().for_each(|body| body.joint.name = format!("{}_axis", body.name));
    Ok(robot)
}

fn files() -> Result<[Written; 5], String> {
    let fixed = Description { gravity: [0.0, 0.0, -9.81], ..tree("prismatic", "fixed")? };
    let (fixed_text, _) = urdf::to_string(&fixed, OnLoss::Refuse).map_err(|error| error.to_string())?;
    let floating = urdf::Options { base: urdf::Base::Floating, ..urdf::Options::default() };
    let (free, _) = urdf::import(FLOATING, "floating.urdf", &floating).map_err(|error| error.to_string())?;
    let mut scene = tree("spherical", "free")?;
    // MJCF cannot hold these.
    for joint in scene.bodies.iter_mut().map(|body| &mut body.joint) {
        (joint.damping, joint.friction, joint.velocity) = Default::default();
        if joint.kind == JointType::Free {
            joint.placement = Placement::default();
        }
    }
    let (scene_text, _) = mjcf::to_string(&scene, OnLoss::Refuse).map_err(|error| error.to_string())?;
    let (stage, _) = usd::to_string(&dyadic(), OnLoss::Refuse).map_err(|error| error.to_string())?;
    let (urdf, mjcf) = (FileFormat::Urdf, FileFormat::Mjcf);
    Ok([
        Written {
            shows: "a URDF on a fixed base",
            name: "fixed.urdf",
            format: urdf,
            base: FileBase::Fixed,
            text: fixed_text,
            robot: fixed,
        },
        Written {
            shows: "a URDF on a free base",
            name: "free.urdf",
            format: urdf,
            base: FileBase::Free,
            text: FLOATING.into(),
            robot: free,
        },
        Written { shows: "an MJCF", name: "scene.xml", format: mjcf, base: FileBase::Fixed, text: scene_text, robot: scene },
        Written { shows: "an SDF", name: "dyadic.sdf", format: FileFormat::Sdf, base: FileBase::Fixed, text: SDF.into(), robot: dyadic() },
        Written { shows: "a USD", name: "dyadic.usda", format: FileFormat::Usd, base: FileBase::Fixed, text: stage, robot: dyadic() },
    ])
}

/// Lets the oracle import the files, and asks about each. A format that it does not import is lacking.
///
/// # Errors
/// A sentence, when the files cannot be written.
pub(super) fn read(exchange: &mut Exchange, offered: &Methods, rounding: f64) -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(|error| format!("the files to be read cannot be written: {error}"))?;
    let offered: Methods = offered.clone().into_iter().filter(|(name, _)| Quantity::parse(name).is_some()).collect();
    let as_read = |name: &str| Quantity::parse(name).is_some_and(|quantity| AS_READ.contains(&quantity));
    let (due, beside): (Methods, Methods) = offered.into_iter().partition(|(name, _)| as_read(name));
    let (mut scenes, mut answers, mut format) = (Vec::new(), Answers::default(), None);
    for file in files()? {
        let path = folder.path().join(file.name);
        std::fs::write(&path, &file.text).map_err(|error| format!("{}: {error}", path.display()))?;
        let Some(answer) = ask(exchange, &file, &path) else { continue };
        format = format.or(Some(file.format));
        let reading = match crate::oracle::reading(&answer) {
            Ok(reading) => reading,
            Err(reason) => {
                let advice =
                    ["`model` is what the engine holds: bodies depth-first in its own order, fixed links merged; nq and nv are its sums"];
                exchange.note(Standing::Wrong, &what(&file), &reason, &advice);
                continue;
            }
        };
        notes(exchange, &answer);
        compare(exchange, &file, &reading);
        let robot = Robot::new(&reading.description, "conformance", ModelOrigin::Generated, robots::STATES, robots::SEED);
        let scene = Scene::new(file.shows, robot.map_err(|error| error.to_string())?, rounding);
        answers::evaluate_all(exchange, scenes.len(), &scene, &due, &mut answers);
        if let Some((quantity, methods)) = beside.iter().next() {
            let header = json!({"op": "evaluate", "quantity": quantity, "method": methods[0], "first": 0, "count": 1, "body": 0});
            exchange.expect("quantities of bodies are unsupported of a robot as read", header, Vec::new(), &["unsupported"]);
        }
        scenes.push(scene);
    }
    answers.judge(exchange, &scenes, ", as read");
    if let Some(format) = format {
        invalid(exchange, format, folder.path())?;
    }
    Ok(())
}

fn what(file: &Written) -> String {
    format!("it reads {}", file.shows)
}

fn request(path: &Path, format: FileFormat, base: FileBase) -> Value {
    json!({"op": "import", "file": path.to_string_lossy(), "format": format.name(), "base": base.name()})
}

/// The answer, if it imports the file.
fn ask(exchange: &mut Exchange, file: &Written, path: &Path) -> Option<Message> {
    // Its answer to an unknown op. If the answer to `import` has the same words, it does not know `import`.
    let unknown = exchange.ask(json!({"op": "dance"}), Vec::new()).map(|answer| answer.text("reason").replace("dance", "import"));
    let what = what(file);
    match exchange.ask(request(path, file.format, file.base), Vec::new()) {
        Err(reason) => exchange.note(Standing::Wrong, &what, &reason, &["a file that it does not read is `unsupported`"]),
        Ok(answer) => match answer.text("status") {
            "ok" => return Some(answer),
            "unsupported" => exchange.note(Standing::Lacks, &what, answer.text("reason"), &[]),
            _ if unknown.is_ok_and(|unknown| unknown == answer.text("reason")) => {
                exchange.note(Standing::Lacks, "the op `import`", answer.text("reason"), &[]);
            }
            _ => {
                let advice = ["a file that the engine has no parser for is `unsupported`; `error` is for what should have worked"];
                exchange.note(Standing::Wrong, &what, answer.text("reason"), &advice);
            }
        },
    }
    None
}

/// Its notes: they must be texts with known causes.
fn notes(exchange: &mut Exchange, answer: &Message) {
    let wrong = match answer.header.get("notes").and_then(Value::as_array) {
        None => Some("`notes` is no list".to_owned()),
        Some(notes) => notes.iter().find_map(|note| {
            let cause = note["cause"].as_str().unwrap_or_default();
            let about = note["about"].is_null() || note["about"].is_string();
            match CAUSES.contains(&cause) {
                false => Some(format!("there is no cause '{cause}'; the causes are {}", CAUSES.join(", "))),
                true if !about || !note["text"].is_string() => Some(format!("the note {note} has no `text`, or a `about` that is no name")),
                true => None,
            }
        }),
    };
    let standing = if wrong.is_none() { Standing::Right } else { Standing::Wrong };
    exchange.note(standing, "the notes of a reading have causes of the table", &wrong.unwrap_or_default(), &[]);
}

/// Compares the robot that it reports with the file's.
fn compare(exchange: &mut Exchange, file: &Written, reading: &Import) {
    let (what, told) = (what(file), &reading.description);
    let noted = |cause: &str| reading.notes.iter().any(|note| note.cause == cause);
    let floats = |robot: &Description| robot.bodies.first().is_some_and(|body| body.joint.kind == JointType::Free);
    if floats(&file.robot) && !floats(told) && !noted("root_welded") {
        let advice =
            ["with `base` free a URDF's root gets a free joint; where the engine fixes it all the same, a note `root_welded` says so"];
        return exchange.note(Standing::Wrong, &what, "the base is not free", &advice);
    }
    let known =
        |name: &str| links(&file.robot).any(|link| link == name || name.strip_prefix(link).is_some_and(|rest| rest.starts_with('/')));
    let own = |joint: &str| file.robot.bodies.iter().any(|body| body.joint.name == joint);
    let stranger = told.bodies.iter().find_map(|body| match known(&body.name) {
        false => Some(&body.name),
        true => Some(&body.joint.name).filter(|name| body.joint.kind != JointType::Free && !own(name)),
    });
    if let Some(name) = stranger {
        let found = format!("there is no '{name}' in the file");
        return exchange.note(Standing::Wrong, &what, &found, &["bodies and joints have the file's names"]);
    }
    let missing = links(&file.robot).filter(|&link| !links(told).any(|name| name == link)).map(|link| format!("link {link} is missing"));
    let edits = file.robot.bodies.iter().filter_map(|body| {
        let found = told.bodies.iter().find(|found| found.name == body.name)?;
        let parent = |robot: &Description, body: &BodyDescription| body.parent.map(|parent| robot.bodies[parent].name.clone());
        let same_parent = parent(&file.robot, body) == parent(told, found);
        let differs = if same_parent { difference(body, found) } else { Some("parent") };
        Some(format!("{} of {} is another", differs?, body.name))
    });
    let differences: Vec<String> = missing.chain(edits).collect();
    match differences.is_empty() {
        true => exchange.note(Standing::Right, &what, "", &[]),
        false => exchange.note(Standing::Lacks, &format!("{} as it stands", file.shows), &differences.join("; "), &[]),
    }
}

/// The names of bodies and frames.
fn links(robot: &Description) -> impl Iterator<Item = &str> {
    robot.bodies.iter().map(|body| body.name.as_str()).chain(robot.frames.iter().map(|frame| frame.name.as_str()))
}

/// The first property in which two bodies of one name differ.
fn difference(one: &BodyDescription, other: &BodyDescription) -> Option<&'static str> {
    let axis = |body: &BodyDescription| body.joint.kind.axis().unwrap_or_default().to_vec();
    let numbers = |body: &BodyDescription| {
        let placement = body.joint.placement;
        [
            ("mass", vec![body.mass]),
            ("com", body.com.to_vec()),
            ("inertia", body.inertia.to_vec()),
            ("axis", axis(body)),
            ("rotation", placement.rotation.to_vec()),
            ("translation", placement.translation.to_vec()),
        ]
    };
    if one.joint.kind.name() != other.joint.kind.name() {
        return Some("type of joint");
    }
    let far = |(one, other): (&Vec<f64>, &Vec<f64>)| one.iter().zip(other).any(|(a, b)| (a - b).abs() > SAME || b.is_nan());
    let pairs = numbers(one).into_iter().zip(numbers(other));
    pairs.into_iter().find(|((_, one), (_, other))| far((one, other))).map(|((field, _), _)| field)
}

/// Files that are invalid, and whether the oracle works afterwards.
fn invalid(exchange: &mut Exchange, format: FileFormat, folder: &Path) -> Result<(), String> {
    let root = match format {
        FileFormat::Urdf => "robot",
        FileFormat::Mjcf => "mujoco",
        FileFormat::Sdf | FileFormat::Usd => "sdf",
    };
    let broken = format!("<{root} name=\"broken\"><unclosed></{root}>");
    let nested = format!("<{root} name=\"nested\">{}{}</{root}>", "<a>".repeat(NESTED), "</a>".repeat(NESTED));
    for (what, text) in [
        ("a file that is not there", None),
        ("a file that is not well-formed", Some(broken)),
        ("a file of 501 elements in one another", Some(nested)),
    ] {
        let path = folder.join(format!("{}.xml", what.replace(' ', "-")));
        if let Some(text) = text {
            std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
        }
        exchange.expect(&format!("{what} is an error"), request(&path, format, FileBase::Fixed), Vec::new(), &["error"]);
    }
    let robot = robots::all()?.swap_remove(0).1;
    let (header, blocks) = crate::request::states(&robot, &robot.states);
    exchange.expect("a file that was refused leaves no robot", header, blocks, &["error"]);
    Ok(())
}
