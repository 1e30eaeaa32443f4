//! The conformance test of an oracle in this process: our own kernels, right or with one planted mistake. The right one conforms, and each
//! mistake is found and named.

mod import;
mod kernels;
mod residual;
mod steps;

use featherbench_bench::{Quantity, Robot};
use featherbench_engines::conformance::{Conformance, Connection, Standing, check};
use featherbench_model::JointType;
use featherbench_protocol::Message;
use kernels::{HONEST, Kernels, OFFERED, Plant};
use serde_json::{Value, json};

fn test(plant: Plant) -> Conformance {
    let start = || Ok(Box::new(Kernels::new(plant)) as Box<dyn Connection>);
    check(&start, &|_| ()).unwrap()
}

/// The wrong findings as text, advice included.
fn wrong(plant: Plant) -> Vec<String> {
    let conformance = test(plant);
    let told = conformance.of(Standing::Wrong).map(|finding| format!("{}: {} {}", finding.what, finding.found, finding.advice.join(" ")));
    told.collect()
}

/// Asserts that the findings about these quantities name the mistake, and that nothing else is wrong, except the same of imported robots.
#[track_caller]
fn named(plant: Plant, quantities: &[&str], words: &str) {
    let wrong = wrong(plant);
    for quantity in quantities {
        let about = wrong.iter().find(|line| line.starts_with(&format!("{quantity} by kernel:")));
        let about = about.unwrap_or_else(|| panic!("{quantity} is not among {wrong:#?}"));
        assert!(about.contains(words) && !about.contains("another cause"), "'{words}' is not in {about}");
    }
    let (as_read, built): (Vec<&String>, Vec<&String>) = wrong.iter().partition(|line| line.contains(", as read:"));
    assert_eq!(built.len(), quantities.len(), "{wrong:#?}");
    assert!(as_read.iter().all(|line| line.contains(words) && !line.contains("another cause")), "{as_read:#?}");
}

#[test]
fn an_honest_oracle_conforms() {
    let conformance = test(HONEST);
    assert!(conformance.conforms(), "{:#?}", conformance.of(Standing::Wrong).collect::<Vec<_>>());
    assert_eq!(conformance.engine, "kernels 1");
    let values = conformance.of(Standing::Right).filter(|finding| finding.found.contains("27 robots")).count();
    assert_eq!(values, OFFERED.len() + 1, "every quantity of every robot was compared, and the Jacobians of all bodies");
    let as_read = conformance.of(Standing::Right).filter(|finding| finding.found.contains("2 robots")).count();
    assert_eq!(as_read, 5, "and every quantity that is answered of robots as read");
    let lacking: Vec<_> = conformance.of(Standing::Lacks).map(|finding| finding.what.as_str()).collect();
    assert_eq!(lacking, ["the ids of requests", "quantities", "it reads an MJCF", "it reads an SDF", "it reads a USD"]);
}

/// Derivatives are compared where they are offered; those by finite differences need not have all digits.
#[test]
fn derivatives_are_compared() {
    let honest = test(Plant { derivatives: Some("kernel"), ..HONEST });
    assert!(honest.conforms(), "{:#?}", honest.of(Standing::Wrong).collect::<Vec<_>>());
    let values = honest.of(Standing::Right).filter(|finding| finding.found.contains("27 robots")).count();
    assert_eq!(values, OFFERED.len() + 1 + Quantity::DERIVATIVES.len());

    fn grow(answer: &mut Message, request: &Message, by: f64) {
        if request.text("quantity") == "fd_dq" {
            answer.blocks.iter_mut().flat_map(|block| &mut block.data).for_each(|x| *x *= by);
        }
    }
    let rounded = |answer: &mut Message, request: &Message, _: &Kernels| grow(answer, request, 1.0 + 1e-6);
    let turned = |answer: &mut Message, request: &Message, _: &Kernels| grow(answer, request, -1.0);
    let of = |method, answer| wrong(Plant { derivatives: Some(method), answer, ..HONEST });
    assert_eq!(of("difference_1e-6", rounded), [""; 0]);
    for found in [of("kernel", rounded), of("difference_1e-6", turned)] {
        assert!(found.len() == 1 && found[0].starts_with("fd_dq by ") && found[0].contains("along neutral velocities"), "{found:#?}");
    }
}

