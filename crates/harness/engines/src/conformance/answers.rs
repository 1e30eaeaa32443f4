//! The oracle's answers about robots: shapes, repetition, ranges, and values compared with featherbench's.

use super::exchange::Exchange;
use super::hypotheses::{HYPOTHESES, Hypothesis};
use super::values::{Scene, same_bits};
use super::{Standing, robots};
use crate::oracle::hello::Methods;
use crate::request::states;
use crate::shape;
use featherbench_bench::{Quantity, layout};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Answers to one question: the robot's index, and the values at every state.
type Given = Vec<(usize, Vec<f64>)>;

/// The answers of an oracle, by quantity and method.
#[derive(Default)]
pub(super) struct Answers {
    given: BTreeMap<(String, String), Given>,
}

/// Asks for every quantity of a robot; returns whether the oracle then has robot and states.
pub(super) fn ask(exchange: &mut Exchange, index: usize, scene: &Scene, offered: &Methods, answers: &mut Answers) -> bool {
    let robot = &scene.robot;
    let built = match exchange.prepare(robot) {
        Ok(built) => built,
        Err(reason) => {
            exchange.note(Standing::Wrong, scene.shows, &reason, &[]);
            return false;
        }
    };
    match built.text("status") {
        "unsupported" => {
            exchange.note(Standing::Lacks, scene.shows, built.text("reason"), &[]);
            return false;
        }
        "error" => {
            let advice = ["a robot that the engine does not have is `unsupported`; `error` is for what should have worked"];
            exchange.note(Standing::Wrong, scene.shows, built.text("reason"), &advice);
            return false;
        }
        _ => {}
    }
    for (key, due) in [("nq", robot.description.nq()), ("nv", robot.states.nv)] {
        let found = built.header.get(key).unwrap_or(&Value::Null);
        if found.as_u64() != Some(due as u64) {
            exchange.note(Standing::Wrong, "prepare tells nq and nv", &format!("{key} of {} is {found}, {due} is due", scene.shows), &[]);
        }
    }
    match shape::block(&built, "readback", &shape::of_readback(robot)) {
        Ok(numbers) => readback(exchange, scene, numbers),
        Err(found) => exchange.note(Standing::Wrong, "prepare reads the robot back", &format!("{}: {found}", scene.shows), &[]),
    }
    evaluate_all(exchange, index, scene, offered, answers)
}

/// Asks for every quantity by every method of the robot that it has built; returns whether it took the states.
pub(super) fn evaluate_all(exchange: &mut Exchange, index: usize, scene: &Scene, offered: &Methods, answers: &mut Answers) -> bool {
    let (header, blocks) = states(&scene.robot, &scene.robot.states);
    if exchange.expect("states are taken", header, blocks, &["ok"]).is_none() {
        return false;
    }
    for (quantity, method) in offered.iter().flat_map(|(quantity, methods)| methods.iter().map(move |method| (quantity, method))) {
        let Some(asked) = Quantity::parse(quantity) else { continue };
        if let Some(value) = evaluations(exchange, scene, asked, method) {
            answers.given.entry((quantity.clone(), method.clone())).or_default().push((index, value));
            if asked == Quantity::BodyJacobian
                && let Some(value) = of_every_body(exchange, scene, method)
            {
                let named = (Quantity::BodyJacobians.name().to_owned(), method.clone());
                answers.given.entry(named).or_default().push((index, value));
            }
        }
    }
    true
}

/// One quantity by one method, asked for in several ways.
fn evaluations(exchange: &mut Exchange, scene: &Scene, quantity: Quantity, method: &str) -> Option<Vec<f64>> {
    let named = format!("{} by {method}", quantity.name());
    repeated(exchange, &named, quantity.size(&scene.robot), |exchange, first, count| {
        evaluate(exchange, scene, quantity, method, first, count)
    })
}

