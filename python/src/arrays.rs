//! Arrays of numpy as slices: checked by name, and not copied where they are contiguous.

use crate::Error;
use featherbench_rbd::dynamics::Number;
use numpy::{
    Element, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyReadwriteArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// An argument of a method.
pub(crate) type Given<'a, 'py> = &'a Bound<'py, PyAny>;

/// A new array of float64, or the exception.
pub(crate) type Doubles<'py> = PyResult<Bound<'py, PyArrayDyn<f64>>>;

/// The scalars that arrays can have.
pub(crate) trait Scalar: Element + Number + Copy + Send + Sync {}
impl Scalar for f64 {}
impl Scalar for f32 {}

/// Whether an array is `float64` (true) or `float32` (false).
///
/// # Errors
/// `TypeError`, naming the argument.
pub(crate) fn is_double(name: &str, array: Given<'_, '_>) -> PyResult<bool> {
    // The usual case first: of one state the call itself is most of the time.
    if array.cast::<PyArrayDyn<f64>>().is_ok() {
        return Ok(true);
    }
    let Ok(array) = array.cast::<PyUntypedArray>() else {
        let kind = array.get_type().name()?;
        return Err(PyTypeError::new_err(format!("{name} is of type {kind}; give a numpy array of float64 or float32")));
    };
    let dtype = array.dtype();
    if dtype.is_equiv_to(&numpy::dtype::<f32>(array.py())) {
        Ok(false)
    } else {
        Err(PyTypeError::new_err(format!("{name} has dtype {dtype}; give float64 or float32, in the byte order of the machine")))
    }
}

/// The numbers of an argument, row after row.
pub(crate) enum Numbers<'py, S: Scalar> {
    /// Those of the array itself.
    Borrowed(PyReadonlyArrayDyn<'py, S>),
    /// A copy of an array with gaps, or in another order.
    Copied(Vec<S>),
}

impl<S: Scalar> Numbers<'_, S> {
    pub(crate) fn as_slice(&self) -> PyResult<&[S]> {
        match self {
            Self::Borrowed(array) => Ok(array.as_slice()?),
            Self::Copied(values) => Ok(values),
        }
    }
}

/// How many states an argument has: `None` for one state without an axis for them.
pub(crate) type States = Option<usize>;

/// The numbers of an argument of shape (each,) or (states, each), and how many states it has.
///
/// # Errors
/// `TypeError` of the dtype, [`Error`] of the shape; both name the argument.
pub(crate) fn numbers<'py, S: Scalar>(name: &str, array: Given<'_, 'py>, each: usize) -> PyResult<(Numbers<'py, S>, States)> {
    let Ok(array) = array.cast::<PyArrayDyn<S>>() else {
        // Which error it is: no array, or another dtype than that of q.
        is_double(name, array)?;
        return Err(PyTypeError::new_err(format!("{name} has another dtype than q; give {}", numpy::dtype::<S>(array.py()))));
    };
    let states = match *array.shape() {
        [count] if count == each => None,
        [states, count] if count == each => Some(states),
        ref shape => return Err(Error::new_err(format!("{name} has shape {}; give ({each},) or (states, {each})", shown(shape)))),
    };
    let readonly = array.try_readonly().map_err(|_| Error::new_err(format!("{name} is written by another call at the same time")))?;
    let numbers =
        if array.is_c_contiguous() { Numbers::Borrowed(readonly) } else { Numbers::Copied(readonly.as_array().iter().copied().collect()) };
    Ok((numbers, states))
}

/// The array for a result: `out` if it is given, or a new one.
///
/// # Errors
/// `TypeError` of the dtype, [`Error`] of the shape, the strides or of an array that cannot be written; each names `out`.
pub(crate) fn output<'py, S: Scalar>(
    py: Python<'py>,
    out: Option<Given<'_, 'py>>,
    states: States,
    shape: &[usize],
) -> PyResult<(Bound<'py, PyArrayDyn<S>>, PyReadwriteArrayDyn<'py, S>)> {
    let full: Vec<usize> = states.into_iter().chain(shape.iter().copied()).collect();
    let array = match out {
        None => PyArrayDyn::<S>::zeros(py, full, false),
        Some(out) => {
            let Ok(array) = out.cast::<PyArrayDyn<S>>() else {
                is_double("out", out)?;
                return Err(PyTypeError::new_err(format!("out has another dtype than q; give {}", numpy::dtype::<S>(py))));
            };
            if array.shape() != full {
                return Err(Error::new_err(format!("out has shape {}; give {}", shown(array.shape()), shown(&full))));
            }
            if !array.is_c_contiguous() {
                return Err(Error::new_err("out has gaps or another order than rows; give a C-contiguous array"));
            }
            array.clone()
        }
    };
    let refused = |_| Error::new_err("out cannot be written: it is read-only, or it is one of the other arguments");
    let writable = array.try_readwrite().map_err(refused)?;
    Ok((array, writable))
}

/// A shape as Python writes it.
fn shown(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        many => format!("({})", many.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
    }
}