/// Changes a block of the request `states`, state after state; the change may use the robot.
fn each_state(message: &mut Message, kernels: &Kernels, name: &str, change: impl Fn(&mut [f64], &[f64], &Robot)) {
    let Some(robot) = kernels.robot.as_ref().filter(|_| message.text("op") == "states") else { return };
    let q = message.block("q").map(|block| block.data.clone()).unwrap_or_default();
    let count = q.len() / robot.states.nq;
    for block in message.blocks.iter_mut().filter(|block| block.name == name && !block.data.is_empty()) {
        let size = block.data.len() / count;
        block.data.chunks_exact_mut(size).zip(q.chunks_exact(robot.states.nq)).for_each(|(part, q)| change(part, q, robot));
    }
}

/// Changes the description of the request `prepare`.
fn each_body(message: &mut Message, change: impl Fn(&mut Value)) {
    if let Some(bodies) = message.header.get_mut("model").and_then(|model| model.get_mut("bodies")).and_then(Value::as_array_mut) {
        bodies.iter_mut().filter(|body| body["joint"].is_object()).for_each(change);
    }
}

/// Puts the given mass, centre and inertia into the read-back. So only the dynamics show the mistake.
fn given_back(answer: &mut Message, request: &Message) {
    let (Some(block), Some(bodies)) =
        (answer.blocks.iter_mut().find(|b| b.name == "readback"), request.header.get("model").and_then(|model| model["bodies"].as_array()))
    else {
        return;
    };
    for (row, body) in block.data.chunks_exact_mut(22).zip(bodies) {
        let numbers = |value: &Value| value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect::<Vec<_>>();
        row[4..10].copy_from_slice(&numbers(&body["inertia"]));
        row[10..19].copy_from_slice(&numbers(&body["joint"]["placement"]["rotation"]));
    }
}

/// The Jacobian of the first body, at the last state alone.
#[test]
fn a_jacobian_of_another_body_than_the_deepest() {
    let answer = |answer: &mut Message, request: &Message, kernels: &Kernels| {
        let of_first = request.text("quantity") == "body_jacobian" && request.header["body"] == 0;
        let several = kernels.robot.as_ref().is_some_and(|robot| robot.depth > 1);
        if let Some(block) = answer.blocks.iter_mut().find(|block| block.name == "value").filter(|_| of_first && several) {
            let last = block.data.len() - 1;
            block.data[last] += 1e-6;
        }
    };
    named(Plant { answer, ..HONEST }, &["body_jacobians"], "any body's index");
}

const DYNAMICS: [&str; 4] = ["bias", "fd", "id", "id_wrench"];

#[test]
fn quaternions_in_another_order() {
    let request = |message: &mut Message, kernels: &Kernels| {
        each_state(message, kernels, "q", |q, _, robot| {
            let mut at = 0;
            for body in &robot.description.bodies {
                let kind = body.joint.kind;
                if matches!(kind, JointType::Spherical | JointType::Free) {
                    let end = at + kind.nq();
                    q[end - 4..end].rotate_left(1);
                }
                at += kind.nq();
            }
        });
    };
    let found = wrong(Plant { request, ..HONEST });
    // Every quantity that depends on q is wrong; the kinetic energy of a single body does not depend on it.
    assert!(found.len() > 8, "{found:#?}");
    for line in &found {
        assert!(line.contains("(w, x, y, z)") && !line.contains("another cause"), "{line}");
    }
}

