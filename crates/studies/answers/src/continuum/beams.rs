//! One cantilever by every element, of ours and of engines: tips under forces, frequencies, and the time of a forward dynamics.
//!
//! Every cell is one engine's rod of so many elements. Its rows tell the errors against the elastica and the roots of the cantilever. Over the
//! refinements of an element errors have an order and, for frequencies, a prefactor of theory:
//!
//! | element | ω/ω_exact − 1 → |
//! |---|---|
//! | rigid links, springs in the middle of elements | σβ/6 /n² |
//! | rigid links, springs at their start | −1/n |
//! | the same with 2EI/h at the clamp | −σβ/3 /n² |
//! | constant curvature | σβ (2 + σβ)/24 /n² |
//! | MuJoCo's flex of edges, clamped by an edge within the wall | −σβ (6 + σβ)/12 /n² |
//! | PyElastica, with its first director held | 1/n |
//! | cubic Hermite splines | β⁴/1440 /n⁴ |
//!
//! Tips have prefactors too, for each force. Derivations are those of `featherbench_continua::known`.

use super::{Law, NoAnswer, STUDY, element, failed, largest, rod};
use featherbench_bench::{Asked, Cell, Context, Finished, OWN, RodAnswer, RodQuestion};
use featherbench_continua::known::{
    cantilever_root, edges_frequency_prefactor, edges_tip_prefactor, elastica, hermite_frequency_prefactor, links_frequency_prefactor,
    links_tip_prefactor, sections_frequency_prefactor, sections_tip_prefactor,
};
use featherbench_continua::{Hinges, Load, Settings, Solver, Status, equilibrium, fit, modes, systems};
use featherbench_results::{Kind, Row, Verdict};
use featherbench_study::{case_row, unanswered};
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// The parameters of a cell.
#[derive(Serialize, Deserialize)]
pub(super) struct Refinement {
    pub(super) elements: usize,
    forces: [f64; 3],
}

/// The quantity of these cells.
pub(super) const QUANTITY: &str = "beam";
/// The refinements. An error of first order has the slope 1 to 0.05 only where the next term is small: it needs finer ones.
const COUNTS: [usize; 6] = [4, 8, 16, 32, 48, 64];
const COUNTS_OF_FIRST_ORDER: [usize; 7] = [16, 24, 32, 48, 64, 96, 144];
const COUNTS_OF_HELD: [usize; 9] = [16, 24, 32, 48, 64, 96, 144, 216, 324];
/// Of splines the refinements of a law are few parts per wave: finer ones show rounding alone, coarser ones the next term.
const COUNTS_OF_SPLINES: [usize; 10] = [4, 6, 8, 12, 16, 24, 32, 48, 64, 80];
/// Tips are compared up to so many elements.
const MOST_OF_TIPS: usize = 64;
/// The dead forces at the tip, F L²/EI.
const FORCES: [f64; 3] = [0.1, 1.0, 10.0];
/// Frequencies.
const MODES: usize = 3;
/// Our elements. Shape functions are for small deflections: their tips are not compared.
const OWN_ELEMENTS: [&str; 5] = ["links_start", "links_start_stiff_wall", "links_middle", "sections", "hermite"];
/// Calls of forward dynamics whose median time is told.
const CALLS: usize = 50;

/// The refinements of an element.
fn refinements(element: &str) -> &'static [usize] {
    match element {
        "links_start" => &COUNTS_OF_FIRST_ORDER,
        "held_director" => &COUNTS_OF_HELD,
        "hermite" => &COUNTS_OF_SPLINES,
        _ => &COUNTS,
    }
}

/// Whether the frequency of mode k is in the law with so many elements: of coarser rods, mode 3 has other terms.
fn is_in_law(element: &str, k: usize, count: f64) -> bool {
    let waves = (2 * k + 1) as f64;
    match element {
        "links_start" => count >= 24.0,
        // The next term of mode 3 is some −4.5/n beside the first.
        "held_director" => count >= 24.0 * 2.0_f64.powi(k as i32),
        "flex_rod" => count >= 16.0,
        "hermite" => (4.0 * waves..=16.0 * waves).contains(&count),
        _ => count >= 8.0,
    }
}

