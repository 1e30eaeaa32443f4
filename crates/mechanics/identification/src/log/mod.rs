//! Logs: what a robot measured, as CSV.
//!
//! A log has a row per time and these columns, in any order; others are left alone:
//!
//! | column | number | |
//! |---|---|---|
//! | `time` | s, rising | |
//! | `q.JOINT` | position, rad or m | a free or spherical joint has `q.JOINT.0` … (position, quaternion xyzw) |
//! | `v.JOINT` | velocity | all of them or none; a joint with a quaternion needs them |
//! | `a.JOINT` | acceleration | all of them or none |
//! | `tau.JOINT` | torque of the motor at the joint, N·m or N | a free joint may have none: it has no motor |
//!
//! JOINT is the joint's name, or that of its body if it has none; a joint with several dofs has `.0`, `.1`, … behind it.

mod error;
mod examine;
mod table;

pub use error::{LogError, LogProblem};
pub use examine::{Flag, FlagKind, GAP, SATURATED};
pub use table::Table;

use crate::{LinearModel, Samples};
use std::path::Path;

/// A robot's log: plain numbers, row after row.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Log {
    /// Where it comes from, for messages.
    pub file: String,
    /// Time of each row, s.
    pub time: Vec<f64>,
    /// Configurations, `rows × nq`.
    pub q: Vec<f64>,
    /// Velocities, `rows × nv`, if they were measured.
    pub v: Option<Vec<f64>>,
    /// Accelerations, `rows × nv`, if they were measured.
    pub a: Option<Vec<f64>>,
    /// Torques, `rows × nv`.
    pub tau: Vec<f64>,
    /// The line of the file of each row.
    pub lines: Vec<usize>,
}

impl Log {
    /// Reads a log in CSV.
    ///
    /// # Errors
    /// [`LogError`], naming file, line, column and what to do.
    pub fn read(path: impl AsRef<Path>, linear: &LinearModel) -> Result<Self, LogError> {
        Self::of_table(Table::read(path.as_ref())?, linear)
    }

    /// The log that a table holds.
    ///
    /// # Errors
    /// [`LogError`], naming line and column.
    pub fn of_table(table: Table, linear: &LinearModel) -> Result<Self, LogError> {
        let bad = |problem| LogError { file: table.file.clone(), line: None, problem };
        if table.lines.len() < 2 {
            return Err(bad(LogProblem::Empty));
        }
        let dofs = linear.dofs();
        let names = |word: &str| dofs.iter().map(|dof| format!("{word}.{}", dof.name)).collect::<Vec<String>>();
        let positions: Vec<String> = linear.positions().iter().map(|name| format!("q.{name}")).collect();
        let time = table.gather(&["time".into()])?;
        let q = table.gather(&positions)?;
        let (speeds, rates) = (names("v"), names("a"));
        let any = |columns: &[String]| columns.iter().any(|column| table.has(column));
        if let Some(dof) = dofs.iter().find(|dof| dof.position.is_none()).filter(|_| !any(&speeds)) {
            return Err(bad(LogProblem::NeedsVelocity { joint: dof.name.clone() }));
        }
        let v = any(&speeds).then(|| table.gather(&speeds)).transpose()?;
        let a = any(&rates).then(|| table.gather(&rates)).transpose()?;
        let torques = names("tau");
        // No motor acts on a free joint; one that is given all the same counts.
        let motors: Vec<Option<String>> =
            torques.into_iter().zip(dofs).map(|(column, dof)| (!dof.free || table.has(&column)).then_some(column)).collect();
        let tau = table.gather_some(&motors)?;
        let log = Self { file: table.file, time, q, v, a, tau, lines: table.lines };
        log.check_time()?;
        log.check_quaternions(linear)?;
        Ok(log)
    }

    /// Rows.
    pub fn rows(&self) -> usize {
        self.time.len()
    }

    /// Samples as a log with velocities, at 17 digits: what is written is read back to the bit.
    pub fn of_samples(samples: &Samples) -> Self {
        Self {
            file: String::new(),
            time: samples.time.clone(),
            q: samples.q.clone(),
            v: Some(samples.v.clone()),
            a: None,
            tau: samples.tau.clone(),
            lines: (2..samples.count() + 2).collect(),
        }
    }

    /// The log as CSV text.
    pub fn to_csv(&self, linear: &LinearModel) -> String {
        let (nq, nv) = (linear.model().topology.nq(), linear.model().topology.nv());
        let mut groups: Vec<(&str, &[f64], usize)> = vec![("q", &self.q, nq)];
        groups.extend(self.v.as_deref().map(|v| ("v", v, nv)));
        groups.extend(self.a.as_deref().map(|a| ("a", a, nv)));
        groups.push(("tau", &self.tau, nv));
        let mut text = String::from("time");
        for (word, _, _) in &groups {
            let names: Vec<&String> =
                if *word == "q" { linear.positions().iter().collect() } else { linear.dofs().iter().map(|dof| &dof.name).collect() };
            names.iter().for_each(|name| text += &format!(",{}", quoted(&format!("{word}.{name}"))));
        }
        text.push('\n');
        for (row, time) in self.time.iter().enumerate() {
            text += &time.to_string();
            for (_, values, each) in &groups {
                values[row * each..][..*each].iter().for_each(|value| text += &format!(",{value}"));
            }
            text.push('\n');
        }
        text
    }

    /// Times are finite and rise.
    fn check_time(&self) -> Result<(), LogError> {
        for (k, pair) in self.time.windows(2).enumerate() {
            if pair[1] <= pair[0] {
                let problem = LogProblem::TimeNotRising { before: pair[0], after: pair[1] };
                return Err(LogError { file: self.file.clone(), line: Some(self.lines[k + 1]), problem });
            }
        }
        Ok(())
    }

    /// Quaternions have length one, to the digits that a log prints.
    fn check_quaternions(&self, linear: &LinearModel) -> Result<(), LogError> {
        let nq = linear.model().topology.nq();
        for at in linear.model().topology.quaternions() {
            for (row, q) in self.q.chunks_exact(nq).enumerate() {
                let length = q[at..at + 4].iter().map(|x| x * x).sum::<f64>().sqrt();
                if (length - 1.0).abs() > 1e-3 {
                    let problem = LogProblem::NotAQuaternion { column: format!("q.{}", linear.positions()[at]), length };
                    return Err(LogError { file: self.file.clone(), line: Some(self.lines[row]), problem });
                }
            }
        }
        Ok(())
    }
}

/// A field of CSV.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