#[test]
fn a_free_velocity_in_another_order() {
    let swap = |message: &mut Message, kernels: &Kernels| {
        for name in ["v", "a", "tau"] {
            each_state(message, kernels, name, |x, _, robot| {
                if robot.base() == "free" {
                    x[..6].rotate_left(3);
                }
            });
        }
    };
    // The engine's own order is in its answers too.
    let answer = |answer: &mut Message, request: &Message, kernels: &Kernels| {
        let Some(robot) = kernels.robot.as_ref().filter(|robot| robot.base() == "free") else { return };
        let nv = robot.states.nv;
        let Some(block) = answer.blocks.iter_mut().find(|block| block.name == "value") else { return };
        match request.text("quantity") {
            "id" | "id_wrench" | "bias" | "fd" => block.data.chunks_exact_mut(nv).for_each(|x| x[..6].rotate_left(3)),
            "body_jacobian" => block.data.chunks_exact_mut(nv).for_each(|x| x[..6].rotate_left(3)),
            "mass_matrix" => block.data.chunks_exact_mut(nv * nv).for_each(|m| {
                m.chunks_exact_mut(nv).for_each(|row| row[..6].rotate_left(3));
                m[..6 * nv].rotate_left(3 * nv);
            }),
            _ => {}
        }
    };
    let moving = ["body_acceleration", "body_jacobian", "body_velocity", "kinetic_energy", "mass_matrix", "momentum"];
    let all: Vec<&str> = DYNAMICS.iter().chain(&moving).copied().collect();
    named(Plant { request: swap, answer, ..HONEST }, &all, "[angular; linear]");
}

/// Only the linear velocity is in world axes: v = [Rᵀ ṗ; ω], and the forces come back rotated.
#[test]
fn a_free_velocity_in_world_axes() {
    fn turn(robot: &Robot, q: &[f64]) -> [[f64; 3]; 3] {
        let [x, y, z, w] = [q[3], q[4], q[5], q[6]];
        let r = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        let p = robot.description.bodies[0].joint.placement.rotation;
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| p[3 * i + k] * r[k][j]).sum()))
    }
    let request = |message: &mut Message, kernels: &Kernels| {
        // v alone, and so nothing but the kinematics of velocities.
        each_state(message, kernels, "v", |v, q, robot| {
            if robot.base() == "free" {
                let r = turn(robot, q);
                let linear: [f64; 3] = std::array::from_fn(|j| (0..3).map(|i| r[i][j] * v[i]).sum());
                v[..3].copy_from_slice(&linear);
            }
        });
    };
    let found = wrong(Plant { request, ..HONEST });
    for quantity in ["body_velocity", "kinetic_energy", "momentum"] {
        let about = found.iter().find(|line| line.starts_with(quantity)).unwrap_or_else(|| panic!("{quantity}: {found:#?}"));
        assert!(about.contains("linear velocity is taken in world axes: T = diag(R, 1)"), "{about}");
    }
}

#[test]
fn what_is_left_out_of_the_description() {
    let armature = |message: &mut Message, _: &Kernels| {
        each_body(message, |body| body["joint"]["armature"].as_array_mut().into_iter().flatten().for_each(|x| *x = json!(0.0)));
    };
    // The bias force has no armature.
    named(Plant { request: armature, ..HONEST }, &["fd", "id", "id_wrench", "kinetic_energy", "mass_matrix"], "armature is left out");
    let upside_down = |message: &mut Message, _: &Kernels| {
        let gravity = message.header.get_mut("model").and_then(|model| model.get_mut("gravity")).and_then(Value::as_array_mut);
        gravity.into_iter().flatten().for_each(|x| *x = json!(-x.as_f64().unwrap_or(0.0)));
    };
    let affected: Vec<&str> = DYNAMICS.iter().chain(&["potential_energy"]).copied().collect();
    named(Plant { request: upside_down, ..HONEST }, &affected, "gravity has the wrong sign");
    let pitch = |message: &mut Message, _: &Kernels| {
        each_body(message, |body| {
            if let Some(pitch) = body["joint"]["pitch"].as_f64() {
                body["joint"]["pitch"] = json!(pitch / std::f64::consts::TAU);
            }
        });
    };
    let found = wrong(Plant { request: pitch, ..HONEST });
    assert!(found.len() > 10 && found.iter().all(|line| line.contains("pitch of a helical joint is taken per revolution")), "{found:#?}");
    let transposed = |message: &mut Message, _: &Kernels| {
        each_body(message, |body| {
            if let Some(r) = body["joint"]["placement"]["rotation"].as_array().cloned().filter(|r| r.len() == 9) {
                body["joint"]["placement"]["rotation"] = (0..9).map(|k| r[3 * (k % 3) + k / 3].clone()).collect();
            }
        });
    };
    let found = wrong(Plant { request: transposed, answer: |answer, request, _| given_back(answer, request), ..HONEST });
    assert!(found.iter().any(|line| line.starts_with("id by kernel") && line.contains("placements are transposed")), "{found:#?}");
    let found = wrong(Plant { request: transposed, ..HONEST });
    assert!(found.iter().any(|line| line.contains("the placement's rotation of body") && line.contains("read back")), "{found:#?}");
}

