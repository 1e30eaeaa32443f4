//! Commands × sections of a description: each command that gets a robot uses a section, or refuses it or tells it by name.
//!
//! The commands are those of `featherbench --help`, the sections those of the type. Robots and numbers are drawn. A section counts as used where
//! the answer changes with it. So a section is never used and told as not used, and never neither.

use crate::share::one_of;
use crate::support::{Ended, Sandbox, project};
use featherbench_model::{
    Acts, Continuum, ContinuumElement, ContinuumMaterial, ContinuumSection, ContinuumStrain, DescribedResidual, Description, Distribution,
    Frame, JointType, Loop, LoopKind, Placement, ResidualLaw, Section, Target, TargetField, UncertainVariable,
};
use featherbench_robots::{Family, Random};
use std::path::Path;

/// How a command gets a robot.
enum Robots {
    /// It gets none.
    None,
    /// It reads files of the engines' formats alone, with engines: `tests/outside` asks it.
    OfEngines,
    /// By a suite: what it says of a robot is what `run` says, which is asked.
    BySuite,
    /// By its file, in these ways.
    ByFile(&'static [Way]),
}

/// A way to call a command: its name, and its arguments, where ROBOT, LOG and OUT stand for files.
type Way = (&'static str, &'static [&'static str]);

/// How each command gets a robot. A command that is not here is not tested: that is an error.
fn robots_of(command: &str) -> Robots {
    match command {
        "residuals" => Robots::ByFile(&[("residuals", &["residuals", "ROBOT"]), ("another seed", &["residuals", "ROBOT", "--seed", "9"])]),
        "uncertainty" => Robots::ByFile(&[
            ("accelerations", &["uncertainty", "ROBOT", "--method", "first-order"]),
            ("torques", &["uncertainty", "ROBOT", "--method", "unscented", "--torque"]),
            ("another spread", &["uncertainty", "ROBOT", "--method", "first-order", "--spread", "0.1"]),
        ]),
        "identify" => Robots::ByFile(&[
            ("motion", &["identify", "ROBOT", "--excite", "OUT"]),
            ("log", &["identify", "ROBOT", "LOG", "--window", "11", "--method", "ordinary"]),
            ("log, all terms", &["identify", "ROBOT", "LOG", "--window", "11", "--terms", "armature,viscous,coulomb,offset"]),
        ]),
        "gen" => Robots::ByFile(&[
            ("description", &["gen", "neutral", "--file", "ROBOT"]),
            ("URDF", &["gen", "neutral", "--file", "ROBOT", "--format", "urdf", "--lossy"]),
            ("MJCF", &["gen", "neutral", "--file", "ROBOT", "--format", "mjcf", "--lossy"]),
        ]),
        "compare" => Robots::OfEngines,
        "run" | "plan" | "sweep" | "record" | "reduce" | "list" => Robots::BySuite,
        "merge" | "report" | "gate" | "diff" | "history" | "explain" | "export" | "oracles" | "completions" | "man" | "help" => {
            Robots::None
        }
        other => panic!("what '{other}' does with the sections of a robot is not tested"),
    }
}

/// The commands of `featherbench --help`.
fn commands(sandbox: &Sandbox) -> Vec<String> {
    let help = sandbox.run(&["--help"]).output;
    let listed = help.split("Commands:").nth(1).and_then(|rest| rest.split("\n\n").next()).unwrap();
    let names = listed.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| Some(line.split_whitespace().next()?.to_owned())).collect()
}

/// A drawn chain without any section, in no gravity: any effort limit can be kept.
fn plain(random: &mut Random) -> Description {
    let spec = format!("chain:n={},layout=spatial", 2 + random.below(2));
    let mut robot = Family::parse(&spec).unwrap().generate().unwrap();
    robot.gravity = [0.0; 3];
    robot.frames.clear();
    for body in &mut robot.bodies {
        let scale = random.uniform(0.5, 2.0);
        body.mass *= scale;
        body.inertia = body.inertia.map(|x| scale * x);
        let joint = &mut body.joint;
        for list in [
            &mut joint.armature,
            &mut joint.damping,
            &mut joint.friction,
            &mut joint.lower,
            &mut joint.upper,
            &mut joint.velocity,
            &mut joint.effort,
        ] {
            list.clear();
        }
        assert!(matches!(joint.kind, JointType::Revolute { .. }), "{spec}: every joint has one dof");
    }
    assert!(robot.sections().is_empty(), "{:?}", robot.sections());
    robot
}

/// The robot with drawn numbers of a section.
fn with(mut robot: Description, section: Section, random: &mut Random) -> Description {
    let on = random.below(robot.bodies.len());
    let small = random.uniform(0.2, 0.6);
    let joint = &mut robot.bodies[on].joint;
    match section {
        Section::Frames => robot.frames.push(Frame { name: "camera".into(), body: Some(on), placement: Placement::default() }),
        Section::Loops => {
            let terms = vec![(0, 1.0), (1, -random.uniform(1.0, 3.0))];
            robot.loops.push(Loop { name: "gearbox".into(), kind: LoopKind::Gear { terms, offset: 0.0 } });
        }
        Section::Continua => robot.continua.push(Continuum {
            name: "antenna".into(),
            body: Some(on),
            placement: Placement::default(),
            length: small,
            material: ContinuumMaterial { young: 1e9, poisson: 0.3, density: 1000.0, damping: 0.0 },
            section: ContinuumSection::Circle { radius: 0.01 },
            element: ContinuumElement::LinksStart,
            count: 2,
            strains: vec![ContinuumStrain::BendY],
            tip: None,
        }),
        Section::Residuals => {
            let law = ResidualLaw::Viscous { coefficient: vec![10.0 * small] };
            robot.residuals.push(DescribedResidual { name: "grease".into(), bodies: vec![on], law });
        }
        Section::Uncertain => robot.uncertain.variables.push(UncertainVariable {
            name: "load".into(),
            distribution: Distribution::Uniform { low: 0.9, high: 1.0 + small },
            acts: Acts::Factor,
            on: vec![Target { body: on, field: TargetField::Mass }],
        }),
        Section::Armature => joint.armature = vec![small],
        Section::Damping => joint.damping = vec![small],
        Section::Friction => joint.friction = vec![small],
        Section::PositionLimits => (joint.lower, joint.upper) = (vec![-small], vec![small]),
        Section::SpeedLimits => joint.velocity = vec![0.1 * small],
        Section::EffortLimits => joint.effort = vec![1e-4 * small],
    }
    assert!(robot.sections().iter().any(|(found, _)| *found == section));
    robot
}

/// What a command needs a robot to have, beside the section that is looked at.
fn needed(command: &str, robot: Description, random: &mut Random) -> Description {
    if command == "residuals" { with(robot, Section::Residuals, random) } else { robot }
}

/// What a command says of a robot.
fn said(sandbox: &Sandbox, robot: &Description, arguments: &[&str]) -> (Ended, String) {
    let [file, log, out] = ["robot.json", "log.csv", "out.csv"].map(|name| sandbox.path(name).to_str().unwrap().to_owned());
    featherbench_formats::neutral::write(robot, Path::new(&file)).unwrap();
    let place = |word: &&str| match *word {
        "ROBOT" => file.clone(),
        "LOG" => log.clone(),
        "OUT" => out.clone(),
        other => other.to_owned(),
    };
    let arguments: Vec<String> = arguments.iter().map(place).collect();
    let _ = std::fs::remove_file(&out);
    let ended = sandbox.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    let written = std::fs::read_to_string(&out).unwrap_or_default();
    let answer = format!("{}{written}", ended.output);
    (ended, answer)
}

/// What is false in what a command says of a section, if something is.
fn false_statement(sandbox: &Sandbox, plain: &Description, more: &Description, section: Section, way: &[&str]) -> Option<String> {
    let word = section.name();
    let (before, without) = said(sandbox, plain, way);
    if before.code != Some(0) && before.code != Some(1) {
        return Some(format!("the robot without it is not answered: {before:?}"));
    }
    let (after, answer) = said(sandbox, more, way);
    let names: Vec<&str> = more.sections().into_iter().filter(|(found, _)| *found == section).flat_map(|(_, names)| names).collect();
    let tells = |line: &str| line.contains(word) && names.iter().any(|name| line.contains(name));
    let told = after.errors.lines().any(|line| line.starts_with("note: ") && line.contains("does not use") && tells(line));
    let left_out = after.errors.lines().any(|line| line.starts_with("left out: ") && !before.errors.contains(line));
    match after.code {
        Some(2) if tells(&after.errors) => None,
        // The search uses the limits: no motion keeps these.
        Some(2) if section == Section::EffortLimits && after.errors.contains("keeps the limits of joints, speed and torque") => None,
        Some(2) => Some(format!("it is refused, and not by its name: {}", after.errors)),
        Some(0 | 1) if told && answer == without => None,
        // A file may hold a part of a section, and leave out the rest.
        Some(0 | 1) if !told && (left_out || answer != without) => None,
        Some(0 | 1) if told => Some(format!("it is told as not used, and it changes the answer:\n{without}\n{answer}")),
        Some(0 | 1) => Some(format!("it is neither used nor told: {}", after.errors)),
        code => Some(format!("exit code {code:?}: {}", after.errors)),
    }
}

#[test]
fn no_command_ignores_a_section_without_a_word() {
    let sandbox = Sandbox::new();
    let mut random = Random::named(44, "commands and sections");
    let (mut asked, mut wrong) = (0, Vec::new());
    for draw in 0..8 / one_of(8) {
        let bare = plain(&mut random);
        // A log for `identify`, of the motion that tells the parameters.
        said(&sandbox, &bare, &["identify", "ROBOT", "--excite", "LOG"]).0.expect(0, &[]);
        for command in commands(&sandbox) {
            let Robots::ByFile(ways) = robots_of(&command) else { continue };
            let bare = needed(&command, bare.clone(), &mut random);
            for section in Section::ALL {
                if bare.sections().iter().any(|(found, _)| *found == section) {
                    continue;
                }
                let more = with(bare.clone(), section, &mut random);
                // By day one way of each, another one in each draw.
                for (name, way) in ways.iter().skip(draw % one_of(ways.len())).step_by(one_of(ways.len())) {
                    asked += 1;
                    let found = false_statement(&sandbox, &bare, &more, section, way);
                    wrong.extend(found.map(|what| format!("{command}, {name}, {}: {what}", section.name())));
                }
            }
        }
    }
    assert!(asked >= 4 * (Section::ALL.len() - 1), "{asked}");
    assert!(wrong.is_empty(), "{} of {asked}:\n{}", wrong.len(), wrong.join("\n"));
}

/// A suite's answers are those of rigid trees: what a robot has beyond them is told before the run.
#[test]
fn a_suite_tells_what_its_answers_do_not_know() {
    let sandbox = Sandbox::new();
    let models = sandbox.path("project/datasets/models");
    std::fs::create_dir_all(&models).unwrap();
    for entry in std::fs::read_dir(project().join("datasets")).unwrap().map(Result::unwrap) {
        if entry.file_name() != "models" {
            std::os::unix::fs::symlink(entry.path(), sandbox.path("project/datasets").join(entry.file_name())).unwrap();
        }
    }
    for name in ["ci", "oracles"] {
        std::os::unix::fs::symlink(project().join(name), sandbox.path("project").join(name)).unwrap();
    }
    let root = sandbox.path("project");
    let mut random = Random::named(45, "suites and sections");
    for section in Section::ALL {
        let robot = with(plain(&mut random), section, &mut random);
        featherbench_formats::neutral::write(&robot, models.join("drawn.json")).unwrap();
        let suite = "about = \"one\"\nseed = 1\nstates = 2\n[operations]\n[[robot]]\nmodel = \"drawn\"\nfamily = \"chain\"\n";
        let suite = sandbox.write("one.toml", suite);
        for command in ["run", "plan"] {
            let out = sandbox.path(&format!("{command}-{}", section.name().replace(' ', "-")));
            let mut arguments = vec!["--root", root.to_str().unwrap(), command, "--suite", suite.to_str().unwrap()];
            match command {
                "run" => arguments.extend(["--out", out.to_str().unwrap()]),
                _ => drop(arguments.remove(3)),
            }
            let ended = sandbox.run(&arguments);
            match section {
                Section::Continua => ended.expect(2, &["continua", "antenna"]),
                Section::Loops | Section::Residuals | Section::Uncertain => {
                    ended.expect(0, &[]);
                    let line = ended.errors.lines().find(|line| line.contains("does not use")).unwrap_or_default();
                    let name = robot.sections()[0].1[0].to_owned();
                    assert!(line.contains(section.name()) && line.contains(&name), "{command} {section:?}: {ended:?}");
                }
                // CONVENTIONS says for all robots alike that damping and dry friction are no part of any answer, and that limits bound states.
                // Frames change no answer.
                _ => ended.expect(0, &[]),
            }
        }
    }
}
