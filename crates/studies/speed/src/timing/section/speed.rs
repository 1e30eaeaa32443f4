//! Section: the speed of the engines compared with each other and with the machine's peak, and whether the machine was quiet.

use featherbench_bench::BATCH;
use featherbench_bench::statistics::VOID;
use featherbench_report::numbers::{capitalised, count, short};
use featherbench_report::{Overview, Part, labels};
use featherbench_results::RunInfo;
use maud::{Markup, html};

use super::best::{self, Best};
use super::drawings;
use super::ratios::{Limit, OPERATIONS, Ratio, Speed};

/// The input of each quantity's time, and the work inside the clock.
const INCLUDED: [(&str, &str, &str); 10] = [
    ("id", "q, q̇, q̈", "kinematics with sines and cosines, the recursion to τ; rotors' inertia, gravity"),
    ("bias", "q, q̇", "as inverse dynamics with q̈ = 0"),
    ("mass_matrix_sparse", "q", "kinematics with sines and cosines, every stored entry of M; rotors' inertia"),
    (
        "fd",
        "q, q̇, τ",
        "kinematics with sines and cosines, and everything down to q̈: articulated bodies, or M, its factors, the bias force and a solve",
    ),
    ("factorization", "M, made before", "the factors alone"),
    ("solve", "factors of M, made before, and τ", "the substitutions alone"),
    (
        "mass_matrix_inverse",
        "q",
        "kinematics with sines and cosines, M or articulated bodies, and every entry of M⁻¹ or of its upper triangle",
    ),
    ("momentum", "q, q̇", "kinematics with sines and cosines, the centre of mass, and the momentum about it"),
    ("body_acceleration", "q, q̇, q̈", "kinematics with sines and cosines: placements, velocities and accelerations of all bodies"),
    ("body_jacobian", "q", "kinematics, and the columns of one body's Jacobian in world axes"),
];

/// The number of reasons, why times do not count, that the page lists.
const REASONS: usize = 12;

/// Writes the section, and the drawings that it does not show at first.
pub fn markup(run: &RunInfo, disturbed: Option<&str>, overview: &Overview, speed: &Speed, best: &[Best]) -> (Markup, Vec<Part>) {
    let (drawn, parts) = drawings::ratios(overview, speed);
    let body = html! {
        section #speed {
            h2 { "Speed, side by side" }
            p.lead {
                "The time of each candidate over that of our usual method, for the same answer: lower deciles of a paired experiment, in which all stand in "
                "alternating blocks on one core. Bars are 95 % intervals, by the scatter over processes. Above 1 ours is faster, below 1 the other."
            }
            (missing(run))
            @if let Some(disturbed) = disturbed { p.warning { (disturbed) } }
            @if !speed.ratios.is_empty() {
                (drawn)
                p.note { "Grey: ± 2 %, within which this experiment calls nothing a difference. Hollow marks do not count: see below." }
                (estimates(overview, speed))
                (batches(speed))
            }
            (best::table(overview, best))
            @if !speed.ratios.is_empty() {
                (summary(overview, speed))
                (table(overview, speed))
            }
            (limits(overview, speed))
            (controls(overview, speed))
            (included(speed))
        }
    };
    (body, parts)
}

/// Native oracles that should have been timed and are missing.
fn missing(run: &RunInfo) -> Markup {
    let missing: Vec<_> = run.engines.iter().filter(|engine| engine.status != "ok").collect();
    html! {
        @if !missing.is_empty() {
            p.warning { "Not timed: " @for (index, engine) in missing.iter().enumerate() { @if index > 0 { "; " } b { (engine.name) } " (" (engine.reason) ")" } "." }
        }
    }
}

/// The meaning of ≈, if something is estimated.
fn estimates(overview: &Overview, speed: &Speed) -> Markup {
    let mut engines: Vec<&str> = speed.ratios.iter().filter(|ratio| ratio.estimated).map(|ratio| overview.engines[ratio.engine]).collect();
    engines.sort_unstable();
    engines.dedup();
    html! {
        @if !engines.is_empty() {
            p.note #speed-estimates {
                "≈ and crosses: estimates. " (engines.join(" and ")) " are called through Python; what calling takes is measured by the same calls on a robot without bodies, and subtracted. "
                "Where that was held against the engines' own libraries, estimates were too long, never too short (guide/studies/timing.md, \"Limits\", says by how much): an engine is rather faster than its estimate says. "
                "Rows " code { "overhead_ns" } " hold what was subtracted from each call."
            }
        }
    }
}

/// What a batch is, if one is timed.
fn batches(speed: &Speed) -> Markup {
    html! {
        @if speed.ratios.iter().any(Ratio::is_batch) {
            p.note #speed-batch {
                b { (capitalised(labels::method(BATCH))) } ": our kernels with one state in each lane of a register, on the same core. A time is that of many states over their number, with the copies into lanes and out of them. "
                "It is the throughput where many states are known at once, as in sampling and learning. One state alone takes as long as a whole register."
            }
        }
    }
}

