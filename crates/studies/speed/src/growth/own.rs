//! Our methods that are measured, and what each is compared with.

use super::OfLine;
use featherbench_bench::{Cell, OWN, Quantity};

/// A method of ours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Own {
    pub(super) quantity: Quantity,
    /// Its name in a question. A method on several threads has their number behind it in cells and rows: `twisted_2`.
    pub(super) method: &'static str,
    /// Whether it uses several threads.
    pub(super) parallel: bool,
    /// Our serial method of the same quantity that its times are divided by.
    pub(super) over: Option<&'static str>,
    /// Whether its answers are those of `over` to the bit.
    pub(super) same: bool,
}

const fn serial(quantity: Quantity, method: &'static str) -> Own {
    Own { quantity, method, parallel: false, over: None, same: false }
}

const fn compared(quantity: Quantity, method: &'static str, over: &'static str) -> Own {
    Own { over: Some(over), ..serial(quantity, method) }
}

const fn parallel(quantity: Quantity, method: &'static str, over: &'static str, same: bool) -> Own {
    Own { parallel: true, same, ..compared(quantity, method, over) }
}

/// All of them. The serial kernels of inverse dynamics and M are packed: several joints to a register. Their parallel ones take one joint at a
/// time, so their answers differ by rounding. The parallel articulated-body algorithm and factorization have the serial operations in the
/// same order.
pub(super) const METHODS: [Own; 14] = [
    serial(Quantity::InverseDynamics, "rnea_packed"),
    serial(Quantity::Momentum, "kinematics_packed"),
    serial(Quantity::ForwardDynamics, "aba"),
    compared(Quantity::ForwardDynamics, "ltdl", "aba"),
    compared(Quantity::ForwardDynamics, "aba_packed", "aba"),
    serial(Quantity::MassMatrixSparse, "crba_packed"),
    serial(Quantity::Factorization, "ltdl"),
    serial(Quantity::Solve, "ltdl"),
    parallel(Quantity::InverseDynamics, "rnea_parallel", "rnea_packed", false),
    parallel(Quantity::ForwardDynamics, "aba_parallel", "aba", true),
    parallel(Quantity::ForwardDynamics, "twisted", "aba", false),
    parallel(Quantity::ForwardDynamics, "ltdl_parallel", "ltdl", false),
    parallel(Quantity::MassMatrixSparse, "crba_parallel", "crba_packed", false),
    parallel(Quantity::Factorization, "ltdl_parallel", "ltdl", true),
];

impl Own {
    /// Its name in cells and rows with so many threads.
    pub(super) fn name(&self, threads: usize) -> String {
        if self.parallel { format!("{}_{threads}", self.method) } else { self.method.to_owned() }
    }
}

/// The threads of a cell: a parameter of cells of parallel methods.
pub(super) fn threads(cell: &Cell) -> usize {
    cell.params::<OfLine>().ok().and_then(|params| params.threads).unwrap_or(1)
}

/// Our method of a cell.
pub(super) fn of(cell: &Cell) -> Option<&'static Own> {
    let threads = threads(cell);
    let named = |own: &&Own| own.quantity.name() == cell.quantity && own.name(threads) == cell.method;
    METHODS.iter().find(named).filter(|_| cell.engine == OWN)
}
