//! What is odd about a log, but no reason to refuse it. Each flag says its consequence.

use super::Log;
use crate::LinearModel;
use featherbench_spatial::larger;
use std::fmt;

/// A step of time above this many times the median is a gap.
pub const GAP: f64 = 2.5;
/// A torque above this share of the joint's limit is saturated.
pub const SATURATED: f64 = 0.999;
/// So many equal torques in a row, at the largest magnitude of the joint, are saturated where no limit is known.
const PLATEAU: usize = 5;

/// Something odd, with its consequence.
#[derive(Clone, Debug, PartialEq)]
pub struct Flag {
    /// What it is.
    pub kind: FlagKind,
    /// The column or parameter it is about.
    pub about: String,
    /// The first line that shows it.
    pub line: Option<usize>,
    /// How often it occurs.
    pub count: usize,
    /// What follows from it.
    pub consequence: String,
}

/// What a flag is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlagKind {
    /// Times jump.
    Gap,
    /// A torque is at its limit.
    Saturated,
    /// The motion tells too little.
    Excitation,
    /// A fitted body or friction cannot exist.
    Unphysical,
}

impl FlagKind {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gap => "gap",
            Self::Saturated => "saturated",
            Self::Excitation => "excitation",
            Self::Unphysical => "unphysical",
        }
    }
}

impl fmt::Display for Flag {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind.name(), self.about)?;
        if let Some(line) = self.line {
            write!(f, ", from line {line} on")?;
        }
        write!(f, " ({}×): {}", self.count, self.consequence)
    }
}

impl Log {
    /// The stretches of rows without a gap in time.
    pub fn segments(&self) -> Vec<std::ops::Range<usize>> {
        let largest = GAP * self.step();
        let mut segments = Vec::new();
        let mut start = 0;
        for k in 1..=self.rows() {
            if k == self.rows() || self.time[k] - self.time[k - 1] > largest {
                segments.push(start..k);
                start = k;
            }
        }
        segments
    }

    /// The median step of time, s.
    pub fn step(&self) -> f64 {
        let mut steps: Vec<f64> = self.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(0.0)
    }

    /// The torques that are as the motor was told: those below their limit, and on no plateau at their largest.
    pub fn unsaturated(&self, linear: &LinearModel) -> Vec<bool> {
        let nv = linear.model().topology.nv();
        let mut used = vec![true; self.tau.len()];
        for (dof, of) in linear.dofs().iter().enumerate() {
            let torques: Vec<f64> = self.tau.iter().skip(dof).step_by(nv).copied().collect();
            let largest = torques.iter().fold(0.0, |most: f64, tau| larger(most, tau.abs()));
            let mut mark = |row: usize| used[row * nv + dof] = false;
            if of.effort.is_finite() {
                torques.iter().enumerate().filter(|(_, tau)| tau.abs() >= SATURATED * of.effort).for_each(|(row, _)| mark(row));
                continue;
            }
            let mut start = 0;
            for row in 1..=torques.len() {
                if row == torques.len() || torques[row] != torques[start] {
                    if row - start >= PLATEAU && largest > 0.0 && torques[start].abs() == largest {
                        (start..row).for_each(&mut mark);
                    }
                    start = row;
                }
            }
        }
        used
    }

    /// What is odd about the rows.
    pub fn examine(&self, linear: &LinearModel) -> Vec<Flag> {
        let mut flags = Vec::new();
        let gaps: Vec<usize> = self.segments().iter().skip(1).map(|segment| segment.start).collect();
        if let Some(&first) = gaps.first() {
            flags.push(Flag {
                kind: FlagKind::Gap,
                about: "time".into(),
                line: Some(self.lines[first]),
                count: gaps.len(),
                consequence: format!(
                    "a step above {:.3e} s; no derivative is taken across it, and the rows beside it are left out",
                    GAP * self.step()
                ),
            });
        }
        let (used, nv) = (self.unsaturated(linear), linear.model().topology.nv());
        for (dof, of) in linear.dofs().iter().enumerate() {
            let rows: Vec<usize> = (0..self.rows()).filter(|row| !used[row * nv + dof]).collect();
            if let Some(&first) = rows.first() {
                let at = if of.effort.is_finite() {
                    format!("the limit of {} N·m", of.effort)
                } else {
                    "its largest value, row after row".into()
                };
                flags.push(Flag {
                    kind: FlagKind::Saturated,
                    about: format!("tau.{}", of.name),
                    line: Some(self.lines[first]),
                    count: rows.len(),
                    consequence: format!("the torque is at {at}, so it is not what moves the joint; these torques are not used"),
                });
            }
        }
        flags
    }
}