/// Answers of this number of values per state: for the whole batch, for it again, and for parts of it.
pub(super) fn repeated(
    exchange: &mut Exchange,
    named: &str,
    size: usize,
    mut ask: impl FnMut(&mut Exchange, usize, usize) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let whole = ask(exchange, 0, robots::STATES)?;
    for (first, count, what) in
        [(0, robots::STATES, "asked twice"), (1, 3, "for a range of states"), (robots::STATES - 1, 1, "for one state")]
    {
        let part = ask(exchange, first, count)?;
        let same = same_bits(&part, &whole[first * size..(first + count) * size]);
        let standing = if same { Standing::Right } else { Standing::Wrong };
        let found = if same { String::new() } else { format!("{named} has other bits") };
        exchange.note(standing, &format!("an answer is the same to the bit {what}"), &found, &[]);
    }
    Some(whole)
}

/// The Jacobian of each body times the vectors of the probe: [`Quantity::BodyJacobians`].
fn of_every_body(exchange: &mut Exchange, scene: &Scene, method: &str) -> Option<Vec<f64>> {
    let (robot, bodies) = (&scene.robot, scene.robot.description.bodies.len());
    let (nv, probe, size) = (robot.states.nv, robot.probe(), Quantity::BodyJacobians.size(robot));
    let each = size / bodies;
    let mut values = vec![0.0; robots::STATES * size];
    for body in 0..bodies {
        let jacobians = evaluate_of(exchange, scene, Quantity::BodyJacobian, method, body, 0, robots::STATES)?;
        for (jacobian, out) in jacobians.chunks_exact(6 * nv).zip(values.chunks_exact_mut(size)) {
            layout::jacobian_products(|row, dof| jacobian[row * nv + dof], &probe, nv, &mut out[body * each..(body + 1) * each]);
        }
    }
    Some(values)
}

fn evaluate(exchange: &mut Exchange, scene: &Scene, quantity: Quantity, method: &str, first: usize, count: usize) -> Option<Vec<f64>> {
    evaluate_of(exchange, scene, quantity, method, scene.robot.deepest_body(), first, count)
}

fn evaluate_of(
    exchange: &mut Exchange,
    scene: &Scene,
    quantity: Quantity,
    method: &str,
    body: usize,
    first: usize,
    count: usize,
) -> Option<Vec<f64>> {
    let (robot, named) = (&scene.robot, format!("{} by {method}", quantity.name()));
    let header = json!({"op": "evaluate", "quantity": quantity.name(), "method": method, "first": first, "count": count, "body": body});
    numbers(exchange, scene, &named, header, &shape::of_value(quantity, robot, count))
}

/// The numbers of the block `value` that answers a question. If there is no answer, the reason is noted.
pub(super) fn numbers(exchange: &mut Exchange, scene: &Scene, named: &str, question: Value, due: &[usize]) -> Option<Vec<f64>> {
    let (standing, found) = match exchange.ask(question, Vec::new()) {
        Err(reason) => (Standing::Wrong, reason),
        Ok(answer) => match answer.text("status") {
            "ok" => match shape::block(&answer, "value", due) {
                Ok(values) => return Some(values.to_vec()),
                Err(found) => (Standing::Wrong, found),
            },
            "unsupported" => (Standing::Lacks, answer.text("reason").to_owned()),
            _ => (Standing::Wrong, answer.text("reason").to_owned()),
        },
    };
    exchange.note(standing, named, &format!("{}: {found}", scene.shows), &[]);
    None
}

