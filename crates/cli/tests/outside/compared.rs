//! `compare` on files that engines refuse, repair or import with a default of their own: which engine is named, for what, and the exit
//! code.

use crate::Outcome;
use crate::support::{Ended, Sandbox, project};
use std::path::{Path, PathBuf};
use std::process::Command;

const INERTIAL: &str = r#"<inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/>"#;

fn compare(files: &[PathBuf], more: &[&str], out: &Path) -> Ended {
    let mut command = Command::new(env!("CARGO_BIN_EXE_featherbench"));
    command.current_dir(project()).env("NO_COLOR", "1").arg("compare").args(files).args(more).arg("--out").arg(out);
    Ended::new(command.output().unwrap())
}

/// The differences of an engine in these fields, with their causes. (DART's placements and limits of MJCF files differ as well.)
const FIELDS: [&str; 5] = ["mass", "inertia", "com", "armature", "friction"];

fn differences(out: &Path, engine: &str) -> Vec<(String, String)> {
    let (_, rows) = featherbench_results::read_run(out).unwrap();
    let of_engine = rows.iter().filter(|row| row.metric == "difference" && row.engine == engine && FIELDS.contains(&row.quantity.as_str()));
    let cause = |row: &featherbench_results::Row| {
        let params: serde_json::Value = serde_json::from_str(&row.params).unwrap();
        params["cause"].as_str().unwrap_or_else(|| panic!("{params}")).to_owned()
    };
    of_engine.map(|row| (row.quantity.clone(), cause(row))).collect()
}