/// `≈` before an estimate.
fn mark(estimated: bool) -> &'static str {
    if estimated { "≈\u{202f}" } else { "" }
}

fn summary(overview: &Overview, speed: &Speed) -> Markup {
    let lines = speed.summaries();
    html! {
        h3 { "Over the robots" }
        @if lines.is_empty() {
            p.empty #speed-none-valid { "No ratio counts (the reasons stand below): there is no mean. The suite timing has the rounds that this takes." }
        } @else { div.scroll {
            table.compact.sortable #speed-summary {
                thead {
                    tr {
                        th scope="col" { "compute" } th scope="col" { "inputs" } th scope="col" { "who" } th scope="col" { "beside" } th.number scope="col" { "robots" }
                        th.number scope="col" { "geometric mean" } th.number scope="col" { "least" } th scope="col" { "on" } th.number scope="col" { "largest" } th scope="col" { "on" }
                    }
                }
                tbody {
                    @for line in &lines {
                        tr {
                            th scope="row" { (labels::quantity(line.of.quantity)) }
                            td { (line.of.cache) }
                            td { (overview.engines[line.of.engine]) " " small { (line.of.way()) } }
                            td { (line.of.reference) }
                            td.number { (line.count) }
                            td.number { (mark(line.of.estimated)) (times(line.mean)) }
                            td.number { (mark(line.of.estimated)) (times(line.least.0)) }
                            td { (overview.robots[line.least.1].name) }
                            td.number { (mark(line.of.estimated)) (times(line.largest.0)) }
                            td { (overview.robots[line.largest.1].name) }
                        }
                    }
                }
            }
        } }
    }
}

