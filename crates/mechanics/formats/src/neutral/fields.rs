//! Fields of several sections: bodies by their index, and placements.

use featherbench_model::Placement;
use serde::Deserialize;

/// An index of a body, or −1 for the world.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "i64")]
pub(super) struct BodyIndex(pub Option<usize>);

impl TryFrom<i64> for BodyIndex {
    type Error = String;
    fn try_from(index: i64) -> Result<Self, String> {
        match index {
            -1 => Ok(Self(None)),
            index => usize::try_from(index).map(|index| Self(Some(index))).map_err(|_| format!("{index} is no body; the world is -1")),
        }
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlacementFields {
    rotation: [f64; 9],
    translation: [f64; 3],
}

impl From<PlacementFields> for Placement {
    fn from(PlacementFields { rotation, translation }: PlacementFields) -> Self {
        Self { rotation, translation }
    }
}
