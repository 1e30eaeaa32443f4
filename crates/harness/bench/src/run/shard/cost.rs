//! What a cell costs: measured in an earlier run, or estimated.

use crate::{Cell, Context, Entries, HarnessError, Study};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What a cell costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Wall time on one core, in seconds.
    pub seconds: f64,
    /// Whether an earlier run measured it; otherwise [`Study::seconds`] estimates it.
    pub measured: bool,
}

/// What cells cost in earlier runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Costs(BTreeMap<String, f64>);

impl Costs {
    /// Reads the outcomes of earlier runs or shards. A cell of several has the time of the last.
    ///
    /// # Errors
    /// When a folder has no outcomes, or they cannot be read.
    pub fn read(folders: &[PathBuf]) -> Result<Self, HarnessError> {
        let mut costs = BTreeMap::new();
        for folder in folders {
            let entries = Entries::whole(folder)?;
            costs.extend(entries.cells().filter_map(|id| Some((id.to_owned(), entries.seconds(id)?))));
        }
        Ok(Self(costs))
    }

    /// What a cell costs: measured if it is known.
    pub fn of(&self, study: &dyn Study, context: &Context, cell: &Cell, id: &str) -> Estimate {
        match self.0.get(id) {
            Some(&seconds) => Estimate { seconds, measured: true },
            None => Estimate { seconds: study.seconds(context, cell), measured: false },
        }
    }
}