fn table(overview: &Overview, speed: &Speed) -> Markup {
    html! {
        details {
            summary { "Every robot: " (count(speed.ratios.len(), "ratio")) }
            div.scroll.tall {
                table.compact.sortable {
                    thead {
                        tr {
                            th scope="col" { "robot" } th scope="col" { "compute" } th scope="col" { "inputs" } th scope="col" { "who" } th scope="col" { "beside" }
                            th.number scope="col" { "ratio" } th.number scope="col" { "from" } th.number scope="col" { "to" } th scope="col" { "counts" }
                        }
                    }
                    tbody {
                        @for ratio in &speed.ratios {
                            tr {
                                th scope="row" { (overview.robots[ratio.robot].name) }
                                td { (labels::quantity(ratio.quantity)) }
                                td { (ratio.cache) }
                                td { (overview.engines[ratio.engine]) " " small { (ratio.way()) } }
                                td { (ratio.reference) }
                                td.number { (mark(ratio.estimated)) (times(ratio.value)) }
                                td.number { (mark(ratio.estimated)) (times(ratio.low)) }
                                td.number { (mark(ratio.estimated)) (times(ratio.high)) }
                                td { @if ratio.valid { "yes" } @else { "no" } }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Of each engine, robot and quantity the least time per joint.
fn fastest<'l, 'a>(limits: &'l [Limit<'a>]) -> Vec<&'l Limit<'a>> {
    let mut fastest: Vec<&Limit> = Vec::new();
    for limit in limits {
        let same = |other: &&mut &Limit| (other.robot, other.engine, other.quantity) == (limit.robot, limit.engine, limit.quantity);
        match fastest.iter_mut().find(same) {
            Some(known) if limit.per_joint < known.per_joint => *known = limit,
            Some(_) => {}
            None => fastest.push(limit),
        }
    }
    fastest
}

fn limits(overview: &Overview, speed: &Speed) -> Markup {
    html! {
        @if let Some(machine) = speed.machine {
            h3 { "Beside what the machine can do" }
            p.note {
                "This core makes " (short(machine.vector)) " multiply-adds of doubles per nanosecond in full vectors, " (short(machine.lane)) " in each lane. "
                @for (index, (_, algorithm, operations)) in OPERATIONS.iter().enumerate() {
                    @if index > 0 { "; " } (algorithm) " needs " (operations) " operations per revolute joint: " (short(operations / machine.vector)) " ns in full vectors, " (short(operations / machine.lane)) " ns in one lane"
                }
                ". Other joints need other numbers, sines and cosines come on top."
                @if let (Some(clock), Some(empty)) = (machine.clock, machine.empty) { " The clock's step is " (short(clock)) " ns, a call that computes nothing takes " (short(empty)) " ns." }
            }
            @if let Some(reason) = &speed.no_limits {
                p #speed-no-limits { b { "No time is set beside the limit." } " The peak does not count: " (reason) "." }
            }
            @if !speed.limits.is_empty() {
                details {
                    summary { "Nanoseconds per joint, of each engine's fastest method" }
                    div.scroll.tall {
                        table.compact.sortable {
                            thead {
                                tr {
                                    th scope="col" { "robot" } th scope="col" { "compute" } th scope="col" { "inputs" } th scope="col" { "who" }
                                    th.number scope="col" { "ns per joint" } th.number scope="col" { "limit" } th.number scope="col" { "times the limit" }
                                }
                            }
                            tbody {
                                @for limit in fastest(&speed.limits) {
                                    tr {
                                        th scope="row" { (overview.robots[limit.robot].name) }
                                        td { (labels::quantity(limit.quantity)) }
                                        td { (limit.cache) }
                                        td { (overview.engines[limit.engine]) " " small { (limit.method) } }
                                        td.number { (mark(limit.estimated)) (short(limit.per_joint)) }
                                        td.number { (short(limit.least)) }
                                        td.number { (mark(limit.estimated)) (times(limit.per_joint / limit.least)) }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn controls(overview: &Overview, speed: &Speed) -> Markup {
    let invalid: usize = speed.invalid.values().sum();
    let good = speed.controls.iter().filter(|control| control.valid).count();
    let missing: Vec<&Ratio> = speed.controls.iter().filter(|control| !control.valid || control.low > 1.0 || control.high < 1.0).collect();
    html! {
        @if !speed.controls.is_empty() {
            h3 { "Was the machine quiet?" }
            p {
                "In every experiment a second copy of our usual method stands among the others. "
                b { (good) " of " (count(speed.controls.len(), "such A/A control")) } " lie within ± " (format!("{:.0} %", 100.0 * VOID)) ". One that misses 1 widens the intervals beside it. "
                @if invalid > 0 { "Where one does not, or the core was at its fastest in too few processes, no time of its experiment counts; where more than a quarter of a robot's do not, none of its times does: " b { (count(invalid, "row")) } "." }
                @else { "Every time counts." }
            }
            @if invalid > 0 {
                ul.findings #speed-invalid { @for (reason, rows) in speed.invalid.iter().take(REASONS) { li.known { (reason) " " span.number { "(" (count(*rows, "row")) ")" } } } }
                @if speed.invalid.len() > REASONS { p.note { "And " (count(speed.invalid.len() - REASONS, "more reason")) " in the rows." } }
            }
            @if !missing.is_empty() { details {
                summary { (count(missing.len(), "A/A control")) " whose interval misses 1" }
                div.scroll.tall {
                    table.compact.sortable #speed-controls {
                        thead {
                            tr {
                                th scope="col" { "robot" } th scope="col" { "compute" } th scope="col" { "inputs" }
                                th.number scope="col" { "second over first copy" } th.number scope="col" { "from" } th.number scope="col" { "to" } th scope="col" { "" }
                            }
                        }
                        tbody {
                            @for control in missing {
                                tr {
                                    th scope="row" { (overview.robots[control.robot].name) }
                                    td { (labels::quantity(control.quantity)) }
                                    td { (control.cache) }
                                    td.number { (format!("{:.4}", control.value)) }
                                    td.number { (format!("{:.4}", control.low)) }
                                    td.number { (format!("{:.4}", control.high)) }
                                    td { @if control.valid { "widens" } @else { span.badge.deviation { "≈ does not count" } } }
                                }
                            }
                        }
                    }
                }
            } }
        }
    }
}

fn included(speed: &Speed) -> Markup {
    let timed = |quantity: &str| speed.ratios.iter().chain(&speed.controls).any(|ratio| ratio.quantity == quantity);
    html! {
        @if INCLUDED.iter().any(|(quantity, ..)| timed(quantity)) {
            details {
                summary { "What each number includes" }
                p.note {
                    "For each candidate: the robot is loaded at run time, no result is carried from one state to the next, and the answer ends in the engine's own storage. Converting coordinates of states and "
                    "answers is outside the clock. Each answer is compared with ours at every state of the stream before its time counts; a candidate without an answer, or with a wrong one, is a row with the reason. "
                    "Every block of every round is in " a href="timing.jsonl" { "timing.jsonl" } "."
                }
                div.scroll {
                    table.compact {
                        thead { tr { th scope="col" { "compute" } th scope="col" { "from" } th scope="col" { "inside the clock" } } }
                        tbody {
                            @for (quantity, from, inside) in INCLUDED.iter().filter(|(quantity, ..)| timed(quantity)) {
                                tr { th scope="row" { (labels::quantity(quantity)) } td { (from) } td { (inside) } }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// A ratio with the digits that its interval allows.
pub fn times(ratio: f64) -> String {
    if ratio >= 100.0 {
        format!("{ratio:.0}")
    } else if ratio >= 10.0 {
        format!("{ratio:.1}")
    } else {
        format!("{ratio:.3}")
    }
}