/// Two mistakes at once are both named.
#[test]
fn two_mistakes() {
    let request = |message: &mut Message, _: &Kernels| {
        each_body(message, |body| body["joint"]["armature"].as_array_mut().into_iter().flatten().for_each(|x| *x = json!(0.0)));
        let gravity = message.header.get_mut("model").and_then(|model| model.get_mut("gravity")).and_then(Value::as_array_mut);
        gravity.into_iter().flatten().for_each(|x| *x = json!(0.0));
    };
    let found = wrong(Plant { request, ..HONEST });
    let id = found.iter().find(|line| line.starts_with("id by kernel")).unwrap();
    assert!(id.contains("armature is left out") && id.contains("gravity is left out"), "{id}");
    let mass = found.iter().find(|line| line.starts_with("mass_matrix by kernel")).unwrap();
    assert!(mass.contains("armature is left out") && !mass.contains("gravity"), "{mass}");
}

#[test]
fn half_a_matrix_and_numbers_that_are_none() {
    let upper = |answer: &mut Message, request: &Message, kernels: &Kernels| {
        if let (Some(robot), "mass_matrix") = (&kernels.robot, request.text("quantity")) {
            let n = robot.states.nv;
            for block in &mut answer.blocks {
                block.data.iter_mut().enumerate().filter(|(k, _)| (k / n) % n > k % n).for_each(|(_, x)| *x = 0.0);
            }
        }
    };
    named(Plant { answer: upper, ..HONEST }, &["mass_matrix"], "only the upper triangle");
    let none = |answer: &mut Message, request: &Message, _: &Kernels| {
        if request.text("quantity") == "com" {
            answer.blocks.iter_mut().for_each(|block| block.data.fill(f64::NAN));
        }
    };
    named(Plant { answer: none, ..HONEST }, &["com"], "NaN");
    let odd = |answer: &mut Message, request: &Message, _: &Kernels| {
        if request.text("quantity") == "com" {
            answer.blocks.iter_mut().flat_map(|block| &mut block.data).for_each(|x| *x *= 1.0 + 1e-6);
        }
    };
    named(Plant { answer: odd, ..HONEST }, &["com"], "no usual mistake");
}

