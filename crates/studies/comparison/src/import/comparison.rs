//! Two import results of one robot, compared body by body: a pure function of two descriptions and of the parser's notes.

use super::account::{Account, OF_MASS, Parts};
use super::align::aligned;
use super::cause::cause;
use super::fields::{self, OF_A_BODY, Precision, differs, digits};
use super::pairs::{chained, pairs};
use super::{Cause, Difference, Field};
use featherbench_bench::{FileLink, ImportNote, ImportVariant};
use featherbench_model::{BodyDescription, Description, JointType};
use std::collections::HashMap;

/// The result of a comparison.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Every difference: first missing or added bodies, then body by body in our order, then those of the whole robot.
    pub findings: Vec<SingleDifference>,
    /// Our robot without the bodies that theirs does not have as moving bodies.
    pub ours: Description,
    /// The hypotheses about the whole file that are refuted, each with the number that refutes it.
    pub refuted: Vec<String>,
    /// What their numbers are rounded to.
    pub(super) precision: Precision,
}

/// A difference, and our robot with this difference alone.
#[derive(Clone, Debug)]
pub struct SingleDifference {
    /// The difference.
    pub difference: Difference,
    /// What is another in our robot where this one field has their value; `None` if that is not the same robot any more.
    pub alone: Option<Alone>,
}

/// What is another in a robot with one difference. A robot for each difference would take memory with the square of their number.
#[derive(Clone, Debug)]
pub enum Alone {
    /// The body of this number.
    Body(usize, Box<BodyDescription>),
    /// The gravity.
    Gravity([f64; 3]),
}

impl Alone {
    /// The robot with it; `ours` is [`Comparison::ours`].
    pub fn of(&self, ours: &Description) -> Description {
        let mut robot = ours.clone();
        match self {
            Self::Body(i, body) => robot.bodies[*i].clone_from(body),
            Self::Gravity(gravity) => robot.gravity = *gravity,
        }
        robot
    }
}

impl Comparison {
    /// Compares their import result of a robot with ours. Both must be canonical. `links` are the file's links, as far as they are known.
    pub fn of(ours: &Description, theirs: &Description, links: &[FileLink], notes: &[ImportNote]) -> Self {
        Self::rounded(ours, theirs, links, notes, Precision::Double)
    }

