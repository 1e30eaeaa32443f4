//! Elements with the attributes that they have from their class.

use super::error::{At, MjcfProblem};
use super::settings::{Class, Settings};
use featherbench_spatial::{Mat3, Vec3};
use roxmltree::Node;

/// An element of a body.
#[derive(Clone, Copy)]
pub(super) struct Element<'a, 'd> {
    pub node: Node<'d, 'd>,
    /// The body, for messages.
    pub owner: &'a str,
    /// What the element has where it says nothing itself.
    pub class: Option<&'a Class<'d>>,
}

/// The attributes that give an orientation.
const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

impl<'d> Element<'_, 'd> {
    /// A problem of this element.
    pub fn problem(&self, problem: MjcfProblem) -> At {
        problem.at(self.node.range().start)
    }

    /// An attribute, its own or its class's.
    pub fn attribute(&self, name: &str) -> Option<&'d str> {
        self.node.attribute(name).or_else(|| self.class?.get(self.node.tag_name().name(), name))
    }

    /// An attribute that must exist.
    pub fn required(&self, name: &'static str) -> Result<&'d str, At> {
        let missing = || {
            let (element, owner) = (self.node.tag_name().name().to_owned(), self.owner.to_owned());
            self.problem(MjcfProblem::MissingAttribute { element, owner, attribute: name })
        };
        self.attribute(name).ok_or_else(missing)
    }

    /// The numbers of a text: `least` to `most` of them.
    fn parse(&self, attribute: &str, value: &str, (least, most): (usize, usize)) -> Result<Vec<f64>, At> {
        let (owner, attribute, text) = (self.owner.to_owned(), attribute.to_owned(), value.to_owned());
        let numbers = value.split_ascii_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
        let Some(numbers) = numbers.filter(|numbers| (least..=most).contains(&numbers.len())) else {
            let expected = match (least, most) {
                (1, 1) => "a number".to_owned(),
                _ if least == most => format!("{least} numbers"),
                _ => format!("{least} to {most} numbers"),
            };
            return Err(self.problem(MjcfProblem::NotNumbers { owner, attribute, value: text, expected }));
        };
        if !numbers.iter().all(|x| x.is_finite()) {
            return Err(self.problem(MjcfProblem::NotFinite { owner, attribute, value: text }));
        }
        Ok(numbers)
    }

    /// An attribute of `least` to `most` numbers.
    pub fn some_numbers(&self, name: &str, least: usize, most: usize) -> Result<Option<Vec<f64>>, At> {
        self.attribute(name).map(|value| self.parse(name, value, (least, most))).transpose()
    }

    /// An attribute of N numbers.
    pub fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, At> {
        Ok(self.some_numbers(name, N, N)?.and_then(|numbers| numbers.try_into().ok()))
    }

    /// An attribute of one number.
    pub fn number(&self, name: &str) -> Result<Option<f64>, At> {
        Ok(self.numbers::<1>(name)?.map(|[x]| x))
    }

    /// A word of a list.
    pub fn word<T: Copy>(&self, name: &str, words: &[(&str, T)], expected: &'static str) -> Result<Option<T>, At> {
        let Some(value) = self.attribute(name) else { return Ok(None) };
        let unknown = || {
            let (owner, attribute, value) = (self.owner.to_owned(), name.to_owned(), value.to_owned());
            self.problem(MjcfProblem::UnknownWord { owner, attribute, value, expected })
        };
        words.iter().find(|(word, _)| *word == value).map(|&(_, meaning)| Some(meaning)).ok_or_else(unknown)
    }

    /// Yes or no.
    pub fn flag(&self, name: &str) -> Result<Option<bool>, At> {
        self.word(name, &[("true", true), ("false", false)], "true, false")
    }

    /// Yes, no, or as other attributes say.
    pub fn flag_or_auto(&self, name: &str) -> Result<Option<bool>, At> {
        Ok(self.word(name, &[("true", Some(true)), ("false", Some(false)), ("auto", None)], "true, false, auto")?.flatten())
    }

    /// The orientation: of the element itself, or else of its class, or else none.
    pub fn orientation(&self, settings: &Settings) -> Result<Option<Mat3<f64>>, At> {
        let own = ORIENTATIONS.into_iter().find_map(|name| Some((name, self.node.attribute(name)?)));
        let of_class = || ORIENTATIONS.into_iter().find_map(|name| Some((name, self.attribute(name)?)));
        let Some((name, text)) = own.or_else(of_class) else { return Ok(None) };
        let none = || {
            let (owner, value) = (self.owner.to_owned(), text.to_owned());
            self.problem(MjcfProblem::NoOrientation { owner, attribute: name, value })
        };
        let count = match name {
            "quat" | "axisangle" => 4,
            "xyaxes" => 6,
            _ => 3,
        };
        let x = self.parse(name, text, (count, count))?;
        let rotation = match (name, &x[..]) {
            ("quat", &[w, x, y, z]) => unit(&[w, x, y, z]).map(|_| Mat3::from_array(super::super::quaternion::rotation([w, x, y, z]))),
            ("axisangle", &[x, y, z, angle]) => axis([x, y, z]).map(|axis| about(axis, settings.angle(angle))),
            ("euler", angles) => Some(euler(angles, settings)),
            ("xyaxes", &[a, b, c, d, e, f]) => axes(Vec3::new(a, b, c), Vec3::new(d, e, f)),
            ("zaxis", &[x, y, z]) => axis([x, y, z]).map(onto),
            _ => None,
        };
        rotation.map(Some).ok_or_else(none)
    }
}

