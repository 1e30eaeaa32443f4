//! A program that shows an error in the engine's own interface: the robot, body by body, the state, the answer beside the truth.
//!
//! All numbers are in the engine's own coordinates, and are written so that they read back to the bit. The program prints the measure of the
//! case, so nothing of this project is needed to see the error.

mod dart;
mod drake;
mod featherbench;
mod mujoco;
mod pinocchio;
#[cfg(test)]
mod tests;
mod theirs;

use crate::{Failure, true_answer};
use featherbench_bench::measure::{ForwardScale, Magnitudes};
use featherbench_bench::{OWN, Quantity, Robot};
use featherbench_model::BodyDescription;
use std::fmt::Write;
use theirs::Theirs;

/// How an engine's interface makes a robot and answers.
struct Interface {
    /// The imports, and an empty robot; `{gravity}` is replaced.
    begin: &'static str,
    /// The body of an index with its joint; `None` if the engine lacks the joint.
    body: fn(&[BodyDescription], usize) -> Option<String>,
    /// What follows the last body; `{armature}` is replaced.
    end: &'static str,
    /// What sets armature, with all dofs' in the place of `{armature}`; empty if a body has its own.
    armature: &'static str,
    /// The answers by quantity and method.
    answers: &'static [(&'static str, &'static str, &'static str)],
    /// The state in the engine's coordinates.
    theirs: fn(&Robot) -> Option<Theirs>,
}

/// The interface of an engine; `None` of one without programs.
fn interface(engine: &str) -> Option<&'static Interface> {
    Some(match engine {
        "pinocchio" => &pinocchio::PINOCCHIO,
        "mujoco" => &mujoco::MUJOCO,
        "drake" => &drake::DRAKE,
        "dart" => &dart::DART,
        OWN => &featherbench::FEATHERBENCH,
        _ => return None,
    })
}

/// The program of a case; `None` where the engine or the method has no such program, or the engine lacks a joint of the robot.
pub fn of(engine: &str, version: &str, finding: &Failure, robot: &Robot) -> Option<String> {
    let interface = interface(engine)?;
    let quantity = if finding.quantity == Quantity::MassMatrixProbe { Quantity::MassMatrix } else { finding.quantity };
    let (.., answer) = interface.answers.iter().find(|(of, method, _)| *of == quantity.name() && *method == finding.method)?;
    let theirs = (interface.theirs)(robot)?;
    let measure = Measure::of(quantity, &finding.metric, robot, &theirs)?;
    let bodies = robot.description.bodies.len();
    let mut text = format!(
        "\"\"\"{engine} {version}: {} by {} on {}.\n\n{}\n\"\"\"\n\n",
        quantity.name(),
        finding.method,
        if bodies == 1 { "one body".to_owned() } else { format!("{bodies} bodies") },
        measure.told
    );
    text += &interface.begin.replace("{gravity}", &list(&robot.description.gravity));
    for at in 0..bodies {
        text += &(interface.body)(&robot.description.bodies, at)?;
    }
    text += &interface.end.replace("{armature}", &armature(interface, robot));
    let states = &robot.states;
    let numbers = [
        ("q", theirs.q.clone()),
        ("v", theirs.turned(states.v(0))),
        ("a", theirs.acceleration(states.a(0))),
        ("tau", theirs.turned(states.tau(0))),
    ];
    // Two empty lines after a function.
    text += if interface.end.is_empty() { "\n" } else { "\n\n" };
    for (name, numbers) in &numbers {
        writeln!(text, "{name} = np.array({})", list(numbers)).ok()?;
    }
    write!(text, "answer = np.array({answer})\n{}", measure.text).ok()?;
    Some(text)
}

fn armature(interface: &Interface, robot: &Robot) -> String {
    let of = |body: &BodyDescription| {
        let count = body.joint.kind.nv();
        (0..count).map(|k| body.joint.armature.get(k).copied().unwrap_or(0.0)).collect::<Vec<f64>>()
    };
    let all: Vec<f64> = robot.description.bodies.iter().flat_map(of).collect();
    if all.iter().all(|armature| *armature == 0.0) { String::new() } else { interface.armature.replace("{armature}", &list(&all)) }
}

/// What a program prints.
struct Measure {
    /// What it is, for the head of the program.
    told: &'static str,
    /// The lines that print it, where `answer` is the engine's.
    text: String,
}

impl Measure {
    /// The answer beside the truth: a force without terms is zero, and there is nothing to divide by.
    fn beside(truth: String) -> Self {
        let told = "It prints the answer and the true one, in which a force without terms is zero.";
        Self { told, text: truth + "print(answer, truth)\n" }
    }