/// Whether the tip of a rod of this element is compared. Shape functions are for small deflections.
fn has_tip(element: &str, count: usize) -> bool {
    element != "hermite" && count <= MOST_OF_TIPS
}

/// The cells of our elements, then of each engine's; one for an engine that is not there, so that a row says so.
pub(super) fn plan(context: &Context, engines: &[String]) -> Vec<Cell> {
    let mut cells = Vec::new();
    for name in std::iter::once(OWN).chain(engines.iter().map(String::as_str)) {
        let version = context.engine(name).map(|engine| engine.identity().version.clone()).unwrap_or_default();
        let elements = if name == OWN {
            OWN_ELEMENTS.map(str::to_owned).to_vec()
        } else {
            context.engine(name).and_then(|engine| engine.rod_solver()).map(|solver| solver.rod_elements()).unwrap_or_default()
        };
        if elements.is_empty() {
            cells.push(cell((name, &version), "none", 0));
        }
        for element in &elements {
            cells.extend(refinements(element).iter().map(|count| cell((name, &version), element, *count)));
        }
    }
    cells
}

fn cell(engine: (&str, &str), element: &str, count: usize) -> Cell {
    let params = Refinement { elements: count, forces: FORCES };
    Cell::of_case(STUDY, &format!("cantilever, n = {count}"), engine, QUANTITY, element, params)
}

/// Of each force the tip's x and y, then the frequencies, then nanoseconds of a forward dynamics and of making the rod.
pub(super) fn evaluate(asked: &Asked) -> Result<Vec<f64>, NoAnswer> {
    let cell = asked.cell;
    let missing = || NoAnswer::NotOffered(format!("{0} is not installed, or has no rods: `featherbench oracles install {0}`", cell.engine));
    let Refinement { elements: count, .. } = cell.params()?;
    let answer = if cell.engine == OWN {
        own(&cell.method, count)?
    } else {
        let solver = asked.offered(|engine| engine.rod_solver()).map_err(|_| missing())?;
        let forces = if has_tip(&cell.method, count) { FORCES.to_vec() } else { Vec::new() };
        let question = RodQuestion { count, length: 1.0, bending: 1.0, mass_per_length: 1.0, forces };
        solver.rod(&question, &cell.method)?
    };
    Ok(answer.tips.into_iter().flatten().chain(answer.frequencies).chain([answer.nanoseconds, answer.preparation]).collect())
}

/// The answer by an element of ours.
fn own(name: &str, count: usize) -> Result<RodAnswer, NoAnswer> {
    let start = Instant::now();
    let (beam, tip) = systems::cantilever(&rod()?, &element(name, count)?).map_err(failed)?;
    let (rest, zeros) = (beam.rest(), vec![0.0; beam.topology().nv()]);
    let (mut solver, mut second, mut times) = (Solver::new(&beam), zeros.clone(), Vec::with_capacity(CALLS));
    solver.forward(&beam, &rest, &zeros, &zeros, &[], &mut second).map_err(failed)?;
    let preparation = start.elapsed().as_secs_f64() * 1e9;
    let place = |force: f64| -> Result<[f64; 2], NoAnswer> {
        let load = Load::force(tip.body, tip.placement.translation, [0.0, force, 0.0]);
        let found = equilibrium(&beam, &[load], &Settings::default()).map_err(failed)?;
        if found.status != Status::Converged {
            return Err(failed(format!("the equilibrium at α = {force} is {:?}", found.status)));
        }
        let at = beam.place(&found.s, &tip).map_err(failed)?.translation;
        Ok([at.x, at.y])
    };
    let tips = if has_tip(name, count) { FORCES.into_iter().map(place).collect::<Result<Vec<_>, _>>()? } else { Vec::new() };
    let mut frequencies = modes(&beam, &rest, &[]).map_err(failed)?.frequencies();
    frequencies.truncate(MODES);
    for _ in 0..CALLS {
        let start = Instant::now();
        solver.forward(&beam, &rest, &zeros, &zeros, &[], &mut second).map_err(failed)?;
        times.push(start.elapsed().as_secs_f64() * 1e9);
    }
    times.sort_by(f64::total_cmp);
    Ok(RodAnswer { tips, frequencies, nanoseconds: times[CALLS / 2], preparation })
}

