//! Accounts of mass properties: a parser's edit of the links of a body, as a hypothesis that predicts the body's numbers.
//!
//! A hypothesis is a rule for a link: the link after the edit, if the rule applies. The rule is applied to the links of the body, these are
//! merged again, and the result is compared with the engine's body. A cause is named if mass, centre of mass and inertia all agree within
//! the rounding of the fields. If not, each field is tried alone, as several edits may have changed one body. Otherwise there is no
//! account.

use super::fields::{self, Precision, differs};
use super::{Cause, Field};
use featherbench_bench::{FileInertial, FileLink, ImportNote, WATER};
use featherbench_model::{BodyDescription, Description, Placement};
use featherbench_spatial::{Mat3, RigidBodyInertia, Sym3, Transform, Vec3};
use nalgebra::{Matrix3, SymmetricEigen};
use std::f64::consts::PI;

/// The fields that a hypothesis about links predicts.
pub(super) const OF_MASS: [Field; 3] = [Field::Mass, Field::Com, Field::Inertia];
/// MuJoCo's bounds of mass and inertia, with which its compiler accepts a file that it refuses without (`BOUND` in
/// `oracles/featherbench_oracles/mujoco/reading.py`).
const BOUND: f64 = 1e-6;
/// The factors of a wrong unit: a thousand for lengths or masses, its square for areas.
pub(super) const UNITS: [f64; 4] = [1e3, 1e-3, 1e6, 1e-6];
/// Bodies with more links are not tried link by link: the time grows with the square.
const MOST_LINKS: usize = 200;

/// Why a body has its numbers, and the links that make the difference.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Account {
    pub cause: Cause,
    pub text: String,
}

/// A link of a body.
struct Part {
    name: String,
    place: Transform<f64>,
    given: Option<FileInertial>,
    solids: Option<FileInertial>,
    /// The numbers that the engine reports for it, and the cause that it reports.
    told: Option<(Cause, FileInertial)>,
}

/// The edit of a link.
type Rule = Box<dyn Fn(&Part) -> Option<(Cause, FileInertial)>>;

/// A body of ours, split into its links as far as they are known.
pub(super) struct Parts<'a> {
    body: &'a BodyDescription,
    parts: Vec<Part>,
    /// The part of it that is not known link by link.
    rest: RigidBodyInertia<f64>,
    rounding: f64,
    reach: f64,
}

impl<'a> Parts<'a> {
    /// The links of body `i`: those that the file names; or those whose numbers in the file the parser's notes give; or the body itself.
    pub fn new(ours: &'a Description, i: usize, links: &[FileLink], notes: &[&ImportNote], reach: f64, precision: Precision) -> Self {
        let body = &ours.bodies[i];
        let itself = std::iter::once((body.name.as_str(), Transform::identity()));
        let fixed =
            ours.frames.iter().filter(|frame| frame.body == Some(i)).map(|frame| (frame.name.as_str(), frame.placement.to_transform()));
        let named: Vec<(&str, Transform<f64>)> = itself.chain(fixed).collect();
        let told = |name: &str| {
            let held = notes.iter().find(|note| note.about.as_deref() == Some(name) && note.numbers.len() >= 10)?;
            let cause = if held.cause == "from_geometry" { Cause::Geometry } else { Cause::Edited };
            Some((cause, ten(&held.numbers[held.numbers.len() - 10..]), (held.numbers.len() == 20).then(|| ten(&held.numbers[..10]))))
        };
        let of_file = named.iter().filter_map(|(name, place)| {
            let link = links.iter().find(|link| link.name == *name)?;
            let told = told(name).map(|(cause, held, _)| (cause, held));
            Some(Part { name: link.name.clone(), place: *place, given: link.inertial, solids: link.solids, told })
        });
        let mut parts: Vec<Part> = of_file.collect();
        if parts.is_empty() {
            let of_notes = named.iter().filter_map(|(name, place)| {
                let (cause, held, given) = told(name)?;
                Some(Part { name: (*name).to_owned(), place: *place, given: Some(given?), solids: None, told: Some((cause, held)) })
            });
            parts = of_notes.collect();
        }
        if parts.is_empty() {
            let whole = FileInertial { mass: body.mass, com: body.com, rotation: Placement::default().rotation, inertia: body.inertia };
            let told = told(&body.name).filter(|_| named.len() == 1).map(|(cause, held, _)| (cause, held));
            let given = (body.mass != 0.0 || body.inertia != [0.0; 6]).then_some(whole);
            parts.push(Part { name: body.name.clone(), place: Transform::identity(), given, solids: None, told });
        }
        let sum = parts.iter().map(|part| placed(part, part.given.as_ref())).fold(RigidBodyInertia::zero(), |sum, part| sum + part);
        let own = RigidBodyInertia::from_com(body.mass, Vec3::from_array(body.com), Sym3::from_array(body.inertia));
        let rounding = precision.tested() * named.len() as f64;
        Self { body, parts, rest: own + negative(sum), rounding, reach }
    }

