//! The C interface of `../../native/oracle.h`, whose layouts are repeated here: the only unsafe code of this crate.
#![allow(unsafe_code, reason = "the caller hands over pointers, and takes functions of C")]

use crate::refusal::Refusal;
use crate::robot::{METHODS, Robot};
use std::ffi::{CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::slice::{from_raw_parts, from_raw_parts_mut};
use std::sync::LazyLock;

/// `FEATHERBENCH_ORACLE_VERSION`.
const VERSION: u32 = 1;
/// `FB_REASON`.
const REASON: usize = 512;

/// `struct fb_body`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Body {
    /// Index of the parent body, −1 for the world.
    pub parent: i32,
    /// A joint type: the place in [`JOINTS`].
    pub joint: i32,
    /// In kg.
    pub mass: f64,
    /// Centre of mass, in m, body axes.
    pub com: [f64; 3],
    /// xx, xy, xz, yy, yz, zz about the centre of mass, in kg m², body axes.
    pub inertia: [f64; 6],
    /// Unit vector of revolute, prismatic and helical joints.
    pub axis: [f64; 3],
    pitch: f64,
    /// Joint axes to parent axes, row-major.
    pub rotation: [f64; 9],
    /// The joint's origin in the parent's frame, in m.
    pub translation: [f64; 3],
    /// Per degree of freedom of the joint.
    pub armature: [f64; 6],
}

/// The joint types, in the order of their numbers.
pub const JOINTS: [&str; 7] = ["revolute", "prismatic", "helical", "spherical", "free", "planar", "universal"];

#[repr(C)]
struct RobotData {
    bodies: usize,
    nq: usize,
    nv: usize,
    body: *const Body,
    gravity: [f64; 3],
    dof_parent: *const i32,
}

#[repr(C)]
struct States {
    count: usize,
    q: *const f64,
    v: *const f64,
    a: *const f64,
    tau: *const f64,
}

#[repr(C)]
struct Method {
    quantity: *const c_char,
    name: *const c_char,
}

#[repr(C)]
struct Table {
    version: u32,
    engine: *const c_char,
    engine_version: *const c_char,
    build: *const c_char,
    methods: *const Method,
    method_count: usize,
    create: unsafe extern "C" fn(*const RobotData, *mut *mut Robot, *mut f64, *mut c_char) -> c_int,
    destroy: unsafe extern "C" fn(*mut Robot),
    states: unsafe extern "C" fn(*mut Robot, *const States, *mut c_char) -> c_int,
    ready: unsafe extern "C" fn(*mut Robot, usize, usize, *mut c_char) -> c_int,
    run: unsafe extern "C" fn(*mut Robot, usize, usize, usize, *mut c_char) -> c_int,
    read: unsafe extern "C" fn(*mut Robot, usize, *mut f64, *mut c_char) -> c_int,
}

/// The table with the texts that it points to.
struct Words(Table);

// SAFETY: the texts and methods are never changed or freed.
unsafe impl Send for Words {}
// SAFETY: as above.
unsafe impl Sync for Words {}

/// A text that is never freed.
fn text(words: &str) -> *const c_char {
    CString::new(words).unwrap_or_default().into_raw()
}

static TABLE: LazyLock<Words> = LazyLock::new(|| {
    let methods = METHODS.map(|(quantity, name)| Method { quantity: text(quantity), name: text(name) });
    let build = concat!("language=Rust\ncompiler=", env!("DYNIBO_COMPILER"), "\nflags=", env!("DYNIBO_FLAGS"));
    Words(Table {
        version: VERSION,
        engine: text("dynibo"),
        engine_version: text(env!("DYNIBO_VERSION")),
        build: text(build),
        method_count: methods.len(),
        methods: Box::leak(Box::new(methods)).as_ptr(),
        create,
        destroy,
        states,
        ready,
        run,
        read,
    })
});

/// The library's only symbol.
#[unsafe(no_mangle)]
extern "C" fn featherbench_oracle() -> *const Table {
    &TABLE.0
}

/// The status of a call. A refusal or a panic writes its reason.
fn guarded(reason: *mut c_char, call: impl FnOnce() -> Result<(), Refusal>) -> c_int {
    let result = catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|_| Err(Refusal::Failed("dynibo panicked".into())));
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

unsafe extern "C" fn create(data: *const RobotData, handle: *mut *mut Robot, readback: *mut f64, reason: *mut c_char) -> c_int {
    guarded(reason, || {
        // SAFETY: by the header the pointers are valid during the call, and the arrays have these lengths.
        let (data, bodies, dof_parents, readback) = unsafe {
            let data = &*data;
            let bodies = from_raw_parts(data.body, data.bodies);
            (data, bodies, from_raw_parts(data.dof_parent, data.nv), from_raw_parts_mut(readback, 22 * data.bodies))
        };
        let robot = Robot::new(bodies, data.gravity, [data.nq, data.nv], dof_parents, readback)?;
        // SAFETY: as above.
        unsafe { *handle = Box::into_raw(Box::new(robot)) };
        Ok(())
    })
}

unsafe extern "C" fn destroy(handle: *mut Robot) {
    // SAFETY: it comes from `create` and is destroyed once.
    drop(unsafe { Box::from_raw(handle) });
}

unsafe extern "C" fn states(handle: *mut Robot, states: *const States, reason: *mut c_char) -> c_int {
    guarded(reason, || {
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

unsafe extern "C" fn ready(handle: *mut Robot, _: usize, body: usize, reason: *mut c_char) -> c_int {
    guarded(reason, || {
        // SAFETY: the handle comes from `create`.
        unsafe { &mut *handle }.aim(body)
    })
}

unsafe extern "C" fn run(handle: *mut Robot, method: usize, first: usize, count: usize, reason: *mut c_char) -> c_int {
    guarded(reason, || {
        // SAFETY: the handle comes from `create`.
        unsafe { &mut *handle }.run(method, first, count)
    })
}

unsafe extern "C" fn read(handle: *mut Robot, method: usize, value: *mut f64, reason: *mut c_char) -> c_int {
    guarded(reason, || {
        // SAFETY: the handle comes from `create`; the caller gives room for one value.
        let (robot, value) = unsafe {
            let robot = &*handle;
            (robot, from_raw_parts_mut(value, robot.size(method)))
        };
        robot.read(method, value);
        Ok(())
    })
}