/// The law of the frequency of mode k with this element; `None` where we know none.
fn frequency_law(element: &str, k: usize) -> Option<Law> {
    let first = |prefactor| Some(Law { order: 1.0, next: 2.0, prefactor });
    let second = |prefactor| Some(Law { order: 2.0, next: 4.0, prefactor });
    match element {
        "links_middle" | "hinge_chain" => second(links_frequency_prefactor(Hinges::Middle, k)),
        "links_start_stiff_wall" => second(links_frequency_prefactor(Hinges::StartStiffWall, k)),
        "sections" | "constant_strain" => second(sections_frequency_prefactor(k)),
        "links_start" => first(links_frequency_prefactor(Hinges::Start, k)),
        // The held element makes the rod shorter by h/2.
        "held_director" => first(-links_frequency_prefactor(Hinges::Start, k)),
        "flex_rod" => second(edges_frequency_prefactor(k)),
        "hermite" => Some(Law { order: 4.0, next: 6.0, prefactor: hermite_frequency_prefactor(k) }),
        _ => None,
    }
}

/// The law of the tip under a force; `None` where we know none. The next term has twice the order: springs are a quadrature.
fn tip_law(element: &str, alpha: f64) -> Option<Law> {
    let first = |prefactor| Some(Law { order: 1.0, next: 2.0, prefactor });
    let second = |prefactor| Some(Law { order: 2.0, next: 4.0, prefactor });
    match element {
        "links_start" => first(links_tip_prefactor(Hinges::Start, alpha)),
        // The load is summed at the other end of each element.
        "held_director" => first(-links_tip_prefactor(Hinges::Start, alpha)),
        // Under larger forces the prefactor nearly vanishes, and the next term, of order 3, is seen.
        "flex_rod" if alpha < 5.0 => Some(Law { order: 2.0, next: 3.0, prefactor: edges_tip_prefactor(alpha) }),
        "links_start_stiff_wall" => second(links_tip_prefactor(Hinges::StartStiffWall, alpha)),
        "links_middle" | "hinge_chain" => second(links_tip_prefactor(Hinges::Middle, alpha)),
        "sections" | "constant_strain" => second(sections_tip_prefactor(alpha)),
        _ => None,
    }
}

/// An element of an engine over its refinements.
struct Refined<'a> {
    last: &'a Cell,
    /// Of each force, the number of elements and the signed relative error of the tip.
    tips: [Vec<(f64, f64)>; FORCES.len()],
    /// The same of each frequency.
    frequencies: [Vec<(f64, f64)>; MODES],
}

/// All rows.
pub(super) fn rows(context: &Context, finished: &[Finished]) -> Vec<Row> {
    let (mut rows, mut all): (Vec<Row>, Vec<Refined>) = (Vec::new(), Vec::new());
    for (cell, outcome) in finished.iter().filter(|(cell, _)| cell.quantity == QUANTITY) {
        let blank = blank(cell, &cell.robot, QUANTITY);
        let values = match outcome.answer() {
            Ok(values) => values,
            Err(no_answer) => {
                rows.push(unanswered(blank, &no_answer, Verdict::Info));
                continue;
            }
        };
        let count = cell.params().map_or(0, |params: Refinement| params.elements);
        let forces: &[f64] = if has_tip(&cell.method, count) { &FORCES } else { &[] };
        if values.len() != 2 * forces.len() + MODES + 2 {
            rows.push(blank.without_value(Verdict::Error, format!("{} numbers came", values.len())));
            continue;
        }
        let same = |refined: &Refined| refined.last.engine == cell.engine && refined.last.method == cell.method;
        let index = all.iter().position(same).unwrap_or_else(|| {
            all.push(Refined { last: cell, tips: Default::default(), frequencies: Default::default() });
            all.len() - 1
        });
        let (refined, (tips, rest)) = (&mut all[index], values.split_at(2 * forces.len()));
        refined.last = cell;
        for ((force, tip), series) in forces.iter().zip(tips.chunks_exact(2)).zip(&mut refined.tips) {
            let missed = tip[1] / elastica(*force).deflection - 1.0;
            series.push((count as f64, missed));
            rows.push(told(&blank, &format!("tip_error_{}", force_name(*force)), "1", "elastica").informed(missed));
        }
        for (k, (frequency, series)) in rest.iter().zip(&mut refined.frequencies).enumerate() {
            let missed = frequency / cantilever_root(k).powi(2) - 1.0;
            series.push((count as f64, missed));
            rows.push(told(&blank, &format!("frequency_error_{}", k + 1), "1", "roots").informed(missed));
        }
        for (metric, time) in ["forward_dynamics", "preparation"].into_iter().zip(&rest[MODES..]) {
            let clock = Row { kind: Kind::Measured, estimated: cell.engine != OWN, ..told(&blank, metric, "ns", "") };
            rows.push(clock.informed(*time));
        }
    }
    rows.extend(all.iter().flat_map(|refined| laws(context, refined)));
    rows.extend(agreement(context, &all));
    rows
}

