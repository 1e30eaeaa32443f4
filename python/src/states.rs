//! One function for one state or many: each state in a workspace, and states over threads.

use crate::Error;
use crate::arrays::{Doubles, Given, States, numbers, output};
use crate::robot::Robot;
use featherbench_rbd::{Error as LibraryError, Workspace};
use pyo3::prelude::*;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// States that one thread computes with one workspace: enough that making it costs little.
const AT_ONCE: usize = 64;

pub(crate) fn failed(error: LibraryError) -> PyErr {
    Error::new_err(error.to_string())
}

/// The pools of each number of threads. Making one takes longer than many calls.
static POOLS: Mutex<Option<HashMap<usize, Arc<rayon::ThreadPool>>>> = Mutex::new(None);

/// A pool of so many threads; 0 is all cores.
pub(crate) fn pool(threads: usize) -> PyResult<Arc<rayon::ThreadPool>> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let pools = pools.get_or_insert_with(HashMap::new);
    if let Some(pool) = pools.get(&threads) {
        return Ok(Arc::clone(pool));
    }
    let made = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let made = Arc::new(made.map_err(|error| Error::new_err(format!("threads={threads}: {error}")))?);
    pools.insert(threads, Arc::clone(&made));
    Ok(made)
}

/// The threads of `threads=`: `None` is all cores, which is 0 here.
///
/// # Errors
/// [`Error`] when it is zero or below.
pub(crate) fn threads(given: Option<i64>) -> PyResult<usize> {
    match given.map(usize::try_from) {
        None => Ok(0),
        Some(Ok(count)) if count > 0 => Ok(count),
        Some(_) => Err(Error::new_err(format!("threads is {}; give 1 or more, or None for all cores", given.unwrap_or_default()))),
    }
}

/// An argument: its name, the array, and its numbers per state.
pub(crate) type Argument<'a, 'py> = (&'static str, Given<'a, 'py>, usize);

/// The states that all arguments have.
///
/// # Errors
/// [`Error`] naming the argument with another number of states.
pub(crate) fn agreed(first: (&str, States), others: &[(&str, States)]) -> PyResult<()> {
    let count = |states: States| states.map_or_else(|| "no axis of states".to_owned(), |count| format!("{count} states"));
    match others.iter().find(|(_, states)| *states != first.1) {
        Some((name, states)) => Err(Error::new_err(format!("{name} has {}; {} has {}", count(*states), first.0, count(first.1)))),
        None => Ok(()),
    }
}

/// Computes `each` for every state of the arguments, in double precision.
///
/// # Errors
/// Those of the arguments, and the first state that fails.
pub(crate) fn map<'py, const N: usize>(
    py: Python<'py>,
    robot: &Robot,
    arguments: [Argument<'_, 'py>; N],
    shape: &[usize],
    given_threads: Option<i64>,
    each: impl Fn(&mut Workspace, [&[f64]; N], &mut [f64]) -> Result<(), LibraryError> + Sync,
) -> Doubles<'py> {
    let threads = threads(given_threads)?;
    let mut held = Vec::with_capacity(N);
    for (name, array, count) in arguments {
        held.push(numbers::<f64>(name, array, count)?);
    }
    let names = arguments.map(|(name, _, _)| name);
    let states: Vec<(&str, States)> = names.iter().zip(&held).map(|(name, held)| (*name, held.1)).collect();
    agreed(states[0], &states[1..])?;
    let (array, mut writable) = output::<f64>(py, None, states[0].1, shape)?;
    let result = writable.as_slice_mut()?;
    let mut slices: [&[f64]; N] = [&[]; N];
    for (slice, held) in slices.iter_mut().zip(&held) {
        *slice = held.0.as_slice()?;
    }
    let each_size: usize = shape.iter().product();
    let sizes = arguments.map(|(_, _, count)| count);
    let part = |state: usize| -> [&[f64]; N] {
        let mut parts = slices;
        for (part, size) in parts.iter_mut().zip(sizes) {
            *part = &part[state * size..(state + 1) * size];
        }
        parts
    };
    match states[0].1 {
        None => robot.with_workspace(|workspace| each(workspace, part(0), result)).map_err(failed)?,
        Some(0) => {}
        Some(_) => {
            let run = |first: usize, results: &mut [f64]| -> Result<(), (usize, LibraryError)> {
                let mut workspace = robot.robot.workspace();
                for (k, result) in results.chunks_exact_mut(each_size).enumerate() {
                    each(&mut workspace, part(first + k), result).map_err(|error| (first + k, error))?;
                }
                Ok(())
            };
            let pool = if threads == 1 { None } else { Some(pool(threads)?) };
            let done = py.detach(|| match pool {
                None => run(0, result),
                Some(pool) => pool.install(|| {
                    let chunks = result.par_chunks_mut(AT_ONCE * each_size).enumerate();
                    // The first state that fails is told, whatever the order of the threads.
                    let failures = chunks.filter_map(|(chunk, results)| run(chunk * AT_ONCE, results).err());
                    failures.min_by_key(|(state, _)| *state).map_or(Ok(()), Err)
                }),
            });
            done.map_err(|(state, error)| Error::new_err(format!("state {state}: {error}")))?;
        }
    }
    drop(writable);
    Ok(array)
}
