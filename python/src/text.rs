//! What the documentation of several methods says in the same words.

/// Sections of a numpydoc text: `given q v` is the section of these parameters, `errors` that of the errors and the head of the examples.
///
/// Strings behind `errors` are further cases of `Error`. A name alone is one parameter.
macro_rules! text {
    (given $($name:ident)+) => { concat!("\nParameters\n----------", $("\n", text!($name)),+) };
    (errors $($more:literal)?) => { text!(errors of "float64." $($more)?) };
    (errors of $dtypes:literal $($more:literal)?) => {
        concat!(
            "\nRaises\n------\nError\n    Naming the argument whose shape or number of states does not fit, or that has a number that is not finite \
             or a quaternion of\n    zeros.",
            $("\n    ", $more,)?
            "\nTypeError\n    Naming the argument that is no array of ", $dtypes, "\n\nExamples\n--------",
        )
    };
    (q) => { "q : ndarray, shape (nq,) or (states, nq)\n    Configurations, rad and m; quaternions (x, y, z, w)." };
    (q_of_either) => {
        "q : ndarray, shape (nq,) or (states, nq)\n    Configurations, rad and m; quaternions (x, y, z, w); float64 or float32."
    };
    (v) => { "v : ndarray, shape (nv,) or (states, nv)\n    Velocities, rad/s and m/s; of a free joint [linear, angular] in body axes." };
    (a) => { "a : ndarray, shape (nv,) or (states, nv)\n    Accelerations, rad/s² and m/s²: the rates of the numbers in v." };
    (tau) => { "tau : ndarray, shape (nv,) or (states, nv)\n    Joint forces, N m and N; of a free joint [force, moment] in body axes." };
    (engine) => { "engine : {'pinocchio', 'mujoco', 'drake'}\n    The engine." };
    (frame) => { "frame : str\n    A body, or a frame that is fixed to one." };
    (threads) => { "threads : int, optional\n    Threads for many states; None takes all cores." };
    (out) => { "out : ndarray, optional\n    Where the result is written: C-contiguous, of its shape and of the dtype of q." };
}
pub(crate) use text;
