//! The table of functions that a library answers with: the only unsafe code of engines in Rust.
#![allow(unsafe_code, reason = "the caller hands over pointers, and takes functions of C")]

use crate::layout::{Given, Method, RobotData, States};
use crate::{Refusal, Robot};
use std::ffi::{CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::slice::{from_raw_parts, from_raw_parts_mut};

/// `FEATHERBENCH_ORACLE_VERSION`.
const VERSION: u32 = 1;
/// `FB_REASON`.
const REASON: usize = 512;

/// `struct fb_oracle`.
#[repr(C)]
pub struct Table<R> {
    version: u32,
    engine: *const c_char,
    engine_version: *const c_char,
    build: *const c_char,
    methods: *const Method,
    method_count: usize,
    create: unsafe extern "C" fn(*const RobotData, *mut *mut R, *mut f64, *mut c_char) -> c_int,
    destroy: unsafe extern "C" fn(*mut R),
    states: unsafe extern "C" fn(*mut R, *const States, *mut c_char) -> c_int,
    ready: unsafe extern "C" fn(*mut R, usize, usize, *mut c_char) -> c_int,
    run: unsafe extern "C" fn(*mut R, usize, usize, usize, *mut c_char) -> c_int,
    read: unsafe extern "C" fn(*mut R, usize, *mut f64, *mut c_char) -> c_int,
}

/// A table with the texts that it points to.
pub struct Words<R>(
    /// The table.
    pub Table<R>,
);

// SAFETY: the texts and methods are never changed or freed, and the functions are given every handle.
unsafe impl<R> Send for Words<R> {}
// SAFETY: as above.
unsafe impl<R> Sync for Words<R> {}

/// How an engine was built, as [`crate::build::tell`] found it.
#[derive(Clone, Copy, Debug)]
pub struct Build {
    /// The engine's version.
    pub version: &'static str,
    /// The compiler and its version.
    pub compiler: &'static str,
    /// Its flags.
    pub flags: &'static str,
}

/// Gives a library its only symbol, which answers the table of a type with the trait [`Robot`].
#[macro_export]
macro_rules! export {
    ($robot:ty) => {
        /// The library's only symbol.
        #[allow(unsafe_code, reason = "a symbol that C finds has its own name")]
        #[unsafe(no_mangle)]
        extern "C" fn featherbench_oracle() -> *const $crate::Table<$robot> {
            static TABLE: std::sync::LazyLock<$crate::Words<$robot>> = std::sync::LazyLock::new(|| {
                $crate::table($crate::Build {
                    version: env!("ORACLE_VERSION"),
                    compiler: env!("ORACLE_COMPILER"),
                    flags: env!("ORACLE_FLAGS"),
                })
            });
            &TABLE.0
        }
    };
}

/// A text that is never freed.
fn text(words: &str) -> *const c_char {
    CString::new(words).unwrap_or_default().into_raw()
}

/// The table of an engine. It is made once and never freed.
pub fn table<R: Robot>(told: Build) -> Words<R> {
    let methods: Vec<Method> = R::METHODS.iter().map(|(quantity, name)| Method { quantity: text(quantity), name: text(name) }).collect();
    let methods = methods.leak();
    let Build { version, compiler, flags } = told;
    Words(Table {
        version: VERSION,
        engine: text(R::ENGINE),
        engine_version: text(version),
        build: text(&format!("language=Rust\ncompiler={compiler}\nflags={flags}")),
        method_count: methods.len(),
        methods: methods.as_ptr(),
        create,
        destroy,
        states,
        ready,
        run,
        read,
    })
}

/// The status of a call. An error or a panic writes its reason.
fn guarded<R: Robot>(reason: *mut c_char, call: impl FnOnce() -> Result<(), Refusal>) -> c_int {
    let result = catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|_| Err(Refusal::Failed(format!("{} panicked", R::ENGINE))));
    let (status, words) = match result {
        Ok(()) => return 0,
        Err(Refusal::Unsupported(words)) => (1, words),
        Err(Refusal::Failed(words)) => (2, words),
    };
    let mut end = words.len().min(REASON - 1);
    while !words.is_char_boundary(end) {
        end -= 1;
    }
    // SAFETY: the caller gives room for REASON bytes.
    unsafe {
        ptr::copy_nonoverlapping(words.as_ptr(), reason.cast(), end);
        *reason.add(end) = 0;
    }
    status
}

unsafe extern "C" fn create<R: Robot>(data: *const RobotData, handle: *mut *mut R, readback: *mut f64, reason: *mut c_char) -> c_int {
    guarded::<R>(reason, || {
        // SAFETY: by the header the pointers are valid during the call, and the arrays have these lengths.
        let (data, bodies, dof_parents, readback) = unsafe {
            let data = &*data;
            let bodies = from_raw_parts(data.body, data.bodies);
            (data, bodies, from_raw_parts(data.dof_parent, data.nv), from_raw_parts_mut(readback, 22 * data.bodies))
        };
        let given = Given { bodies, gravity: data.gravity, sizes: [data.nq, data.nv], dof_parents };
        let robot = R::new(&given, readback)?;
        // SAFETY: as above.
        unsafe { *handle = Box::into_raw(Box::new(robot)) };
        Ok(())
    })
}

unsafe extern "C" fn destroy<R: Robot>(handle: *mut R) {
    // SAFETY: it comes from `create` and is destroyed once.
    drop(unsafe { Box::from_raw(handle) });
}

unsafe extern "C" fn states<R: Robot>(handle: *mut R, states: *const States, reason: *mut c_char) -> c_int {
    guarded::<R>(reason, || {
        // SAFETY: the handle comes from `create`; the arrays have the lengths that the header says.
        let (robot, arrays) = unsafe {
            let (robot, states) = (&mut *handle, &*states);
            let rows = |array: *const f64, each: usize| from_raw_parts(array, states.count * each);
            let [nq, nv] = robot.sizes();
            (robot, [rows(states.q, nq), rows(states.v, nv), rows(states.a, nv), rows(states.tau, nv)])
        };
        robot.convert(arrays)
    })
}

unsafe extern "C" fn ready<R: Robot>(handle: *mut R, method: usize, body: usize, reason: *mut c_char) -> c_int {
    guarded::<R>(reason, || {
        // SAFETY: the handle comes from `create`.
        unsafe { &mut *handle }.ready(method, body)
    })
}

unsafe extern "C" fn run<R: Robot>(handle: *mut R, method: usize, first: usize, count: usize, reason: *mut c_char) -> c_int {
    guarded::<R>(reason, || {
        // SAFETY: the handle comes from `create`.
        unsafe { &mut *handle }.run(method, first, count)
    })
}

unsafe extern "C" fn read<R: Robot>(handle: *mut R, method: usize, value: *mut f64, reason: *mut c_char) -> c_int {
    guarded::<R>(reason, || {
        // SAFETY: the handle comes from `create`; the caller gives room for one value.
        let (robot, value) = unsafe {
            let robot = &mut *handle;
            let size = robot.size(method);
            (robot, from_raw_parts_mut(value, size))
        };
        robot.read(method, value)
    })
}