    /// The same with an engine's numbers of this precision.
    pub fn rounded(ours: &Description, theirs: &Description, links: &[FileLink], notes: &[ImportNote], precision: Precision) -> Self {
        let (ours, theirs) = (chained(ours), chained(theirs));
        let partner = pairs(&ours, &theirs, precision);
        let gone: Vec<usize> = (0..ours.bodies.len()).filter(|&i| partner[i].is_none()).collect();
        let extra: Vec<usize> = (0..theirs.bodies.len()).filter(|j| !partner.contains(&Some(*j))).collect();
        let mut findings: Vec<SingleDifference> = extra.iter().map(|&j| added(&theirs.bodies[j])).collect();
        let names: HashMap<&str, &str> = partner
            .iter()
            .enumerate()
            .filter_map(|(i, j)| Some((ours.bodies[i].name.as_str(), theirs.bodies[(*j)?].name.as_str())))
            .collect();
        let Some(reduced) = without(&theirs, &extra, &[]) else {
            // Nothing is left that could hold a mass.
            let fixed = |i: usize| if framed(&theirs, &ours.bodies[i].name) { Mass::Kept } else { Mass::Dropped };
            findings.splice(0..0, gone.iter().map(|&i| missing(&ours.bodies[i], fixed(i), notes)));
            return Self { findings, ours, refuted: Vec::new(), precision };
        };
        // A missing body was merged into its parent, or dropped with its mass: the numbers of the other bodies show which.
        let tried = |dropped: &[usize]| {
            let left = without(&ours, &gone, dropped)?;
            let found = shared(&left, &reduced, &names, (links, notes), precision);
            let count = found.iter().filter(|finding| finding.difference.field.weight() == super::Weight::Dynamics).count();
            Some((count, dropped.to_vec(), left, found))
        };
        // A body whose parent is the world leaves its mass in no number: it is there if the engine has a frame of its name.
        let carrier = |i: usize| {
            let mut above = ours.bodies[i].parent;
            while let Some(parent) = above.filter(|parent| gone.contains(parent)) {
                above = ours.bodies[parent].parent;
            }
            above
        };
        let (rooted, carried): (Vec<usize>, Vec<usize>) = gone.iter().partition(|&&i| carrier(i).is_none());
        let unseen: Vec<usize> = rooted.into_iter().filter(|&i| !framed(&theirs, &ours.bodies[i].name)).collect();
        let all: Vec<usize> = unseen.iter().chain(&carried).copied().collect();
        let mut best = fewest(tried(&unseen), tried(&all).filter(|_| !carried.is_empty()));
        for &i in carried.iter().take(MOST_SINGLE) {
            let Some((_, dropped, ..)) = &best else { break };
            let mut other: Vec<usize> = dropped.iter().copied().filter(|&j| j != i).collect();
            if other.len() == dropped.len() {
                other.push(i);
            }
            let other = tried(&other);
            best = fewest(best, other);
        }
        let (_, dropped, left, found) = best.unwrap_or_else(|| (0, Vec::new(), ours.clone(), Vec::new()));
        // Kept or dropped is said if the numbers of what carries it are those of one of the two.
        let proved = |i: usize| {
            let Some(above) = carrier(i) else { return true };
            let of_mass = |finding: &SingleDifference| {
                finding.difference.body == ours.bodies[above].name
                    && OF_MASS.contains(&finding.difference.field)
                    && finding.difference.cause == Cause::Number
            };
            !found.iter().any(of_mass)
        };
        let fate = |i: usize| match (proved(i), dropped.contains(&i)) {
            (false, _) => Mass::Unknown,
            (true, true) => Mass::Dropped,
            (true, false) => Mass::Kept,
        };
        findings.splice(0..0, gone.iter().map(|&i| missing(&ours.bodies[i], fate(i), notes)).collect::<Vec<_>>());
        findings.extend(found);
        Self { findings, ours: left, refuted: Vec::new(), precision }
    }

    /// The same with what is known of the whole file: what it would be if one thing were read otherwise, and the check after loading.
    #[must_use]
    pub fn explained_by(mut self, ours: &Description, theirs: &Description, variants: &[ImportVariant], notes: &[ImportNote]) -> Self {
        self.refuted = super::variants::explain(&mut self, ours, theirs, variants);
        super::variants::unsound(&mut self, ours, notes);
        self
    }

    /// Whether a difference is of what enters the dynamics: only then a variant can be named.
    pub(super) fn is_of_dynamics(&self) -> bool {
        self.differences().any(|difference| difference.field.weight() == super::Weight::Dynamics)
    }

    /// The differences alone.
    pub fn differences(&self) -> impl Iterator<Item = &Difference> {
        self.findings.iter().map(|finding| &finding.difference)
    }
}

/// A hypothesis about missing bodies: the number of differences of what is left, the bodies that are dropped, what is left, its differences.
type Hypothesis = (usize, Vec<usize>, Description, Vec<SingleDifference>);

/// The hypothesis with fewer differences; the first of equals.
fn fewest(a: Option<Hypothesis>, b: Option<Hypothesis>) -> Option<Hypothesis> {
    match (&a, &b) {
        (Some(x), Some(y)) if y.0 < x.0 => b,
        (None, _) => b,
        _ => a,
    }
}

/// Missing bodies of which each is tried by itself. Each trial compares whole robots.
const MOST_SINGLE: usize = 16;

/// What happened to the mass of a body that no longer moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mass {
    Kept,
    Dropped,
    /// The body that carries it has neither the sum nor its own mass.
    Unknown,
}

/// Whether a robot has a frame of this name.
fn framed(description: &Description, name: &str) -> bool {
    description.frames.iter().any(|frame| frame.name == name)
}