/// A force in the name of a metric.
fn force_name(force: f64) -> String {
    force.to_string().replace('.', "_")
}

fn blank(cell: &Cell, family: &str, quantity: &str) -> Row {
    Row { family: family.into(), quantity: quantity.into(), ..case_row(cell) }
}

fn told(blank: &Row, metric: &str, unit: &str, reference: &str) -> Row {
    Row { metric: metric.into(), unit: unit.into(), reference: reference.into(), ..blank.clone() }
}

/// Orders and prefactors of an element.
fn laws(context: &Context, refined: &Refined) -> Vec<Row> {
    let (cell, mut rows) = (refined.last, Vec::new());
    let mut judge = |of: String, law: &Law, series: &[(f64, f64)]| {
        let blank = blank(cell, &of, "beam_law");
        let found = fit(series, law.order, law.next);
        let [order, prefactor] = law.missed(&found).map(f64::abs);
        for (metric, value) in [("order_error", order), ("prefactor_error", prefactor)] {
            rows.push(context.gates.judge(told(&blank, metric, "1", "theory"), value, 1.0));
        }
        rows.push(told(&blank, "order", "1", "").informed(found.order));
        rows.push(told(&blank, "prefactor", "1", "").informed(found.prefactor));
    };
    for (force, series) in FORCES.iter().zip(&refined.tips) {
        if let Some(law) = tip_law(&cell.method, *force) {
            // Elements of the others obey it from the coarsest on.
            let series: Vec<(f64, f64)> = series.iter().copied().filter(|(n, _)| cell.method != "flex_rod" || *n >= 16.0).collect();
            judge(format!("cantilever, α = {force}"), &law, &series);
        }
    }
    for (k, series) in refined.frequencies.iter().enumerate() {
        if let Some(law) = frequency_law(&cell.method, k) {
            let series: Vec<(f64, f64)> = series.iter().copied().filter(|(n, _)| is_in_law(&cell.method, k, *n)).collect();
            judge(format!("cantilever, mode {}", k + 1), &law, &series);
        }
    }
    rows
}

/// Engines with an element of ours have the same errors at each number of elements: the largest difference.
fn agreement(context: &Context, all: &[Refined]) -> Vec<Row> {
    let ours = |method: &str| match method {
        "hinge_chain" => Some("links_middle"),
        "constant_strain" => Some("sections"),
        _ => None,
    };
    let of = |refined: &Refined| {
        let twin = ours(&refined.last.method)?;
        let twin = all.iter().find(|other| other.last.engine == OWN && other.last.method == twin)?;
        // The mass of sections is a sum over Gauss points, of which SoRoMoX has others: their frequencies differ by a term of order h⁴.
        let same_mass = refined.last.method == "hinge_chain";
        let frequencies = refined.frequencies.iter().zip(&twin.frequencies).filter(|_| same_mass);
        let both = refined.tips.iter().zip(&twin.tips).chain(frequencies);
        let apart = both.flat_map(|(series, own)| {
            let of_same = |(n, missed): &(f64, f64)| own.iter().find(|(other, _)| other == n).map(|(_, own)| missed - own);
            series.iter().filter_map(of_same).collect::<Vec<_>>()
        });
        let row = blank(refined.last, "cantilever, same element", "beam_agreement");
        Some(context.gates.judge(told(&row, "difference", "1", OWN), largest(apart), 1.0))
    };
    all.iter().filter_map(of).collect()
}