/// A vector's length, if it can be divided by.
fn unit(x: &[f64]) -> Option<f64> {
    let length = x.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length.is_normal()).then_some(length)
}

/// The unit vector along a vector.
pub(super) fn axis(x: [f64; 3]) -> Option<Vec3<f64>> {
    unit(&x).map(|length| Vec3::from_array(x) * (1.0 / length))
}

/// The rotation about a unit vector by an angle, rad.
pub(super) fn about(axis: Vec3<f64>, angle: f64) -> Mat3<f64> {
    featherbench_spatial::Transform::<f64>::axis_rotation(axis, angle.sin(), angle.cos())
}

/// The rotation of three angles. Small letters of the sequence turn about the moved axes, capital letters about the fixed ones.
fn euler(angles: &[f64], settings: &Settings) -> Mat3<f64> {
    angles.iter().zip(settings.sequence).fold(Mat3::identity(), |before, (&angle, letter)| {
        let axis = match letter.to_ascii_lowercase() {
            b'x' => [1.0, 0.0, 0.0],
            b'y' => [0.0, 1.0, 0.0],
            _ => [0.0, 0.0, 1.0],
        };
        let turn = about(Vec3::from_array(axis), settings.angle(angle));
        if letter.is_ascii_lowercase() { before * turn } else { turn * before }
    })
}

/// The rotation whose first column is along x, and whose second is in the plane of x and y.
fn axes(x: Vec3<f64>, y: Vec3<f64>) -> Option<Mat3<f64>> {
    let x = axis(x.to_array())?;
    let across = y - x * x.dot(y);
    // What is left of a parallel vector is rounding.
    if across.norm() <= 1e-12 * y.norm() {
        return None;
    }
    let y = axis(across.to_array())?;
    Some(Mat3::from_rows(x, y, x.cross(y)).transpose())
}

/// The smallest rotation that takes z to a unit vector; half a turn about x if that is −z.
pub(super) fn onto(z: Vec3<f64>) -> Mat3<f64> {
    let turn = Vec3::new(0.0, 0.0, 1.0).cross(z);
    let sine = turn.norm();
    match axis(turn.to_array()) {
        Some(axis) => featherbench_spatial::Transform::<f64>::axis_rotation(axis, sine, z.z),
        None if z.z < 0.0 => Mat3::from_array([1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0]),
        None => Mat3::identity(),
    }
}