/// An MJCF that MuJoCo refuses. That is reported first, MuJoCo's repair is its own difference, and engines that import the file exactly
/// agree.
pub fn refused_files(_: &Path) -> Outcome {
    let sandbox = Sandbox::new();
    let unbalanced = INERTIAL.replace(".02 .03 .04", ".01 .01 .05");
    let hinge = r#"<joint name="h" axis="0 1 0"/>"#;
    let file = sandbox
        .write("flat.xml", &format!(r#"<mujoco model="flat"><worldbody><body name="a">{hinge}{unbalanced}</body></worldbody></mujoco>"#));
    let out = sandbox.path("flat");
    let ended = compare(std::slice::from_ref(&file), &["--engines", "mujoco,pinocchio"], &out);
    ended.expect(1, &["mujoco refuses the file as written; repaired to go on: balanceinertia", "differs: differences of flat in mujoco"]);
    let (first, second) = (ended.output.find("refuses the file as written").unwrap(), ended.output.find("one neutral model").unwrap());
    assert!(first < second, "{}", ended.output);
    assert_eq!(differences(&out, "mujoco"), [("inertia".to_owned(), "balanced".to_owned())]);
    assert_eq!(differences(&out, "pinocchio"), []);
    let head = ended.output.lines().position(|line| line.starts_with("robot") && line.contains("loads as written")).unwrap();
    let lines: Vec<&str> = ended.output.lines().skip(head + 1).take(2).collect();
    let line = |engine: &str| *lines.iter().find(|line| line.contains(engine)).unwrap_or_else(|| panic!("{engine}: {lines:?}"));
    assert!(["altered", "no", "a: inertia by", "correct the file"].iter().all(|word| line("mujoco").contains(word)), "{lines:?}");
    assert!(["yes", "nothing"].iter().all(|word| line("pinocchio").contains(word)), "{lines:?}");

    // The same for a repository: each form names the file, the line and the body.
    let [junit, sarif] = ["found.xml", "found.sarif"].map(|name| sandbox.path(name));
    let forms = ["--annotations", "--junit", junit.to_str().unwrap(), "--sarif", sarif.to_str().unwrap()];
    let ended = compare(std::slice::from_ref(&file), &[&["--engines", "mujoco,pinocchio"], &forms[..]].concat(), &sandbox.path("forms"));
    let place = format!("::error file={},line=1,title=mujoco%3A inertia::mujoco reads the inertia of a as ", file.display());
    ended.expect(1, &[&place]);
    let cases = std::fs::read_to_string(&junit).unwrap();
    assert!(cases.contains("failures=\"1\"") && cases.contains("type=\"inertia\"") && cases.contains("flat.xml:1: "), "{cases}");
    let read: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&sarif).unwrap()).unwrap();
    let found = read["runs"][0]["results"].as_array().unwrap();
    assert_eq!((found.len(), &found[0]["ruleId"], &found[0]["level"]), (1, &"inertia".into(), &"error".into()), "{read}");
    let place = &found[0]["locations"][0]["physicalLocation"];
    assert_eq!((place["region"]["startLine"].as_u64(), place["artifactLocation"]["uri"].as_str()), (Some(1), file.to_str()), "{read}");

    // The same for a program.
    let ended = compare(&[file], &["--engines", "mujoco,pinocchio", "--json"], &sandbox.path("json"));
    assert_eq!(ended.code, Some(1), "{ended:?}");
    let found: serde_json::Value = serde_json::from_str(&ended.output).unwrap_or_else(|error| panic!("{error}: {ended:?}"));
    assert_eq!((&found["status"], &found["robots"][0]["robot"]), (&"differs".into(), &"flat".into()));
    let of = |engine: &str| found["robots"][0]["engines"].as_array().unwrap().iter().find(|of| of["engine"] == engine).unwrap().clone();
    let mujoco = of("mujoco");
    assert_eq!((&mujoco["loads"], &mujoco["same"], &mujoco["largest"]["body"]), (&"altered".into(), &false.into(), &"a".into()));
    assert_eq!(mujoco["differences"][0]["cause"], "balanced");
    assert!(mujoco["largest"]["mass_matrix"].as_f64().unwrap() > 1e-3 && mujoco["error"].as_f64() > mujoco["bound"].as_f64(), "{mujoco}");
    let pinocchio = of("pinocchio");
    assert_eq!((&pinocchio["loads"], &pinocchio["same"], &pinocchio["largest"]), (&"yes".into(), &true.into(), &serde_json::Value::Null));
    assert!(found["conditions"]["unmet"][0]["what"].as_str().unwrap().contains("mujoco"), "{found}");

    // A body without mass: the reference is the file; MuJoCo's bound and DART's kilogram are named.
    let empty = format!(
        r#"<mujoco model="m"><worldbody><body name="a">{hinge}{INERTIAL}<body name="b" pos="0 0 1">{}</body></body></worldbody></mujoco>"#,
        hinge.replace("\"h\"", "\"k\"")
    );
    let out = sandbox.path("empty");
    compare(&[sandbox.write("empty.xml", &empty)], &["--engines", "mujoco,dart,pinocchio"], &out)
        .expect(1, &["refuses the file as written"]);
    let both = |cause: &str| vec![("mass".to_owned(), cause.to_owned()), ("inertia".to_owned(), cause.to_owned())];
    assert_eq!(differences(&out, "mujoco"), both("bounds"));
    // DART ignores the inertial of the other body too, and keeps its mass.
    let left = ["com", "inertia", "mass", "inertia"].map(|field| (field.to_owned(), "default_inertia".to_owned()));
    assert_eq!(differences(&out, "dart"), left);
    assert_eq!(differences(&out, "pinocchio"), []);
    Ok(())
}

/// Armature that a class gives to a free joint is compared as a number, and left out of the answers.
pub fn free_armature(_: &Path) -> Outcome {
    let sandbox = Sandbox::new();
    let file = sandbox.write(
        "dragged.xml",
        &format!(
            r#"<mujoco model="dragged"><default><joint armature=".1"/></default><worldbody><body name="base"><joint name="root" type="free"/>{INERTIAL}
            <body name="arm" pos="0 0 1"><joint name="h" axis="0 1 0"/>{INERTIAL}</body></body></worldbody><actuator><motor joint="h"/></actuator></mujoco>"#
        ),
    );
    let out = sandbox.path("out");
    let ended = compare(&[file], &["--engines", "mujoco,pinocchio,drake"], &out);
    ended.expect(1, &["not compared: 'root': armature (0.1, 0.1, 0.1, 0.1, 0.1, 0.1) on the free joint"]);
    assert!(!ended.output.contains("unexplained:"), "{}", ended.output);
    assert_eq!(differences(&out, "mujoco"), []);
    assert_eq!(differences(&out, "pinocchio"), []);
    assert_eq!(differences(&out, "drake"), [("armature".to_owned(), "unsupported".to_owned())]);
    Ok(())
}