    /// The hypothesis that predicts these fields of the engine's body.
    pub fn account(&self, theirs: &BodyDescription, fields: &[Field]) -> Option<Account> {
        rules().into_iter().find_map(|(each, rule)| {
            let mut choices: Vec<Vec<usize>> = vec![(0..self.parts.len()).collect()];
            if each && self.parts.len() > 1 && self.parts.len() <= MOST_LINKS {
                choices.extend((0..self.parts.len()).map(|k| vec![k]));
            }
            choices.into_iter().find_map(|choice| self.tested(theirs, fields, &choice, &rule))
        })
    }

    /// The rule applied to some of the links, if it predicts the fields.
    fn tested(&self, theirs: &BodyDescription, fields: &[Field], choice: &[usize], rule: &Rule) -> Option<Account> {
        let changes: Vec<(usize, Cause, FileInertial)> = choice
            .iter()
            .filter_map(|&k| rule(&self.parts[k]).map(|(cause, to)| (k, cause, to)))
            .filter(|(k, _, to)| self.parts[*k].given.as_ref() != Some(to))
            .collect();
        if changes.is_empty() {
            return None;
        }
        let mut sum = self.rest;
        for (k, part) in self.parts.iter().enumerate() {
            let changed = changes.iter().find(|(at, ..)| *at == k).map(|(_, _, to)| to);
            sum += placed(part, changed.or(part.given.as_ref()));
        }
        let predicted = self.merged(sum);
        // A body without mass has no centre of mass. So no import result of it differs (MuJoCo puts it where the body is in its parent).
        let nowhere = |field: Field| field == Field::Com && self.body.mass == 0.0;
        let agrees = |field: Field| {
            let no_place = field == Field::Com && predicted.mass == 0.0 && theirs.mass != 0.0;
            !no_place && !differs(fields::size(field, &predicted, theirs, self.reach), self.rounding)
        };
        let changed = |field: Field| differs(fields::size(field, self.body, &predicted, self.reach), self.rounding);
        // It changes one of the fields that it is to explain, and whatever it changes the engine has so.
        let claims = fields.iter().any(|&field| changed(field) || nowhere(field));
        let honest = OF_MASS.into_iter().all(|field| fields.contains(&field) || !changed(field) || nowhere(field) || agrees(field));
        if !claims || !honest {
            return None;
        }
        fields.iter().all(|&field| nowhere(field) || agrees(field)).then(|| self.told(changes))
    }

    fn merged(&self, sum: RigidBodyInertia<f64>) -> BodyDescription {
        let mut body = self.body.clone();
        let com = if sum.mass > 0.0 { sum.com() } else { Vec3::zero() };
        body.mass = sum.mass;
        body.com = com.to_array();
        body.inertia = (sum.rotational + Sym3::point_mass(-sum.mass, com)).to_array();
        body
    }

    /// The links that make the difference, the largest first; its cause is that of the whole.
    fn told(&self, changes: Vec<(usize, Cause, FileInertial)>) -> Account {
        let total = self.parts.iter().filter_map(|part| part.given).map(|given| given.mass).sum::<f64>().max(f64::MIN_POSITIVE);
        let scale = fields::inertia_scale(self.body).max(f64::MIN_POSITIVE);
        let mut listed: Vec<(f64, Cause, String)> = changes
            .into_iter()
            .map(|(k, cause, to)| {
                let part = &self.parts[k];
                let from = part.given.unwrap_or(NOTHING);
                let [before, after] = [from, to].map(|x| placed(part, Some(&x)));
                let turned: f64 = (after.rotational + negative(before).rotational).to_array().iter().map(|x| x.abs()).sum();
                let size = (to.mass - from.mass).abs() / total + turned / scale;
                (size, cause, change(&part.name, &from, &to))
            })
            .collect();
        listed.sort_by(|a, b| b.0.total_cmp(&a.0));
        let cause = listed[0].1;
        let more = if listed.len() > 3 { format!("; and {} more links", listed.len() - 3) } else { String::new() };
        let texts: Vec<String> = listed.into_iter().take(3).map(|(_, cause, text)| format!("{text} ({})", rule_of(cause))).collect();
        Account { cause, text: texts.join("; ") + &more }
    }
}

const NOTHING: FileInertial =
    FileInertial { mass: 0.0, com: [0.0; 3], rotation: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], inertia: [0.0; 6] };