/// Names the first field whose read-back differs from the description.
fn readback(exchange: &mut Exchange, scene: &Scene, found: &[f64]) {
    const FIELDS: [(&str, usize, usize); 5] =
        [("mass", 0, 1), ("com", 1, 4), ("inertia", 4, 10), ("the placement's rotation", 10, 19), ("the placement's translation", 19, 22)];
    let given = scene.robot.readback();
    if scene.error(Quantity::Readback, &given, found) <= scene.tolerance(Quantity::Readback, "") {
        return exchange.note(Standing::Right, "prepare reads the robot back", "", &[]);
    }
    let rows = given.chunks_exact(22).zip(found.chunks_exact(22)).zip(&scene.robot.description.bodies);
    let wrong = rows.flat_map(|((given, found), body)| FIELDS.iter().map(move |field| (given, found, body, field)));
    let far = |given: &[f64], found: &[f64]| given.iter().zip(found).any(|(g, f)| (g - f).abs() > 1e-9 || f.is_nan());
    let first = wrong.into_iter().find(|(given, found, _, (_, from, to))| far(&given[*from..*to], &found[*from..*to]));
    let found = first.map_or_else(
        || format!("{} differs", scene.shows),
        |(given, found, body, (field, from, to))| {
            let (given, found) = (&given[*from..*to], &found[*from..*to]);
            format!("{field} of body {} of {} was given as {given:?}, read back as {found:?}", body.name, scene.shows)
        },
    );
    let advice = ["read back what the *engine* holds: mass, com, inertia about the com (xx, xy, xz, yy, yz, zz), rotation, translation"];
    exchange.note(Standing::Wrong, "prepare reads the robot back", &found, &advice);
}

impl Answers {
    /// Compares with featherbench, and looks for the mistake that explains a difference; `route` is added to what is noted.
    pub(super) fn judge(&self, exchange: &mut Exchange, scenes: &[Scene], route: &str) {
        for ((name, method), given) in &self.given {
            let Some(quantity) = Quantity::parse(name) else { continue };
            // The Jacobians of all bodies tell nothing new where that of the deepest is wrong.
            let deepest = (Quantity::BodyJacobian.name().to_owned(), method.clone());
            let wrong = |one: &Given| Compared::all(scenes, Quantity::BodyJacobian, method, one).iter().any(|answer| !answer.right());
            if quantity == Quantity::BodyJacobians && self.given.get(&deepest).is_some_and(wrong) {
                continue;
            }
            let compared = Compared::all(scenes, quantity, method, given);
            let wrong: Vec<&Compared> = compared.iter().filter(|answer| !answer.right()).collect();
            let named = format!("{} by {method}{route}", quantity.name());
            let worst = compared.iter().map(|answer| answer.error).fold(0.0, featherbench_bench::measure::worst);
            if wrong.is_empty() {
                exchange.note(Standing::Right, &named, &format!("{} robots, largest error {worst:.1e}", compared.len()), &[]);
                continue;
            }
            let first = wrong[0];
            let found = format!(
                "{} of {} robots differ from featherbench, the first being {} by {:.1e} (at most {:.0e})",
                wrong.len(),
                compared.len(),
                first.scene.shows,
                first.error,
                first.tolerance
            );
            let advice = advice(&compared, quantity);
            let lines: Vec<&str> = advice.iter().map(String::as_str).collect();
            exchange.note(Standing::Wrong, &named, &found, &lines);
        }
    }
}

/// An answer and featherbench's.
struct Compared<'a> {
    scene: &'a Scene,
    value: &'a [f64],
    error: f64,
    quantity: Quantity,
    tolerance: f64,
}

impl<'a> Compared<'a> {
    fn all(scenes: &'a [Scene], quantity: Quantity, method: &str, given: &'a Given) -> Vec<Self> {
        given.iter().filter_map(|(index, value)| Self::new(&scenes[*index], quantity, method, value)).collect()
    }

    fn new(scene: &'a Scene, quantity: Quantity, method: &str, value: &'a [f64]) -> Option<Self> {
        let error = scene.error(quantity, &scene.featherbench(quantity)?, value);
        Some(Self { scene, value, error, quantity, tolerance: scene.tolerance(quantity, method) })
    }

    fn right(&self) -> bool {
        self.error <= self.tolerance
    }

    /// Whether an oracle with this mistake, and right otherwise, answers with other numbers.
    fn changed(&self, hypothesis: &Hypothesis) -> bool {
        let supposed = self.scene.supposed(&[hypothesis], self.quantity);
        supposed.is_none_or(|supposed| self.scene.featherbench(self.quantity).is_none_or(|right| !same_bits(&supposed, &right)))
    }

