//! The Python package `featherbench`: robots and their dynamics on numpy arrays.

mod arrays;
mod coordinates;
mod quantities;
mod robot;
mod states;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

pyo3::create_exception!(
    featherbench,
    Error,
    PyValueError,
    "A file that cannot be read, an argument that does not fit the robot, or a state without an answer."
);

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_class::<robot::Robot>()?;
    module.add_class::<robot::Joint>()
}