/// Ten numbers of a note.
fn ten(numbers: &[f64]) -> FileInertial {
    let com = [numbers[1], numbers[2], numbers[3]];
    FileInertial { mass: numbers[0], com, inertia: std::array::from_fn(|k| numbers[4 + k]), ..NOTHING }
}

/// The inertia of a link about the body's origin.
fn placed(part: &Part, inertial: Option<&FileInertial>) -> RigidBodyInertia<f64> {
    let Some(x) = inertial else { return RigidBodyInertia::zero() };
    let about_com = Sym3::from_array(x.inertia).rotate(Mat3::from_array(x.rotation));
    RigidBodyInertia::from_com(x.mass, Vec3::from_array(x.com), about_com).to_parent(&part.place)
}

fn negative(x: RigidBodyInertia<f64>) -> RigidBodyInertia<f64> {
    let rotational = Sym3::from_array(x.rotational.to_array().map(|x| -x));
    RigidBodyInertia { mass: -x.mass, first_moment: x.first_moment * -1.0, rotational }
}

/// The edit of a link, in words.
fn change(name: &str, from: &FileInertial, to: &FileInertial) -> String {
    let digits = |x: f64| fields::digits(x, 0.0);
    if from.mass != to.mass {
        return format!("link '{name}': {} kg became {} kg", digits(from.mass), digits(to.mass));
    }
    if from.com != to.com {
        let list = |com: [f64; 3]| com.map(digits).join(", ");
        return format!("link '{name}': centre of mass ({}) became ({}) m", list(from.com), list(to.com));
    }
    let six = |x: &FileInertial| Sym3::from_array(x.inertia).rotate(Mat3::from_array(x.rotation)).to_array().map(digits).join(", ");
    format!("link '{name}': inertia ({}) became ({}) kg·m²", six(from), six(to))
}

/// The rule of a cause, in words.
fn rule_of(cause: Cause) -> &'static str {
    match cause {
        Cause::Geometry => "its collision geometry at 1000 kg/m³",
        Cause::DefaultInertia => "the engine's default inertia",
        Cause::Bounds => "raised to MuJoCo's bounds of 1e-6",
        Cause::Balanced => "three equal moments for an unphysical inertia",
        Cause::Unphysical => "a ball of water of its mass for an unphysical inertia",
        Cause::MasslessLink => "an inertia without mass is left out",
        Cause::Dropped => "its mass is gone",
        Cause::InertialRotationLost => "the rotation of the inertial is lost",
        Cause::Transposed => "the rotation of the inertial is transposed",
        Cause::OffDiagonals => "products of inertia are left out",
        Cause::AboutOrigin => "inertia about the link's origin taken for that about the centre of mass, or the other way",
        Cause::ComSign => "the sign of the centre of mass",
        Cause::Unit => "another unit",
        _ => "as its parser says",
    }
}

/// The hypotheses in the order in which they are tried, and whether one may apply to a single link of several.
fn rules() -> Vec<(bool, Rule)> {
    let identity = NOTHING.rotation;
    let geometry = |part: &Part| part.given.is_none().then_some(part.solids?).map(|solids| (Cause::Geometry, solids));
    let told = |part: &Part| part.told;
    let of_given =
        |cause: Cause, to: fn(FileInertial) -> FileInertial| -> Rule { Box::new(move |part| part.given.map(|given| (cause, to(given)))) };
    let mut rules: Vec<(bool, Rule)> = vec![
        (false, Box::new(geometry)),
        (
            true,
            Box::new(|part| part.given.is_none().then_some((Cause::DefaultInertia, FileInertial { mass: 1.0, inertia: UNIT, ..NOTHING }))),
        ),
        // DART ignores an MJCF's inertial except the mass: it computes the rest from geometry, or takes its default.
        (true, of_given(Cause::DefaultInertia, |x| FileInertial { mass: x.mass, inertia: UNIT, ..NOTHING })),
        (true, Box::new(|part| repaired(part, false))),
        (false, Box::new(move |part| geometry(part).or_else(|| repaired(part, false)))),
        (false, Box::new(|part| repaired(part, true))),
        (false, Box::new(move |part| geometry(part).or_else(|| repaired(part, true)))),
        // The engine reports the mass properties of meshes: their volume is not known here.
        (false, Box::new(move |part| told(part).filter(|(cause, _)| *cause == Cause::Geometry).or_else(|| repaired(part, true)))),
        (
            false,
            Box::new(|part| {
                part.given.filter(|given| given.mass == 0.0).map(|given| (Cause::MasslessLink, FileInertial { inertia: [0.0; 6], ..given }))
            }),
        ),
        (true, Box::new(|part| part.given.filter(|given| !physical(given)).map(|given| (Cause::Unphysical, ball(given))))),
        (true, of_given(Cause::InertialRotationLost, |x| FileInertial { rotation: NOTHING.rotation, ..x })),
        (true, of_given(Cause::Transposed, |x| FileInertial { rotation: Mat3::from_array(x.rotation).transpose().to_array(), ..x })),
        (
            true,
            of_given(Cause::OffDiagonals, |x| {
                let [xx, _, _, yy, _, zz] = x.inertia;
                FileInertial { inertia: [xx, 0.0, 0.0, yy, 0.0, zz], ..x }
            }),
        ),
        (true, of_given(Cause::AboutOrigin, |x| shifted(x, -1.0))),
        (true, of_given(Cause::AboutOrigin, |x| shifted(x, 1.0))),
        (true, of_given(Cause::ComSign, |x| FileInertial { com: x.com.map(|c| -c), ..x })),
    ];
    for k in 0..3 {
        let flip = move |x: FileInertial| FileInertial { com: std::array::from_fn(|j| if j == k { -x.com[j] } else { x.com[j] }), ..x };
        rules.push((true, Box::new(move |part| part.given.map(|given| (Cause::ComSign, flip(given))))));
    }
    for unit in UNITS {
        let scaled: [fn(FileInertial, f64) -> FileInertial; 4] = [
            |x, unit| FileInertial { mass: x.mass * unit, ..x },
            |x, unit| FileInertial { mass: x.mass * unit, inertia: x.inertia.map(|i| i * unit), ..x },
            |x, unit| FileInertial { com: x.com.map(|c| c * unit), ..x },
            |x, unit| FileInertial { inertia: x.inertia.map(|i| i * unit), ..x },
        ];
        for scale in scaled {
            rules.push((true, Box::new(move |part| part.given.map(|given| (Cause::Unit, scale(given, unit))))));
        }
    }
    rules.push((true, Box::new(|part| part.given.map(|_| (Cause::Dropped, NOTHING)))));
    rules.push((true, Box::new(move |part| told(part).map(|(cause, held)| (cause, FileInertial { rotation: identity, ..held })))));
    rules
}

