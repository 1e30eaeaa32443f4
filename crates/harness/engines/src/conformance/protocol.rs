//! Protocol tests: `hello`, requests that have no answer, and the end.

use super::exchange::Exchange;
use super::values::{Scene, same_bits};
use super::{Standing, robots};
use crate::oracle::hello::{Hello, Methods};
use crate::request::{description, states};
use featherbench_bench::Quantity;
use featherbench_protocol::{Block, Message, VERSION};
use serde_json::{Value, json};

/// Asks for its identity and what it offers. Without an answer that can be read the test ends here.
pub(super) fn hello(exchange: &mut Exchange) -> Option<Hello> {
    let answer = exchange.expect("it answers hello", json!({"op": "hello"}), Vec::new(), &["ok"])?;
    let mut wrong = Vec::new();
    let header = &answer.header;
    if header.get("protocol").and_then(Value::as_u64) != Some(VERSION) {
        wrong.push(format!("`protocol` is {}, not {VERSION}", header.get("protocol").unwrap_or(&Value::Null)));
    }
    let missing = ["build", "methods"].into_iter().filter(|key| !header.contains_key(*key));
    wrong.extend(missing.map(|key| format!("`{key}` is missing")));
    let read = Hello::read(header);
    match &read {
        Err(reason) => wrong.push(reason.clone()),
        Ok(hello) => {
            wrong.extend(hello.check().err());
            let asked = |quantity: &str| Quantity::parse(quantity).is_some_and(|known| known != Quantity::Readback);
            let methods = &hello.methods;
            wrong.extend(methods.keys().filter(|key| !asked(key)).map(|key| format!("`methods` names '{key}', which is no quantity")));
            let empty = methods.iter().filter(|(_, names)| names.is_empty() || names.iter().any(String::is_empty));
            wrong.extend(empty.map(|(quantity, _)| format!("`methods` has no method, or one without a name, for {quantity}")));
        }
    }
    let standing = if wrong.is_empty() { Standing::Right } else { Standing::Wrong };
    exchange.note(standing, "hello names protocol, engine, version, build and methods", &wrong.join("; "), &[]);
    exchange.conformance.engine = format!("{} {}", answer.text("engine"), answer.text("version"));
    let mut hello = read.ok()?;
    hello.methods.retain(|quantity, _| Quantity::parse(quantity).is_some());
    exchange.conformance.methods.clone_from(&hello.methods);
    exchange.conformance.steps = hello.steps.as_ref().map(|steps| steps.methods.clone()).unwrap_or_default();
    Some(hello)
}

/// Requests that have no answer while there is no robot.
pub(super) fn before_prepare(exchange: &mut Exchange) {
    let block = || vec![Block::new("x", &[2], &[1.0, 2.0])];
    exchange.expect("an op that nobody knows is an error", json!({"op": "dance"}), Vec::new(), &["error"]);
    exchange.expect("its blocks are read all the same", json!({"op": "dance"}), block(), &["error"]);
    exchange.expect("the next request is answered", json!({"op": "hello"}), Vec::new(), &["ok"]);
    exchange.expect("a request without an op is an error", json!({}), Vec::new(), &["error"]);
    let evaluate = json!({"op": "evaluate", "quantity": "id", "method": "", "first": 0, "count": 1, "body": 0});
    exchange.expect("evaluate before prepare is refused", evaluate, Vec::new(), &["error", "unsupported"]);
    let blocks = vec![Block::new("q", &[1, 1], &[0.0]), Block::new("v", &[1, 1], &[0.0])];
    exchange.expect("states before prepare are an error", json!({"op": "states", "count": 1}), blocks, &["error"]);
    let tagged = exchange.ask(json!({"op": "hello", "id": 41}), Vec::new());
    match tagged.as_ref().map(|answer| answer.header.get("id").cloned()) {
        Ok(Some(id)) if id == json!(41) => exchange.note(Standing::Right, "a request's id comes back", "", &[]),
        Ok(None) => {
            exchange.note(Standing::Lacks, "the ids of requests", "optional: with `id` sent back, a late answer is known as such", &[])
        }
        Ok(Some(id)) => exchange.note(Standing::Wrong, "a request's id comes back", &format!("41 was sent, {id} came back"), &[]),
        Err(reason) => exchange.note(Standing::Wrong, "a request's id comes back", reason, &[]),
    }
}

/// The first robot that it builds.
pub(super) fn first_built<'a>(exchange: &mut Exchange, scenes: &'a [Scene]) -> Option<&'a Scene> {
    let built = scenes.iter().find(|scene| exchange.prepare(&scene.robot).is_ok_and(|answer| answer.text("status") == "ok"));
    if built.is_none() {
        exchange.note(Standing::Wrong, "it builds some robot", "none of the test's robots was built; the reasons follow", &[]);
    }
    built
}

