//! Section: a page to read beside the lesson. What it says, what is right, and the number between.

use super::{CORRECTED, LESSON, STUDY, pipeline};
use featherbench_lesson::pipeline::STAGES;
use featherbench_lesson::{Claim, claims};
use featherbench_report::figure::{Axis, Series, Style};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section, opener};
use featherbench_results::{Row, RunInfo};
use featherbench_study::figures::{drawing, errors, point, told};
use featherbench_study::known::{passed, value};
use featherbench_study::rows_of;
use maud::{Markup, html};

/// A share of the right value below which the lesson's is the same.
const SAME: f64 = 1e-9;

/// Of each robot its name, and of each stage its name with the errors on the unseen motion and on the log.
type Stages<'a> = Vec<(&'a str, Vec<(&'a str, f64, f64)>)>;

/// A number that the lesson gives, with the right one.
struct Pair<'a> {
    row: &'a Row,
    lesson: f64,
    right: f64,
}

impl Pair<'_> {
    fn off_by(&self) -> f64 {
        self.lesson - self.right
    }

    /// The distance over the right value, or over one where that is zero. NaN is far.
    fn relative(&self) -> f64 {
        let apart = (self.off_by() / if self.right == 0.0 { 1.0 } else { self.right }).abs();
        if apart.is_nan() { f64::INFINITY } else { apart }
    }
}

/// A claim with the rows of a run.
struct Decided<'a> {
    claim: Claim,
    pairs: Vec<Pair<'a>>,
}

impl<'a> Decided<'a> {
    fn holds(&self) -> &'static str {
        let right = self.pairs.iter().filter(|pair| pair.relative() <= SAME).count();
        match (right, self.pairs.len()) {
            (_, 0) => "added",
            (right, all) if right == all => "holds",
            (0, _) => "does not hold",
            _ => "in part",
        }
    }

    /// The number where the lesson is farthest from what is right.
    fn farthest(&self) -> Option<&Pair<'a>> {
        self.pairs.iter().max_by(|a, b| a.relative().total_cmp(&b.relative()))
    }
}

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let Some((rows, chunk)) = rows_of(rows, STUDY, overview) else { return Vec::new() };
    vec![Section::new("lesson", "Lesson", body(&rows, &chunk))]
}

fn stages<'a>(rows: &[&'a Row]) -> Stages<'a> {
    let of = |(name, ..): (&'static str, _, _)| {
        let points = STAGES.into_iter().filter_map(|stage| {
            let at = |metric| value(rows, pipeline::QUANTITY, name, stage, metric);
            Some((stage, at("held_out")?, at("logged")?))
        });
        (name, points.collect())
    };
    pipeline::settings().into_iter().map(of).collect()
}

/// The error of each stage of the pipeline on a motion that none has seen, and on the log.
fn drawn(settings: &Stages) -> Markup {
    let mut series = Vec::new();
    for (index, (name, stages)) in settings.iter().enumerate() {
        for (motion, dash) in [("unseen motion", 0), ("log", 1)] {
            let points = stages.iter().enumerate().map(|(at, &(stage, unseen, logged))| {
                let error = if dash == 0 { unseen } else { logged };
                point(stage, at as f64, error, [format!("{motion}: {}", told(error))])
            });
            series.push(Series { dash, ..Series::new(format!("{name}: {motion}"), Style::nth(index), points.collect()) });
        }
    }
    let names = settings.first().map(|(_, stages)| stages.iter().map(|(stage, ..)| (*stage).to_owned()).collect()).unwrap_or_default();
    drawing("lesson-stages", "Error of each stage of the pipeline", Axis::named("stage", names), errors("‖τ − τ̂‖/‖τ‖"), series)
}

/// The claims that the run has rows of.
fn decided<'a>(rows: &[&'a Row]) -> Vec<Decided<'a>> {
    let of = |claim: Claim| {
        let own: Vec<&'a Row> = rows.iter().filter(|row| row.quantity == claim.id && row.metric == "value").copied().collect();
        let stated = own.iter().filter(|row| row.method == LESSON);
        let pair = |row: &&'a Row| {
            let right = own.iter().find(|other| other.method == CORRECTED && other.family == row.family)?;
            Some(Pair { row, lesson: row.value?, right: right.value? })
        };
        (!own.is_empty()).then(|| Decided { claim, pairs: stated.filter_map(pair).collect() })
    };
    claims::all().into_iter().filter_map(of).collect()
}