/// The robot with some bodies fixed to their parents, of which some are dropped with their mass, if any body still moves.
fn without(description: &Description, gone: &[usize], dropped: &[usize]) -> Option<Description> {
    let mut reduced = description.clone();
    for &i in gone {
        let body = &mut reduced.bodies[i];
        body.joint =
            featherbench_model::JointDescription { name: body.joint.name.clone(), placement: body.joint.placement, ..Default::default() };
        if dropped.contains(&i) {
            (body.mass, body.inertia) = (0.0, [0.0; 6]);
        }
    }
    reduced.canonical().ok()
}

fn missing(body: &BodyDescription, mass: Mass, notes: &[ImportNote]) -> SingleDifference {
    let (cause, theirs) = match mass {
        Mass::Kept => (Cause::Merged, "fixed to its parent"),
        Mass::Dropped => (Cause::Dropped, super::variants::LOST),
        Mass::Unknown => (Cause::Number, "none, and its mass is not found where it would be"),
    };
    let ours = format!("{} joint '{}'", body.joint.kind.name(), body.joint.name);
    let mut finding = whole(&body.name, Field::Body, ours, theirs.into(), cause);
    let root = body.parent.is_none();
    let about = |note: &&ImportNote| match note.cause.as_str() {
        "root_welded" => root,
        "mimic" | "fused" => note.about.as_deref().is_some_and(|name| name == body.name || name == body.joint.name),
        _ => false,
    };
    finding.difference.note = notes.iter().find(about).map(|note| note.text.clone());
    finding
}

fn added(body: &BodyDescription) -> SingleDifference {
    let theirs = format!("{} joint '{}', {} kg", body.joint.kind.name(), body.joint.name, digits(body.mass, 0.0));
    whole(&body.name, Field::Body, "none".into(), theirs, Cause::Added)
}

/// A difference of a kind that has no number: its size is one.
fn whole(body: &str, field: Field, ours: String, theirs: String, cause: Cause) -> SingleDifference {
    SingleDifference {
        difference: Difference { body: body.to_owned(), field, ours, theirs, size: 1.0, cause, account: None, note: None },
        alone: None,
    }
}

/// The differences of two robots with the same bodies; `names` maps our names to theirs.
fn shared(
    ours: &Description,
    theirs: &Description,
    names: &HashMap<&str, &str>,
    (links, notes): (&[FileLink], &[ImportNote]),
    precision: Precision,
) -> Vec<SingleDifference> {
    let place: HashMap<&str, usize> = theirs.bodies.iter().enumerate().map(|(j, body)| (body.name.as_str(), j)).collect();
    let partner: Vec<Option<usize>> =
        ours.bodies.iter().map(|body| names.get(body.name.as_str()).and_then(|name| place.get(name)).copied()).collect();
    let reach = fields::reach(ours).max(fields::reach(theirs));
    let written = aligned(ours, theirs, &partner, reach, precision);
    let told = Notes::new(ours, notes);
    let mut findings = Vec::new();
    for (i, body) in ours.bodies.iter().enumerate() {
        let (Some(aligned), Some(j)) = (&written[i], partner[i]) else { continue };
        let above = ours.bodies[i].parent.and_then(|parent| partner[parent]);
        if above != theirs.bodies[j].parent {
            let name =
                |description: &Description, parent: Option<usize>| parent.map_or("world".into(), |p| description.bodies[p].name.clone());
            let (a, b) = (name(ours, body.parent), name(theirs, theirs.bodies[j].parent));
            findings.push(whole(&body.name, Field::Parent, a, b, Cause::Number));
        }
        let rounding = fields::rounding(ours, i, precision);
        let different: Vec<(Field, f64)> = OF_A_BODY
            .into_iter()
            .map(|field| (field, fields::size(field, body, aligned, reach)))
            .filter(|&(_, size)| differs(size, rounding))
            .collect();
        if different.is_empty() {
            continue;
        }
        let about = told.about(i, [body, &theirs.bodies[j]]);
        // One edit of the links may account for all fields; otherwise each field is explained alone.
        let of_mass = different.iter().any(|(field, _)| OF_MASS.contains(field));
        let parts = of_mass.then(|| Parts::new(ours, i, links, &about, reach, precision));
        let whole = parts.as_ref().and_then(|parts| parts.account(aligned, &OF_MASS));
        for (field, size) in different {
            let alone = || parts.as_ref().and_then(|parts| parts.account(aligned, &[field]));
            let account = if OF_MASS.contains(&field) { whole.clone().or_else(alone) } else { None };
            findings.push(finding(ours, i, aligned, (field, size), account, (&about, precision)));
        }
    }
    super::context::explain(ours, (theirs, &partner), &written, &mut findings, reach, precision);
    findings.extend(mimics(ours, notes));
    findings.extend(gravity(ours, theirs, precision));
    findings.extend(order(ours, &partner));
    findings
}