/// Faults of the protocol: the planted fault, and the finding that names it.
#[test]
fn bad_manners() {
    type Fault = fn(&mut Message, &Message, &Kernels);
    fn if_so(so: bool, answer: &mut Message, change: fn(&mut Message)) {
        if so {
            change(answer);
        }
    }
    let answers: [(&str, Fault); 10] = [
        ("an op that nobody knows is an error", |a, r, _| if_so(r.text("op") == "dance", a, |a| *a = ok())),
        ("hello names", |a, r, _| if_so(r.text("op") == "hello", a, |a| a.header["protocol"] = json!(2))),
        ("hello names", |a, r, _| if_so(r.text("op") == "hello", a, |a| a.header["methods"]["forces"] = json!(["x"]))),
        ("states before prepare", |a, r, _| if_so(r.text("op") == "states", a, |a| *a = ok())),
        ("states that were not sent", |a, r, _| if_so(r.header.get("first") == Some(&json!(5)), a, |a| *a = ok())),
        ("a quantity that it does not have is unsupported", |a, _, _| {
            if_so(a.text("status") == "unsupported", a, |a| a.header["status"] = json!("error"));
        }),
        ("gives no `reason`", |a, _, _| drop(a.header.remove("reason"))),
        ("has the status 'fine'", |a, _, _| if_so(a.text("status") == "ok", a, |a| a.header["status"] = json!("fine"))),
        ("asked twice", |a, _, k| {
            a.blocks.iter_mut().filter(|b| b.name == "value").for_each(|b| b.data[0] += 1e-13 * k.evaluated as f64);
        }),
        ("has the shape", |a, _, _| a.blocks.iter_mut().filter(|b| b.name == "value").for_each(|b| b.shape = vec![b.data.len()])),
    ];
    let request: fn(&mut Message, &Kernels) = |r, _| if_so(r.header.get("first") == Some(&json!(1)), r, |r| r.header["first"] = json!(0));
    let answers = answers.map(|(words, answer)| (words, Plant { answer, ..HONEST }));
    for (words, plant) in answers.into_iter().chain([("for a range of states", Plant { request, ..HONEST })]) {
        let found = wrong(plant);
        assert!(found.iter().any(|line| line.contains(words)), "'{words}' is not in {found:#?}");
    }
}

fn ok() -> Message {
    Message::new(json!({"status": "ok"}), Vec::new())
}

#[test]
fn ids_and_deaths() {
    let echo = |answer: &mut Message, request: &Message, _: &Kernels| {
        if let Some(id) = request.header.get("id") {
            answer.header.insert("id".into(), id.clone());
        }
    };
    assert!(test(Plant { answer: echo, ..HONEST }).of(Standing::Lacks).all(|finding| finding.what != "the ids of requests"));
    let wrong_id = |answer: &mut Message, _: &Message, _: &Kernels| drop(answer.header.insert("id".into(), json!(7)));
    assert!(wrong(Plant { answer: wrong_id, ..HONEST }).iter().any(|line| line.contains("41 was sent, 7 came back")));
    let dies = |answer: &mut Message, request: &Message, _: &Kernels| {
        if request.blocks.iter().any(|block| block.data.iter().any(|x| x.is_nan())) {
            answer.header["status"] = json!("dead");
        }
    };
    let found = wrong(Plant { answer: dies, ..HONEST });
    assert!(found.len() == 1 && found[0].contains("numbers that are none get an answer") && found[0].contains("exited"), "{found:#?}");
}

/// The numbers of joints with several degrees of freedom in another order, in requests and answers.
#[test]
fn coordinates_in_another_order() {
    fn reversed(message: &mut Message, kernels: &Kernels, kind: &str) {
        for (name, size) in
            [("q", JointType::nq as fn(JointType) -> usize), ("v", JointType::nv), ("a", JointType::nv), ("tau", JointType::nv)]
        {
            each_state(message, kernels, name, |x, _, robot| {
                let mut at = 0;
                for joint in robot.description.bodies.iter().map(|body| body.joint.kind) {
                    if joint.name() == kind {
                        x[at..at + size(joint)].reverse();
                    }
                    at += size(joint);
                }
            });
        }
    }
    let distance_first = |message: &mut Message, kernels: &Kernels| reversed(message, kernels, "cylindrical");
    let x_first = |message: &mut Message, kernels: &Kernels| reversed(message, kernels, "euler_zyx");
    // Answers without dofs suffice to show it: the others would have to be put back in order.
    for (request, words) in [(distance_first as fn(&mut Message, &Kernels), "[distance, angle]"), (x_first, "about x, y and z")] {
        let found = wrong(Plant { request, ..HONEST });
        for quantity in ["body_placement", "body_velocity", "kinetic_energy", "momentum"] {
            let about = found.iter().find(|line| line.starts_with(quantity)).unwrap_or_else(|| panic!("{quantity}: {found:#?}"));
            assert!(about.contains(words) && !about.contains("another cause"), "{about}");
        }
    }
}
