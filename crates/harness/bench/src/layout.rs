//! The layout of an answer's numbers: how many there are for a robot, and results of the kernels in the layout of their quantity, over any
//! scalar.
//!
//! The same text serves our kernels in `f64` and the truth in double-double.

use crate::{Quantity, Robot};
pub use featherbench_dynamics::PARAMETERS;
use featherbench_dynamics::{BodyMotion, DimensionError, TreeSparse};
use featherbench_results::{Asked, Extents};
use featherbench_spatial::{Motion, Real};

/// Robots with more degrees of freedom than this are asked for [`Quantity::MassMatrixProbe`] and not for the whole matrix.
pub const DENSE_LIMIT: usize = 64;

impl From<&Robot> for Extents {
    fn from(robot: &Robot) -> Self {
        let topology = &robot.model.topology;
        Self { nv: topology.nv(), bodies: robot.description.bodies.len(), stored: topology.stored() }
    }
}

impl Robot {
    /// The number of its states at which a quantity is asked.
    pub fn asked(&self, quantity: Quantity) -> usize {
        let count = self.states.count();
        match quantity.asked() {
            Asked::All => count,
            Asked::One => count.min(1),
        }
    }
}

/// The whole matrix, row after row.
pub fn dense<T: Real>(matrix: &TreeSparse<T>, out: &mut [T]) {
    let n = matrix.size();
    for (entry, out) in out.iter_mut().enumerate() {
        *out = matrix.get(entry / n, entry % n);
    }
}

/// Products with the vectors of the probe, the diagonal and the last row: [`Quantity::MassMatrixProbe`].
///
/// # Errors
/// [`DimensionError`] when a vector's length is not the matrix' width.
pub fn probe<T: Real>(matrix: &TreeSparse<T>, vectors: &[T], out: &mut [T]) -> Result<(), DimensionError> {
    let n = matrix.size();
    let (products, rest) = out.split_at_mut(vectors.len());
    for (x, y) in vectors.chunks_exact(n).zip(products.chunks_exact_mut(n)) {
        matrix.mul(x, y)?;
    }
    for (i, value) in rest.iter_mut().enumerate() {
        *value = if i < n { matrix.get(i, i) } else { matrix.get(n - 1, i - n) };
    }
    Ok(())
}

/// Placement, velocity or acceleration of each described body, as the quantity says.
///
/// `motion` gives the motion of a compiled body, and `described` the compiled bodies' indices.
pub fn bodies<T: Real>(quantity: Quantity, motion: impl Fn(usize) -> Option<BodyMotion<T>>, described: &[usize], out: &mut [T]) {
    let size = if quantity == Quantity::BodyPlacement { 12 } else { 6 };
    for (out, &body) in out.chunks_exact_mut(size).zip(described) {
        let Some(BodyMotion { placement, velocity, acceleration }) = motion(body) else { continue };
        match quantity {
            Quantity::BodyPlacement => {
                out[..9].copy_from_slice(&placement.rotation.to_array());
                out[9..].copy_from_slice(&placement.translation.to_array());
            }
            Quantity::BodyVelocity => out.copy_from_slice(&velocity.to_array()),
            _ => out.copy_from_slice(&acceleration.to_array()),
        }
    }
}

/// Products of a body's Jacobian with the first vectors of the probe: what [`Quantity::BodyJacobians`] has of a body. `entry` gives the
/// Jacobian's entries by row and dof.
///
/// One wrong column shows in both products. No lie that is drawn without the vectors is hidden by them.
pub fn jacobian_products(entry: impl Fn(usize, usize) -> f64, probe: &[f64], nv: usize, out: &mut [f64]) {
    for (x, out) in probe.chunks_exact(nv).zip(out.chunks_exact_mut(6)) {
        for (row, out) in out.iter_mut().enumerate() {
            *out = x.iter().enumerate().map(|(dof, x)| entry(row, dof) * x).sum();
        }
    }
}

/// A body's Jacobian, row after row.
pub fn jacobian<T: Real>(columns: &[Motion<T>], out: &mut [T]) {
    for (dof, column) in columns.iter().enumerate() {
        for (row, entry) in column.to_array().into_iter().enumerate() {
            out[row * columns.len() + dof] = entry;
        }
    }
}