fn finding(
    ours: &Description,
    i: usize,
    aligned: &BodyDescription,
    (field, size): (Field, f64),
    account: Option<Account>,
    (notes, precision): (&[&ImportNote], Precision),
) -> SingleDifference {
    let body = &ours.bodies[i];
    let (untested, note) = cause(field, body, aligned, notes, precision);
    let (cause, account) = account.map_or((untested, None), |account| (account.cause, Some(account.text)));
    let [a, b] = [body, aligned].map(|body| fields::written(field, body, size));
    let difference = Difference { body: body.name.clone(), field, ours: a, theirs: b, size, cause, account, note };
    // Other coordinates, or none: that is not this robot with one number changed.
    let comparable = field != Field::JointType || body.joint.kind.nv() == aligned.joint.kind.nv();
    let alone = comparable.then(|| {
        let mut alone = body.clone();
        fields::copy(field, aligned, &mut alone);
        Alone::Body(i, Box::new(alone))
    });
    SingleDifference { difference, alone }
}

/// The parser's notes by what they are about, and the frames of each body: files have thousands of both.
struct Notes<'a> {
    notes: &'a [ImportNote],
    of_all: Vec<usize>,
    by_name: HashMap<&'a str, Vec<usize>>,
    frames: HashMap<usize, Vec<&'a str>>,
}

impl<'a> Notes<'a> {
    fn new(ours: &'a Description, notes: &'a [ImportNote]) -> Self {
        let (mut of_all, mut by_name, mut frames) = (Vec::new(), HashMap::<_, Vec<_>>::new(), HashMap::<_, Vec<_>>::new());
        for (k, note) in notes.iter().enumerate() {
            match &note.about {
                Some(name) => by_name.entry(name.as_str()).or_default().push(k),
                None => of_all.push(k),
            }
        }
        for frame in &ours.frames {
            if let Some(body) = frame.body {
                frames.entry(body).or_default().push(frame.name.as_str());
            }
        }
        Self { notes, of_all, by_name, frames }
    }

    /// The notes about body `i`: about its link, its joint or the links that are fixed to it, or about the whole file; in their order.
    fn about(&self, i: usize, pair: [&BodyDescription; 2]) -> Vec<&'a ImportNote> {
        let own = pair.into_iter().flat_map(|body| [body.name.as_str(), body.joint.name.as_str()]);
        let names = own.chain(self.frames.get(&i).into_iter().flatten().copied());
        let mut found = self.of_all.clone();
        found.extend(names.filter_map(|name| self.by_name.get(name)).flatten());
        found.sort_unstable();
        found.dedup();
        found.into_iter().map(|k| &self.notes[k]).collect()
    }
}

/// The joints that follow another one in the file, and not in the engine: by its usual way of reading it computes other physics. That of the
/// tree is compared without mimics, so the reduced dynamics GᵀMG and Gᵀh of an engine that ties them as written follow from it.
fn mimics(ours: &Description, notes: &[ImportNote]) -> impl Iterator<Item = SingleDifference> {
    notes.iter().filter(|note| ["mimic_dropped", "mimic_otherwise"].contains(&note.cause.as_str())).map(|note| {
        let joint = note.about.as_deref().unwrap_or_default();
        let body = ours.bodies.iter().find(|body| body.joint.name == joint).map_or(joint, |body| &body.name);
        let theirs = if note.cause == "mimic_dropped" { "a joint of its own" } else { "tied otherwise" };
        let mut finding = whole(body, Field::Mimic, "follows another joint".into(), theirs.into(), Cause::Mimic);
        finding.difference.account = Some(format!("joint '{joint}': {}", note.text));
        finding
    })
}

