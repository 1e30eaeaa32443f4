//! Reading the section `loops`: each type has its own fields, and no others.

use super::fields::{BodyIndex, PlacementFields};
use featherbench_model::{Loop, LoopEnd, LoopKind, LoopMotion};
use serde::Deserialize;

/// A loop whose fields fit its type.
#[derive(Deserialize)]
#[serde(try_from = "LoopFields")]
pub(super) struct Tie(pub Loop);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LoopFields {
    name: String,
    #[serde(rename = "type")]
    kind: String,
    first: Option<End>,
    second: Option<End>,
    axes: Option<[bool; 3]>,
    length: Option<f64>,
    terms: Option<Vec<Term>>,
    offset: Option<f64>,
    follower: Option<usize>,
    leader: Option<usize>,
    polynomial: Option<[f64; 5]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct End {
    body: BodyIndex,
    placement: PlacementFields,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Term {
    body: usize,
    coefficient: f64,
}

impl TryFrom<LoopFields> for Tie {
    type Error = String;
    fn try_from(fields: LoopFields) -> Result<Self, String> {
        let LoopFields { name, kind, first, second, axes, length, terms, offset, follower, leader, polynomial } = fields;
        let motion = LoopMotion::ALL.into_iter().find(|motion| motion.name() == kind);
        let own: &[&str] = match kind.as_str() {
            _ if motion.is_some() => &["first", "second"],
            "point" => &["first", "second", "axes"],
            "distance" => &["first", "second", "length"],
            "gear" => &["terms", "offset"],
            "mimic" => &["follower", "leader", "polynomial"],
            other => {
                let joints = LoopMotion::ALL.map(LoopMotion::name).join(", ");
                return Err(format!("loop '{name}' has the unknown type '{other}'; choose one of {joints}, point, distance, gear, mimic"));
            }
        };
        let given = [
            ("first", first.is_some()),
            ("second", second.is_some()),
            ("axes", axes.is_some()),
            ("length", length.is_some()),
            ("terms", terms.is_some()),
            ("offset", offset.is_some()),
            ("follower", follower.is_some()),
            ("leader", leader.is_some()),
            ("polynomial", polynomial.is_some()),
        ];
        if let Some((field, _)) = given.into_iter().find(|(field, given)| *given && !own.contains(field)) {
            return Err(format!("{kind} loop '{name}' has '{field}', which such a loop has not; remove it"));
        }
        let missing = |field: &str| format!("{kind} loop '{name}' has no '{field}'; it needs {}", own.join(", "));
        let ends = || -> Result<[LoopEnd; 2], String> {
            let (first, second) = (first.ok_or_else(|| missing("first"))?, second.ok_or_else(|| missing("second"))?);
            Ok([first, second].map(|end| LoopEnd { body: end.body.0, placement: end.placement.into() }))
        };
        let described = match (motion, kind.as_str()) {
            (Some(motion), _) => LoopKind::Joint { ends: ends()?, motion },
            (None, "point") => LoopKind::Point { ends: ends()?, axes: axes.ok_or_else(|| missing("axes"))? },
            (None, "distance") => LoopKind::Distance { ends: ends()?, length: length.ok_or_else(|| missing("length"))? },
            (None, "gear") => {
                let terms = terms.ok_or_else(|| missing("terms"))?;
                let terms = terms.into_iter().map(|Term { body, coefficient }| (body, coefficient)).collect();
                LoopKind::Gear { terms, offset: offset.ok_or_else(|| missing("offset"))? }
            }
            (None, _) => LoopKind::Mimic {
                follower: follower.ok_or_else(|| missing("follower"))?,
                leader: leader.ok_or_else(|| missing("leader"))?,
                polynomial: polynomial.ok_or_else(|| missing("polynomial"))?,
            },
        };
        Ok(Self(Loop { name, kind: described }))
    }
}
