//! Shards: parts of a run that are evaluated apart, by any processes on any machines, and merged into the run that one process would make.
//!
//! A [`Plan`] is cut into shards in its own order, so that each has about the same estimated cost. Every process cuts the same plan alike: it
//! needs no message from another. A finished shard is a folder with its outcomes and a [`ShardFile`]. [`Merge`] checks the shards and
//! writes their outcomes into one file, which is then compared as that of one process.

mod cost;
mod error;
mod file;
pub mod journal;
mod merge;

pub use cost::{Costs, Estimate};
pub use error::ShardError;
pub use file::{SHARD_FORMAT, SHARD_NAME, ShardFile};
pub use merge::{Merge, Part};

use crate::run::plan;
use crate::{Cell, Context, Study, hash};
use std::collections::HashSet;
use std::fmt;
use std::str::FromStr;

/// One of some shards, counted from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Shard {
    /// Its number, from one.
    pub fn number(self) -> usize {
        self.number
    }

    /// How many shards there are.
    pub fn of(self) -> usize {
        self.of
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let advice = || format!("'{text}' is no shard: write i/n with 1 ≤ i ≤ n, as in 2/7");
        let (number, of) = text.split_once('/').ok_or_else(advice)?;
        let read = |digits: &str| digits.parse::<usize>().map_err(|_| advice());
        let (number, of) = (read(number)?, read(of)?);
        if (1..=of).contains(&number) { Ok(Self { number, of }) } else { Err(advice()) }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// A cell of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Planned {
    /// The cell.
    pub cell: Cell,
    /// Its id.
    pub id: String,
    /// Whether it runs alone on a quiet machine.
    pub exclusive: bool,
    /// What it costs.
    pub estimate: Estimate,
}

/// The cells of a run in their order, each once, with what they cost.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// The cells.
    pub cells: Vec<Planned>,
}

impl Plan {
    /// Plans the cells that a filter accepts.
    pub fn new(studies: &[Box<dyn Study>], context: &Context, keep: &(dyn Fn(&Cell) -> bool + Sync), costs: &Costs) -> Self {
        let (mut cells, mut seen) = (Vec::new(), HashSet::new());
        for study in studies {
            for cell in plan(study.as_ref(), context, keep) {
                let id = cell.id();
                if seen.insert(id.clone()) {
                    let estimate = costs.of(study.as_ref(), context, &cell, &id);
                    cells.push(Planned { cell, id, exclusive: study.exclusive(), estimate });
                }
            }
        }
        Self { cells }
    }

    /// The estimated cost of all cells, in seconds.
    pub fn seconds(&self) -> f64 {
        self.cells.iter().map(|planned| planned.estimate.seconds).sum()
    }

    /// The shard of each cell, counted from one, if there are `of` of them.
    pub fn cut(&self, of: usize) -> Vec<usize> {
        cut(&self.cells.iter().map(|planned| planned.estimate.seconds).collect::<Vec<_>>(), of)
    }

    /// The cells of a shard, in the order of the plan.
    pub fn part(&self, shard: Shard) -> Vec<&Planned> {
        let cut = self.cut(shard.of);
        self.cells.iter().zip(cut).filter(|(_, number)| *number == shard.number).map(|(planned, _)| planned).collect()
    }
}

/// A hash of cells in their order.
pub fn hash_of<'a>(ids: impl Iterator<Item = &'a str>) -> String {
    hash::of_parts(&ids.map(str::as_bytes).collect::<Vec<_>>())
}

/// Cuts a list into pieces of consecutive items with about the same sum: an item goes to the piece that holds its middle. So no piece is
/// above the mean by more than its largest item, and the cells of a robot and engine, which share the work of building it, stay together.
fn cut(seconds: &[f64], of: usize) -> Vec<usize> {
    // An item of no cost counts too, or a plan of such items would be one piece.
    let least = seconds.iter().sum::<f64>().max(1.0) * 1e-12;
    let total: f64 = seconds.iter().map(|x| x + least).sum();
    let mut before = 0.0;
    let piece = |seconds: &f64| {
        let middle = before + 0.5 * (seconds + least);
        before += seconds + least;
        // The cast rounds down.
        ((middle / total * of as f64) as usize).min(of.saturating_sub(1)) + 1
    };
    seconds.iter().map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_robots::Random;

    #[test]
    fn a_shard_is_written_as_it_is_read() {
        for good in ["1/1", "2/7", "7/7"] {
            assert_eq!(good.parse::<Shard>().unwrap().to_string(), good);
        }
        for bad in ["", "2", "0/7", "8/7", "1/0", "-1/2", "a/b", "1/2/3", "1.5/2"] {
            let message = bad.parse::<Shard>().unwrap_err();
            assert!(message.contains("2/7") && message.contains(bad), "{message}");
        }
    }

    /// The cost of a shard is at most the mean and the largest cell.
    #[test]
    fn a_cut_is_balanced_and_keeps_the_order() {
        let mut random = Random::new(5, 0);
        for count in [0, 1, 6, 500] {
            let seconds: Vec<f64> = (0..count).map(|_| random.uniform(-6.0, 2.0).exp()).collect();
            let largest = seconds.iter().copied().fold(0.0, featherbench_spatial::larger);
            for of in [1, 2, 7, 40] {
                let pieces = cut(&seconds, of);
                assert!(pieces.is_sorted() && pieces.iter().all(|piece| (1..=of).contains(piece)));
                for number in 1..=of {
                    let cost: f64 = seconds.iter().zip(&pieces).filter(|(_, piece)| **piece == number).map(|(x, _)| x).sum();
                    // Sums of 500 numbers in two orders: 1e-9 is far above their rounding.
                    assert!(cost <= seconds.iter().sum::<f64>() / of as f64 + largest + 1e-9, "{count} cells, shard {number}/{of}: {cost}");
                }
            }
        }
        assert_eq!(cut(&[0.0; 4], 2), [1, 1, 2, 2]);
    }
}