/// One bad file does not stop the others. Friction alone is not a difference of physics. A mimic without a driving joint is reported.
pub fn classes_and_bad_files(_: &Path) -> Outcome {
    let sandbox = Sandbox::new();
    let link = |name: &str| {
        format!(
            r#"<link name="{name}"><inertial><mass value="1"/><inertia ixx=".02" ixy="0" ixz="0" iyy=".03" iyz="0" izz=".04"/></inertial></link>"#
        )
    };
    let joint = |name: &str, child: &str, more: &str| {
        format!(r#"<joint name="{name}" type="continuous"><parent link="stand"/><child link="{child}"/><axis xyz="0 0 1"/>{more}</joint>"#)
    };
    let robot = |more: [&str; 2]| {
        format!(
            r#"<robot name="r"><link name="stand"/>{}{}{}{}</robot>"#,
            link("a"),
            link("b"),
            joint("i", "a", more[0]),
            joint("j", "b", more[1])
        )
    };
    let friction = sandbox.write("friction.urdf", &robot([r#"<dynamics damping="0.1" friction="0.3"/>"#, ""]));
    let bad = sandbox.write("bad.urdf", "<robot name='r'><link/></robot>");
    let drake = |files: &[PathBuf], more: &[&str], out: &str| compare(files, &[&["--engines", "drake"], more].concat(), &sandbox.path(out));
    drake(std::slice::from_ref(&friction), &[], "alone").expect(0, &["1 are not read or carried otherwise", "friction not read"]);
    assert_eq!(differences(&sandbox.path("alone"), "drake"), [("friction".to_owned(), "unsupported".to_owned())]);
    drake(std::slice::from_ref(&friction), &["--strict"], "strict")
        .expect(1, &["other differences in what drake reads of friction: found 1"]);
    drake(&[bad, friction], &[], "both").expect(2, &["not compared:", "bad.urdf", "friction (fixed, 2 bodies", "friction not read"]);
    let circle = sandbox.write("circle.urdf", &robot([r#"<mimic joint="j"/>"#, r#"<mimic joint="i"/>"#]));
    drake(&[circle], &[], "circle").expect(0, &["the joints 'i' → 'j' → 'i' mimic each other in a circle"]);
    Ok(())
}

/// A robot that is too large for a workspace, or for an engine whose time grows with the cube, has a row that says so, and no difference.
pub fn limits(_: &Path) -> Outcome {
    let sandbox = Sandbox::new();
    sandbox.run(&["gen", "chain:n=800", "--lossy", "--out", "long.urdf"]).expect(0, &["800 bodies"]);
    let files = [sandbox.path("long.urdf")];
    compare(&files, &["--engines", "pinocchio"], &sandbox.path("memory"))
        .expect(0, &["its workspace (pinocchio.Data) needs about 9.6 GB for 800 degrees of freedom"]);
    sandbox.run(&["gen", "chain:n=1600", "--lossy", "--out", "longer.urdf"]).expect(0, &["1600 bodies"]);
    let files = [sandbox.path("longer.urdf")];
    compare(&files, &["--engines", "dart"], &sandbox.path("time"))
        .expect(0, &["DART is asked about 1500 bodies at most, and these are 160", "leave it out with --engines: DART is asked"]);
    Ok(())
}

/// An arm of two links; its upper arm has the words of an inertial.
fn arm(inertial: &str) -> String {
    let link = |name: &str, inside: &str| format!("  <link name=\"{name}\">{inside}</link>\n");
    let joint = |name: &str, parent: &str, child: &str, z: f64| {
        let place = format!("<origin xyz=\"0.1 0 {z}\" rpy=\"0.3 -0.2 0.1\"/><parent link=\"{parent}\"/><child link=\"{child}\"/>");
        format!("  <joint name=\"{name}\" type=\"continuous\">{place}<axis xyz=\"0 0.6 0.8\"/></joint>\n")
    };
    let plain = r#"<inertial><mass value="0.7"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial>"#;
    let links = link("base", "") + &link("upper", inertial) + "  <!-- kept -->\n" + &link("lower", plain);
    format!("<robot name=\"arm\">\n{links}{}{}</robot>\n", joint("shoulder", "base", "upper", 0.5), joint("elbow", "upper", "lower", 0.4))
}

const TURNED: &str = r#"<inertial><origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.25"/></inertial>"#;

/// A second file of a robot stands in the place of an engine: in another format it is alike, and a changed number is named.
pub fn two_files(_: &Path) -> Outcome {
    let sandbox = Sandbox::new();
    let text = arm(TURNED);
    let first = sandbox.write("arm.urdf", &text);
    let heavier = sandbox.write("heavier.urdf", &text.replace("<mass value=\"2\"/>", "<mass value=\"2.5\"/>"));
    let ended = compare(&[first.clone(), heavier], &["--engines", "pinocchio"], &sandbox.path("heavier"));
    ended.expect(1, &["heavier.urdf", "upper", "mass"]);
    assert_eq!(differences(&sandbox.path("heavier"), "heavier.urdf"), [("mass".to_owned(), "number".to_owned())]);
    assert_eq!(differences(&sandbox.path("heavier"), "pinocchio"), []);

    // The same robot in another format, with other names.
    let copy = sandbox.path("copy.xml");
    sandbox.run(&["gen", "urdf", "--file", "arm.urdf", "--out", "copy.xml"]).expect(0, &[]);
    let renamed = std::fs::read_to_string(&copy).unwrap().replace("upper", "link_1").replace("elbow", "joint_2").replace("lower", "link_2");
    std::fs::write(&copy, renamed.replace("shoulder", "joint_1")).unwrap();
    let ended = compare(&[first.clone(), copy], &["--engines", "mujoco", "--one"], &sandbox.path("copy"));
    ended.expect(0, &["copy.xml"]);
    assert_eq!(differences(&sandbox.path("copy"), "copy.xml"), []);

    // Two robots are two robots.
    let slides = arm(TURNED).replace("continuous", "prismatic").replace("</joint>", "<limit effort=\"1\" velocity=\"1\"/></joint>");
    let other = sandbox.write("other.urdf", &slides.replace("shoulder", "a").replace("elbow", "b"));
    let ended = compare(&[first, other], &["--engines", "pinocchio"], &sandbox.path("other"));
    assert!(!ended.output.contains("other.urdf "), "{}", ended.output);
    Ok(())
}

/// A round trip names each writer. Ours lose nothing; MuJoCo's write some seven digits of each number, which is told of a body and a field.
pub fn round_trip(_: &Path) -> Outcome {
    let sandbox = Sandbox::new();
    let (file, trip) = (sandbox.write("arm.urdf", &arm(TURNED)), sandbox.path("trip"));
    let ended = compare(&[file], &["--engines", "mujoco", "--round-trip"], &trip);
    ended.expect(1, &["upper: placement by", "arm in MjSpec.to_xml", "arm in mj_saveLastXML"]);
    for (writer, exact) in [("our URDF", true), ("our MJCF", true), ("MjSpec.to_xml", false), ("mj_saveLastXML", false)] {
        let found = differences(&trip, writer);
        // The moments of this inertia have few digits, and the quaternion of their axes has many.
        let due = if exact { vec![] } else { vec![("inertia".to_owned(), "inertia_turned".to_owned())] };
        assert_eq!(found, due, "{writer}");
        assert!(ended.output.contains(writer), "{writer}: {ended:?}");
    }
    assert!(trip.join("written/0/ours.urdf").exists());
    Ok(())
}

/// A copy has what engines agree about: an inertia that no body has gets the nearest one, a fixed link's inertia without mass goes.
pub fn fixes(_: &Path) -> Outcome {
    let sandbox = Sandbox::new();
    let wrong = TURNED.replace("izz=\"0.25\"", "izz=\"0.9\"");
    let file = sandbox.write("arm.urdf", &arm(&wrong));
    let copy = sandbox.path("mended.urdf");
    let ended = compare(&[file], &["--engines", "pinocchio,mujoco,drake", "--fix", copy.to_str().unwrap()], &sandbox.path("fix"));
    ended.expect(0, &["arm.urdf:3: link 'upper': no mass distribution has this inertia; the nearest", "the copy:"]);
    let mended = std::fs::read_to_string(&copy).unwrap();
    assert!(mended.contains("<!-- kept -->") && mended.lines().count() >= arm(&wrong).lines().count(), "{mended}");
    Ok(())
}