/// Wrong models and requests, and whether the oracle works afterwards.
pub(super) fn with_robot(exchange: &mut Exchange, scene: &Scene, offered: &Methods) {
    let robot = &scene.robot;
    let Ok(good) = description(robot) else { return };
    bad_models(exchange, &good);
    let prepare = json!({"op": "prepare", "model": good});
    if exchange.expect("after all that it builds a robot", prepare.clone(), Vec::new(), &["ok"]).is_none() {
        return;
    }
    let Some((quantity, method)) = offered.iter().find_map(|(quantity, methods)| Some((quantity.clone(), methods.first()?.clone()))) else {
        return exchange.note(Standing::Wrong, "it offers some quantity", "`methods` is empty: there is nothing to ask", &[]);
    };
    let evaluate = |quantity: &str, method: &str, first: usize, count: usize| json!({"op": "evaluate", "quantity": quantity, "method": method, "first": first, "count": count, "body": 0});
    let whole = evaluate(&quantity, &method, 0, robots::STATES);
    exchange.expect("evaluate before states is an error", whole.clone(), Vec::new(), &["error"]);
    let (header, blocks) = states(robot, &robot.states);
    exchange.expect(
        "states of another count than their blocks are an error",
        json!({"op": "states", "count": 7}),
        blocks.clone(),
        &["error"],
    );
    exchange.expect("evaluate after refused states is an error", whole.clone(), Vec::new(), &["error"]);
    exchange.expect("states are taken", header.clone(), blocks.clone(), &["ok"]);
    let first = exchange.expect("it evaluates", whole.clone(), Vec::new(), &["ok"]).and_then(value);
    let nothing = evaluate("no such quantity", &method, 0, 1);
    exchange.expect("a quantity that it does not have is unsupported", nothing, Vec::new(), &["unsupported"]);
    let nothing = evaluate(&quantity, "no such method", 0, 1);
    exchange.expect("a method that it does not have is unsupported", nothing, Vec::new(), &["unsupported"]);
    let beyond = evaluate(&quantity, &method, robots::STATES - 1, 2);
    exchange.expect("states that were not sent are an error", beyond, Vec::new(), &["error"]);
    let mut none = robot.states.clone();
    none.q.fill(f64::NAN);
    let (header_none, blocks_none) = states(robot, &none);
    let (any, opened) = (["ok", "error", "unsupported"], exchange.opened);
    exchange.expect("numbers that are none get an answer", header_none, blocks_none, &any);
    exchange.expect("and so does what is asked about them", whole.clone(), Vec::new(), &any);
    if exchange.opened > opened {
        exchange.expect("after all that it builds a robot", prepare.clone(), Vec::new(), &["ok"]);
    }
    exchange.expect("good states are taken after them", header.clone(), blocks.clone(), &["ok"]);
    let after = exchange.expect("and evaluated", whole.clone(), Vec::new(), &["ok"]).and_then(value);
    same(exchange, "bad numbers leave no trace in later answers", first.as_ref(), after.as_ref());
    exchange.expect("a robot is built twice", prepare, Vec::new(), &["ok"]);
    exchange.expect("a new robot has no states", whole.clone(), Vec::new(), &["error"]);
    exchange.expect("its states are taken", header, blocks, &["ok"]);
    let again = exchange.expect("and it is evaluated", whole, Vec::new(), &["ok"]).and_then(value);
    same(exchange, "the same robot gives the same answer", first.as_ref(), again.as_ref());
}

fn bad_models(exchange: &mut Exchange, good: &Value) {
    let changed = |pointer: &str, value: Value| {
        let mut model = good.clone();
        if let Some(place) = model.pointer_mut(pointer) {
            *place = value;
        }
        model
    };
    let mut bare = good.clone();
    if let Some(body) = bare["bodies"][0].as_object_mut() {
        body.remove("mass");
    }
    let models = [
        ("a model that is no object", json!(7), &["error"][..]),
        ("a model in another format", changed("/format", json!(99)), &["error"]),
        ("a body without a mass", bare, &["error"]),
        ("a com of two numbers", changed("/bodies/0/com", json!([0.0, 0.0])), &["error"]),
        ("a parent that comes later", changed("/bodies/0/parent", json!(3)), &["error", "unsupported"]),
        ("a joint of no known type", changed("/bodies/0/joint/type", json!("wobbly")), &["error", "unsupported"]),
    ];
    for (what, model, allowed) in models {
        exchange.expect(&format!("{what} is refused"), json!({"op": "prepare", "model": model}), Vec::new(), allowed);
    }
    exchange.expect("a prepare without a model is refused", json!({"op": "prepare"}), Vec::new(), &["error"]);
}

/// The end of its input.
pub(super) fn end(exchange: &mut Exchange) {
    match exchange.ask(json!({"op": "hello"}), Vec::new()).and_then(|_| exchange.close()) {
        Ok(()) => exchange.note(Standing::Right, "it ends when its input ends, and has said nothing more", "", &[]),
        Err(reason) => {
            let advice = ["leave the loop when a line is empty; exit with 0; answer each request by one message and no more"];
            exchange.note(Standing::Wrong, "it ends when its input ends, and has said nothing more", &reason, &advice);
        }
    }
}

fn value(answer: Message) -> Option<Vec<f64>> {
    answer.block("value").map(|block| block.data.clone())
}

fn same(exchange: &mut Exchange, what: &str, one: Option<&Vec<f64>>, other: Option<&Vec<f64>>) {
    if let (Some(one), Some(other)) = (one, other) {
        let (standing, found) = if same_bits(one, other) { (Standing::Right, "") } else { (Standing::Wrong, "the bits differ") };
        exchange.note(standing, what, found, &[]);
    }
}