    /// Whether the answer is that of an oracle with these mistakes.
    fn explained(&self, hypotheses: &[&Hypothesis]) -> bool {
        let supposed = self.scene.supposed(hypotheses, self.quantity);
        supposed.is_some_and(|supposed| self.scene.error(self.quantity, &supposed, self.value) <= self.tolerance)
    }
}

/// The mistakes, one or two together, that explain every answer. If there are none: the mistake that explains most of the wrong answers.
fn advice(compared: &[Compared], quantity: Quantity) -> Vec<String> {
    if compared.iter().any(|answer| answer.value.iter().any(|x| !x.is_finite())) {
        return vec!["some of its numbers are none (NaN or infinite) at states where featherbench's are finite".into()];
    }
    if Quantity::DERIVATIVES.contains(&quantity) {
        return vec![
            "derivatives by q are along neutral velocities in body axes, with the numbers in v, a and tau fixed; T and b of a change of \
             coordinates have derivatives too. Compare with differences of the oracle's own id or fd"
                .into(),
        ];
    }
    if quantity == Quantity::BodyJacobians {
        return vec!["the deepest body's Jacobian is right: `body` may be any body's index in the description, at any state".into()];
    }
    let told = |hypotheses: &[&Hypothesis]| hypotheses.iter().map(|m| format!("{}: {}", m.seems, m.advice)).collect::<Vec<_>>();
    // Most mistakes fail at the first answer: a small wrong one is tried first.
    let mut in_order: Vec<&Compared> = compared.iter().collect();
    in_order.sort_by_key(|answer| (answer.right(), answer.value.len()));
    let all = |hypotheses: &[&Hypothesis]| in_order.iter().all(|answer| answer.explained(hypotheses));
    let mut single: Vec<(usize, &Hypothesis)> = Vec::new();
    for hypothesis in &HYPOTHESES {
        if all(&[hypothesis]) {
            return told(&[hypothesis]);
        }
        let wrong = compared.iter().filter(|answer| !answer.right());
        single.push((wrong.filter(|answer| answer.explained(&[hypothesis])).count(), hypothesis));
    }
    // Where a mistake changes no wrong answer, it explains nothing in a pair either.
    let wrong = || compared.iter().filter(|answer| !answer.right());
    let telling: Vec<&Hypothesis> = HYPOTHESES.iter().filter(|hypothesis| wrong().any(|answer| answer.changed(hypothesis))).collect();
    for &one in &telling {
        for &other in telling.iter().filter(|other| other.seems != one.seems) {
            if all(&[one, other]) {
                return told(&[one, other]);
            }
        }
    }
    let wrong = wrong().count();
    match single.into_iter().max_by_key(|(count, _)| *count) {
        Some((count, hypothesis)) if count > 0 => {
            vec![format!("of {count} of these {wrong}, {}: {}", hypothesis.seems, hypothesis.advice), "the rest has another cause".into()]
        }
        _ => vec![format!("no usual mistake explains it: compare {} of one joint with a calculation by hand", quantity.name())],
    }
}

/// Notes the quantities that the oracle does not offer.
pub(super) fn lacking(exchange: &mut Exchange, offered: &Methods) {
    let ours = |quantity: &Quantity| {
        matches!(quantity, Quantity::Readback | Quantity::ForwardDynamicsSingle | Quantity::MassMatrixSparse | Quantity::BodyJacobians)
            || Quantity::SECOND_DERIVATIVES.contains(quantity)
    };
    let inner = |quantity: &Quantity| matches!(quantity, Quantity::Factorization | Quantity::FactorEntries | Quantity::Solve);
    let asked = Quantity::ALL.into_iter().filter(|quantity| !ours(quantity) && !inner(quantity));
    let missing: Vec<&str> = asked.map(Quantity::name).filter(|name| !offered.contains_key(*name)).collect();
    if !missing.is_empty() {
        exchange.note(Standing::Lacks, "quantities", &missing.join(", "), &[]);
    }
}