fn body(rows: &[&Row], chunk: &str) -> Markup {
    let (passed, judged) = passed(rows);
    let decided = decided(rows);
    let count = |word: &str| decided.iter().filter(|one| one.holds() == word).count();
    html! {
        section #lesson {
            h2 { "The lesson, decided by numbers" }
            p.lead {
                b { "Of " (decided.len() - count("added")) " statements of the lesson " (count("holds")) " hold, " (count("in part")) " hold in part, and "
                (count("does not hold")) " do not." } " " (passed) " of " (judged) " judged numbers are as known."
            }
            (findings(rows))
            (drawn(&stages(rows)))
            p.note {
                "Problem 5 as a program: the error ‖τ − τ̂‖/‖τ‖ on a motion that no stage has seen. "
                (opener(chunk, &[("study", STUDY), ("quantity", pipeline::QUANTITY)], "Rows of the pipeline"))
            }
            (table(&decided, chunk))
        }
    }
}

fn findings(rows: &[&Row]) -> Markup {
    let both = |quantity: &str, name: &str| {
        let of = |method| value(rows, quantity, name, method, "value");
        Some((of(LESSON)?, of(CORRECTED)?))
    };
    let stage = |stage: &str| value(rows, pipeline::QUANTITY, "without noise", stage, "held_out");
    html! {
        ul {
            @if let Some((lesson, right)) = both("residual_torque", "torque of joint 1") {
                li { "The labs subtract the residual that their definition adds: a torque of " (short(lesson)) " N·m instead of " (short(right)) " N·m." }
            }
            @if let Some((lesson, right)) = both("jump_law", "∂v/∂x₀") {
                li { "The jump of sensitivities leaves out that the impact's time moves: ∂v/∂x₀ of a bouncing ball is " (short(right)) ", and not " (short(lesson)) "." }
            }
            @if let Some((lesson, right)) = both("arm_accelerations", "acceleration of joint 1, uniform rods") {
                li { "The symbolic arm's energies belong to no body: " (short(lesson)) " rad/s², where rods have " (short(right)) "." }
            }
            @if let (Some(apart), Some(together)) = (stage("residual"), stage("together")) {
                li {
                    "A residual fitted after the parameters cannot repair their bias: " (short(apart)) " is left without any noise. Fitted together, "
                    (short(together)) " is."
                }
            }
        }
    }
}

fn table(decided: &[Decided], chunk: &str) -> Markup {
    html! {
        div.scroll {
            table.compact {
                thead {
                    tr {
                        th scope="col" { "where" } th scope="col" { "about" } th scope="col" { "the lesson says" } th scope="col" { "it" } th scope="col" { "right is" }
                        th scope="col" { "the number" } th.number scope="col" { "lesson" } th.number scope="col" { "right" }
                    }
                }
                tbody { @for one in decided { (line(one, chunk)) } }
            }
        }
    }
}

fn line(one: &Decided, chunk: &str) -> Markup {
    let holds = one.holds();
    let class = if holds == "holds" {
        "pass"
    } else if holds == "added" {
        "info"
    } else {
        "deviation"
    };
    html! {
        tr {
            td { (one.claim.place) }
            th scope="row" { (opener(chunk, &[("study", STUDY), ("quantity", one.claim.id)], one.claim.title)) }
            td { (one.claim.says) }
            td { span class={ "badge " (class) } { (holds) } }
            td { (one.claim.right) }
            @if let Some(pair) = one.farthest() {
                td { (pair.row.family) @if pair.row.unit != "1" { ", " (pair.row.unit) } }
                td.number { (short(pair.lesson)) }
                td.number { (short(pair.right)) }
            } @else { td {} td {} td {} }
        }
    }
}
