//! A residual behind an oracle: the operation `residual`. So any program, for example a few lines of Python, can correct any engine.

use super::{Oracle, shaped};
use featherbench_bench::{NoAnswer, Robot};
use featherbench_residuals::{Residual, ResidualError, State};
use featherbench_robots::{Case, StateBatch};
use nalgebra::DMatrix;
use serde::Deserialize;
use serde_json::json;

/// What `hello` says of a residual.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Offered {
    /// Whether r depends on the acceleration.
    pub(crate) acceleration: bool,
}

/// The residual of an oracle for one robot.
///
/// ∂r/∂a is made of differences with steps of one, which are exact to rounding for an r that is affine in a: the protocol says so.
pub struct OracleResidual<'a> {
    oracle: &'a Oracle,
    robot: &'a Robot,
    offered: Offered,
}

impl std::fmt::Debug for OracleResidual<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "residual of {} for {}", self.oracle.identity.name, self.robot.name)
    }
}

impl Oracle {
    /// Its residual for a robot, if it has one. The program is asked whenever the residual is.
    pub fn residual<'a>(&'a self, robot: &'a Robot) -> Option<OracleResidual<'a>> {
        self.hello.residual.map(|offered| OracleResidual { oracle: self, robot, offered })
    }
}

impl OracleResidual<'_> {
    /// r at a state, and at the same with other accelerations: one row each.
    fn ask(&self, state: &State<'_>, accelerations: &[Vec<f64>]) -> Result<Vec<f64>, ResidualError> {
        let (count, nv) = (accelerations.len(), self.robot.states.nv);
        let still = vec![0.0; nv];
        let command = if state.command.is_empty() { &still } else { state.command };
        let states = StateBatch {
            nq: self.robot.states.nq,
            nv,
            bodies: self.robot.states.bodies,
            cases: vec![Case::Random; count],
            q: state.q.repeat(count),
            v: state.v.repeat(count),
            a: accelerations.concat(),
            tau: command.repeat(count),
            wrench: vec![0.0; count * self.robot.states.bodies * 6],
        };
        let answer = (|| -> Result<Vec<f64>, NoAnswer> {
            let mut session = self.oracle.session()?;
            session.open()?.hold(self.robot, &states)?;
            let question = json!({"op": "residual", "first": 0, "count": count});
            shaped(&session.ask(question, Vec::new())?, "value", &[count, nv])
        })();
        answer.map_err(|reason| ResidualError::NoAnswer(reason.to_string()))
    }
}

impl Residual for OracleResidual<'_> {
    fn nv(&self) -> usize {
        self.robot.states.nv
    }

    fn nq(&self) -> Option<usize> {
        Some(self.robot.states.nq)
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        let found = self.ask(state, &[state.a.to_vec()])?;
        r.iter_mut().zip(found).for_each(|(r, x)| *r += x);
        Ok(())
    }

    fn has_acceleration(&self) -> bool {
        self.offered.acceleration
    }

    fn add_by_acceleration(&self, state: &State<'_>, matrix: &mut DMatrix<f64>) -> Result<(), ResidualError> {
        let nv = self.nv();
        let moved = |column: usize| (0..nv).map(|k| state.a[k] + f64::from(u8::from(k == column))).collect::<Vec<f64>>();
        let accelerations: Vec<Vec<f64>> = std::iter::once(state.a.to_vec()).chain((0..nv).map(moved)).collect();
        let values = self.ask(state, &accelerations)?;
        for column in 0..nv {
            (0..nv).for_each(|row| matrix[(row, column)] += values[(column + 1) * nv + row] - values[row]);
        }
        Ok(())
    }
}