fn gravity(ours: &Description, theirs: &Description, precision: Precision) -> Option<SingleDifference> {
    let far = fields::norm(ours.gravity).max(fields::norm(theirs.gravity));
    let size = featherbench_bench::measure::ratio(fields::distance(ours.gravity, theirs.gravity), far);
    let text = |g: [f64; 3]| format!("({}) m/s²", g.map(|x| digits(x, size)).join(", "));
    differs(size, precision.rounding()).then(|| {
        let mut finding = whole("", Field::Gravity, text(ours.gravity), text(theirs.gravity), Cause::Number);
        finding.difference.size = size;
        finding.alone = Some(Alone::Gravity(theirs.gravity));
        finding
    })
}

/// A joint by what the file names: import results call joints and bodies without a name by kind and number, which are not in the file.
fn in_file(body: &BodyDescription) -> String {
    let numbered = |name: &str, kind: &str| name.strip_prefix(kind).is_some_and(|rest| rest.trim_start().parse::<usize>().is_ok());
    let (joint, body) = (&body.joint.name, &body.name);
    match (joint.is_empty() || numbered(joint, "joint "), numbered(body, "body ")) {
        (false, _) => joint.clone(),
        (true, false) => format!("that of {body}"),
        (true, true) => format!("that of the file's {body}, which has no name"),
    }
}

/// A difference in the order of joints, described from the first to the last that is elsewhere.
fn order(ours: &Description, partner: &[Option<usize>]) -> Option<SingleDifference> {
    let mut sorted: Vec<(usize, usize)> = partner.iter().enumerate().filter_map(|(i, j)| Some(((*j)?, i))).collect();
    let own: Vec<usize> = sorted.iter().map(|&(_, i)| i).collect();
    sorted.sort_unstable();
    let theirs: Vec<usize> = sorted.into_iter().map(|(_, i)| i).collect();
    let moved = own.iter().zip(&theirs).filter(|(a, b)| a != b).count();
    let (first, last) = (own.iter().zip(&theirs).position(|(a, b)| a != b)?, own.iter().zip(&theirs).rposition(|(a, b)| a != b)?);
    let text = |list: &[usize]| {
        let name = |&i: &usize| in_file(&ours.bodies[i]);
        list[first..=last].iter().map(name).collect::<Vec<_>>().join(", ")
    };
    let mut finding = whole("", Field::DofOrder, text(&own), text(&theirs), Cause::Order);
    finding.difference.size = moved as f64 / own.len() as f64;
    Some(finding)
}

/// The degrees of freedom of the bodies that both robots have with the same joint: (first of ours, first of theirs, how many). And the same
/// of the coordinates.
pub(super) struct Shared {
    pub dofs: Vec<[usize; 3]>,
    pub coordinates: Vec<[usize; 3]>,
}

/// What two robots share.
pub(super) fn shared_coordinates(ours: &Description, theirs: &Description) -> Shared {
    let (ours, theirs) = (chained(ours), chained(theirs));
    let starts = |description: &Description, count: fn(JointType) -> usize| -> Vec<usize> {
        let running = description.bodies.iter().scan(0, |next, body| {
            let start = *next;
            *next += count(body.joint.kind);
            Some(start)
        });
        running.collect()
    };
    let shared = |count: fn(JointType) -> usize| {
        let (from, to) = (starts(&ours, count), starts(&theirs, count));
        let partners = pairs(&ours, &theirs, Precision::Double).into_iter().enumerate().filter_map(|(i, j)| Some((i, j?)));
        let alike = partners.filter(|&(i, j)| {
            let [a, b] = [ours.bodies[i].joint.kind, theirs.bodies[j].joint.kind];
            a.nq() == b.nq() && a.nv() == b.nv()
        });
        alike.map(|(i, j)| [from[i], to[j], count(ours.bodies[i].joint.kind)]).collect()
    };
    Shared { dofs: shared(JointType::nv), coordinates: shared(JointType::nq) }
}
