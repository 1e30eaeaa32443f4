//! The Python package `featherbench`: robots and their dynamics on numpy arrays.

mod arrays;
mod coordinates;
mod kinematics;
mod quantities;
mod rates;
mod robot;
mod states;
mod text;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

pyo3::create_exception!(
    featherbench,
    Error,
    PyValueError,
    "A file that cannot be read, an argument that does not fit the robot, or a state without an answer."
);

/// Hash bytes as `checksums.txt` of a run does: BLAKE3, in hexadecimal digits.
#[pyfunction]
fn checksum(content: &[u8]) -> String {
    blake3::hash(content).to_hex().to_string()
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_function(wrap_pyfunction!(checksum, module)?)?;
    module.add_class::<robot::Robot>()?;
    module.add_class::<robot::Joint>()
}