    fn of(quantity: Quantity, metric: &str, robot: &Robot, theirs: &Theirs) -> Option<Self> {
        let mass = true_answer(robot, Quantity::MassMatrix)?;
        let weighted = matches!(quantity, Quantity::InverseDynamics | Quantity::Bias) || metric == "backward";
        let truth = true_answer(robot, quantity).filter(|truth| weighted || truth.iter().any(|x| *x != 0.0));
        // Where there is no true answer, and where that is zero and nothing else is there to divide by.
        let Some(truth) = truth.filter(|_| !metric.is_empty()) else {
            let told = "It prints the answer, or ends with the engine's error.";
            return Some(Self { told, text: "print(answer)\n".into() });
        };
        let truth = theirs.answer(quantity, &truth, &mass)?;
        let mut text = format!("truth = np.array({}).reshape(answer.shape)\n", list(&truth));
        let at = Magnitudes::new(robot, 0);
        let per_entry = "It prints the largest difference from the truth, each entry over the magnitude of its own terms.";
        let told = match (quantity, metric) {
            (Quantity::InverseDynamics | Quantity::Bias, _) => {
                let terms = if quantity == Quantity::Bias { &at.bias_force } else { &at.joint_force };
                let terms = theirs.magnitudes(terms);
                if terms.contains(&0.0) {
                    return Some(Self::beside(text));
                }
                write!(text, "terms = np.array({})\nprint((np.abs(answer - truth) / terms).max())\n", list(&terms)).ok()?;
                per_entry
            }
            (Quantity::MassMatrix, _) => {
                text += "root = np.sqrt(np.diag(truth))\nprint((np.abs(answer - truth) / np.outer(root, root)).max())\n";
                per_entry
            }
            (Quantity::ForwardDynamics, "backward") => {
                let scales = ForwardScale::all(robot, std::slice::from_ref(&at));
                let terms = theirs.magnitudes(&scales.first()?.terms(&true_answer(robot, quantity)?));
                if terms.contains(&0.0) {
                    return Some(Self::beside(text));
                }
                let mass = theirs.mass(&mass);
                let rows: Vec<String> = mass.chunks_exact(robot.states.nv).map(list).collect();
                write!(text, "mass = np.array([{}])\nterms = np.array({})\n", rows.join(", "), list(&terms)).ok()?;
                text += "print((np.abs(mass @ (answer - truth)) / terms).max())\n";
                "It prints the backward error: the largest force that is missing, M (answer − truth), over the magnitude of its terms."
            }
            (Quantity::ForwardDynamics, "forward" | "true_forward") => {
                let mass = theirs.mass(&mass);
                let rows: Vec<String> = mass.chunks_exact(robot.states.nv).map(list).collect();
                writeln!(text, "mass = np.array([{}])", rows.join(", ")).ok()?;
                text += "off = answer - truth\nprint(np.sqrt((off @ mass @ off) / (truth @ mass @ truth)))\n";
                "It prints the difference from the truth over the truth, in the norm of the kinetic energy."
            }
            _ => {
                text += "print(np.abs(answer - truth).max() / np.abs(truth).max())\n";
                "It prints the largest difference from the truth over the largest number of the truth."
            }
        };
        Some(Self { told, text })
    }
}

/// The index of a body's parent in the program's list, where the world is the first.
fn parent(body: &BodyDescription) -> usize {
    body.parent.map_or(0, |parent| parent + 1)
}

/// The call that adds a body behind the parent of the first of its chain: joints, name, place, position, mass and inertia, and what else an
/// engine takes.
fn add(first: &BodyDescription, joints: &str, body: &BodyDescription, position: &[f64; 3], more: &str) -> String {
    let held = format!("{}, {}, {}", number(body.mass), list(&body.com), rows(&full(body.inertia)));
    let turn = rows(&first.joint.placement.rotation);
    format!("add({}, {joints}, {:?}, {turn}, {}, {held}{more})\n", parent(first), body.name, list(position))
}

/// The nine numbers of a tensor (xx, xy, xz, yy, yz, zz).
fn full([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> [f64; 9] {
    [xx, xy, xz, xy, yy, yz, xz, yz, zz]
}

/// Numbers as Python reads them back to the bit.
fn list(numbers: &[f64]) -> String {
    format!("{numbers:?}")
}

/// An axis: by its letter where it is exactly one of the frame's.
fn axis(axis: &[f64; 3]) -> String {
    let letter = ["X", "Y", "Z"].into_iter().zip([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).find(|(_, unit)| unit == axis);
    letter.map_or_else(|| list(axis), |(letter, _)| letter.into())
}

fn rows(m: &[f64; 9]) -> String {
    format!("[{}, {}, {}]", list(&m[..3]), list(&m[3..6]), list(&m[6..]))
}

fn number(x: f64) -> String {
    format!("{x:?}")
}