/// An inertia of one about every axis.
const UNIT: [f64; 6] = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0];

/// A link after MuJoCo's compiler: mass and moments raised to its bounds, and equal moments if one exceeds the sum of the others.
fn repaired(part: &Part, bounds: bool) -> Option<(Cause, FileInertial)> {
    let given = part.given.unwrap_or(NOTHING);
    let (mut moments, axes) = principal(&given);
    let mut to = given;
    let mut cause = None;
    if bounds && (given.mass < BOUND || moments.iter().any(|&moment| moment < BOUND)) {
        to.mass = given.mass.max(BOUND);
        moments = moments.map(|moment| moment.max(BOUND));
        cause = Some(Cause::Bounds);
    }
    let [a, b, c] = moments;
    if a + b < c || a + c < b || b + c < a {
        moments = [(a + b + c) / 3.0; 3];
        cause = Some(Cause::Balanced);
    }
    let turned = axes * Matrix3::from_diagonal(&moments.into()) * axes.transpose();
    to.inertia = [turned[(0, 0)], turned[(0, 1)], turned[(0, 2)], turned[(1, 1)], turned[(1, 2)], turned[(2, 2)]];
    cause.map(|cause| (cause, to))
}

/// Principal moments and axes in the inertial's own frame.
fn principal(given: &FileInertial) -> ([f64; 3], Matrix3<f64>) {
    let [xx, xy, xz, yy, yz, zz] = given.inertia;
    if [xy, xz, yz] == [0.0; 3] {
        return ([xx, yy, zz], Matrix3::identity());
    }
    let eigen = SymmetricEigen::new(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz));
    (eigen.eigenvalues.into(), eigen.eigenvectors)
}

/// Whether some distribution of mass has this inertia.
fn physical(given: &FileInertial) -> bool {
    let [a, b, c] = principal(given).0;
    // The rounding of a file with six digits, as everywhere.
    let slack = 1e-6 * (a + b + c).abs();
    a + b >= c - slack && a + c >= b - slack && b + c >= a - slack
}

/// The inertia that Drake gives to a link whose own is unphysical: that of a ball of its mass, as dense as water.
fn ball(given: FileInertial) -> FileInertial {
    let radius = (3.0 * given.mass / (4.0 * PI * WATER)).cbrt();
    FileInertial { inertia: UNIT.map(|one| one * 0.4 * given.mass * radius * radius), ..given }
}

/// The inertia with that of a point of the link's mass at its centre of mass added `times`.
fn shifted(x: FileInertial, times: f64) -> FileInertial {
    let com = Mat3::from_array(x.rotation).transpose() * Vec3::from_array(x.com);
    FileInertial { inertia: (Sym3::from_array(x.inertia) + Sym3::point_mass(times * x.mass, com)).to_array(), ..x }
}
