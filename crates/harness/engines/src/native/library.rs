//! The library of a native oracle, behind the C interface of `oracles/native/oracle.h`: the only unsafe code of this crate.
//!
//! The layouts below repeat that header. What a library does inside its functions cannot be checked from here. So it is loaded in a child
//! process only. Everything that can be checked is checked: the version of the interface, missing functions, indices, and lengths.
#![allow(unsafe_code, reason = "the functions of a foreign library cannot be called otherwise")]

use featherbench_bench::{NoAnswer, Robot};
use featherbench_model::JointType;
use std::ffi::{CStr, c_char, c_int};
use std::path::Path;
use std::ptr::{self, NonNull};

/// `FEATHERBENCH_ORACLE_VERSION`.
const VERSION: u32 = 1;
/// `FB_REASON`.
const REASON: usize = 512;
/// `FB_OK` and `FB_UNSUPPORTED`; everything else is a failure.
const OK: c_int = 0;
const UNSUPPORTED: c_int = 1;

/// `struct fb_handle`, opaque.
#[repr(C)]
struct Handle {
    _private: [u8; 0],
}

/// `struct fb_body`.
#[repr(C)]
struct Body {
    parent: i32,
    joint: i32,
    mass: f64,
    com: [f64; 3],
    inertia: [f64; 6],
    axis: [f64; 3],
    pitch: f64,
    rotation: [f64; 9],
    translation: [f64; 3],
    armature: [f64; 6],
}

/// `struct fb_robot`.
#[repr(C)]
struct RobotData {
    bodies: usize,
    nq: usize,
    nv: usize,
    body: *const Body,
    gravity: [f64; 3],
    dof_parent: *const i32,
}

/// `struct fb_states`.
#[repr(C)]
struct States {
    count: usize,
    q: *const f64,
    v: *const f64,
    a: *const f64,
    tau: *const f64,
}

/// `struct fb_method`.
#[repr(C)]
struct Method {
    quantity: *const c_char,
    name: *const c_char,
}

type Create = unsafe extern "C" fn(*const RobotData, *mut *mut Handle, *mut f64, *mut c_char) -> c_int;
type Destroy = unsafe extern "C" fn(*mut Handle);
type SetStates = unsafe extern "C" fn(*mut Handle, *const States, *mut c_char) -> c_int;
type Ready = unsafe extern "C" fn(*mut Handle, usize, usize, *mut c_char) -> c_int;
type Run = unsafe extern "C" fn(*mut Handle, usize, usize, usize, *mut c_char) -> c_int;
type Read = unsafe extern "C" fn(*mut Handle, usize, *mut f64, *mut c_char) -> c_int;

/// `struct fb_oracle`. Functions are optional here: a null pointer must never become a function.
#[repr(C)]
struct Table {
    version: u32,
    engine: *const c_char,
    engine_version: *const c_char,
    build: *const c_char,
    methods: *const Method,
    method_count: usize,
    create: Option<Create>,
    destroy: Option<Destroy>,
    states: Option<SetStates>,
    ready: Option<Ready>,
    run: Option<Run>,
    read: Option<Read>,
}

/// A loaded library.
pub(super) struct Library {
    /// The engine's name.
    pub(super) engine: String,
    /// Its version.
    pub(super) version: String,
    /// Lines of `key=value`.
    pub(super) build: String,
    /// (quantity, method), in the library's order.
    pub(super) methods: Vec<(String, String)>,
    create: Create,
    destroy: Destroy,
    states: SetStates,
    ready: Ready,
    run: Run,
    read: Read,
    /// Declared last, so that it is dropped after everything that points into it.
    _library: libloading::Library,
}

impl Library {
    /// Loads a library and reads its table.
    ///
    /// # Errors
    /// A sentence, when it cannot be loaded or does not have this version of the interface.
    pub(super) fn open(path: &Path) -> Result<Self, String> {
        let complaint = |what: &str| format!("{}: {what}", path.display());
        // SAFETY: loading runs the library's initialisers. They are trusted like the code that is timed, and run in this child process.
        let library = unsafe { libloading::Library::new(path) }.map_err(|error| complaint(&error.to_string()))?;
        // SAFETY: the header declares this symbol as a function of this type, and nothing else is exported under the name.
        let entry = unsafe { library.get::<unsafe extern "C" fn() -> *const Table>(b"featherbench_oracle") };
        let entry = entry.map_err(|_| complaint("it exports no featherbench_oracle: it is not a native oracle"))?;
        // SAFETY: the function takes nothing, and returns null or a table that is valid as long as the library is loaded.
        let table = unsafe { entry().as_ref() }.ok_or_else(|| complaint("it has no table"))?;
        // The version is the first field in every version of the table, so reading it is sound whatever follows.
        if table.version != VERSION {
            return Err(complaint(&format!("it has version {} of the interface, this program {VERSION}", table.version)));
        }
        let text = |words: *const c_char| -> Result<String, String> {
            if words.is_null() {
                return Err(complaint("a text of its table is missing"));
            }
            // SAFETY: not null, and by the header a text that ends with a zero and is valid as long as the library is loaded.
            Ok(unsafe { CStr::from_ptr(words) }.to_string_lossy().into_owned())
        };
        let listed = if table.methods.is_null() {
            &[]
        } else {
            // SAFETY: not null, and by the header an array of that many methods, valid as long as the library is loaded.
            unsafe { std::slice::from_raw_parts(table.methods, table.method_count) }
        };
        let methods = listed.iter().map(|method| Ok((text(method.quantity)?, text(method.name)?))).collect::<Result<_, String>>()?;
        let missing = || complaint("a function of its table is missing");
        Ok(Self {
            engine: text(table.engine)?,
            version: text(table.engine_version)?,
            build: text(table.build)?,
            methods,
            create: table.create.ok_or_else(missing)?,
            destroy: table.destroy.ok_or_else(missing)?,
            states: table.states.ok_or_else(missing)?,
            ready: table.ready.ok_or_else(missing)?,
            run: table.run.ok_or_else(missing)?,
            read: table.read.ok_or_else(missing)?,
            _library: library,
        })
    }

    /// Builds a robot. Returns it with the numbers that the engine has, as [`featherbench_bench::Quantity::Readback`].
    ///
    /// # Errors
    /// [`NoAnswer`], with the engine's reason.
    pub(super) fn build(&self, robot: &Robot) -> Result<(Built<'_>, Vec<f64>), NoAnswer> {
        let bodies: Vec<Body> = robot.description.bodies.iter().map(body).collect::<Result<_, _>>()?;
        let topology = &robot.model.topology;
        let index = |parent: &Option<usize>| parent.map_or(-1, |parent| parent as i32);
        let dof_parent: Vec<i32> = topology.dof_parents().iter().map(index).collect();
        let data = RobotData {
            bodies: bodies.len(),
            nq: robot.description.nq(),
            nv: topology.nv(),
            body: bodies.as_ptr(),
            gravity: robot.description.gravity,
            dof_parent: dof_parent.as_ptr(),
        };
        let mut readback = vec![f64::NAN; featherbench_bench::Quantity::Readback.size(robot)];
        let mut handle = ptr::null_mut();
        // SAFETY: the robot's arrays have the announced lengths and outlive the call; `readback` has 22 numbers per body.
        checked(|reason| unsafe { (self.create)(&data, &mut handle, readback.as_mut_ptr(), reason) })?;
        let handle = NonNull::new(handle).ok_or_else(|| NoAnswer::Failed("the library made nothing and did not say why".into()))?;
        Ok((Built { library: self, handle, nq: data.nq, nv: data.nv, count: 0, ready: None }, readback))
    }
}

/// A body as `oracle.h` has it. A joint without a number there is an error that names it.
fn body(body: &featherbench_model::BodyDescription) -> Result<Body, NoAnswer> {
    let (joint, axis, pitch) = match body.joint.kind {
        JointType::Revolute { axis } => (0, axis, 0.0),
        JointType::Prismatic { axis } => (1, axis, 0.0),
        JointType::Helical { axis, pitch } => (2, axis, pitch),
        JointType::Spherical => (3, [0.0; 3], 0.0),
        JointType::Free => (4, [0.0; 3], 0.0),
        JointType::Planar => (5, [0.0; 3], 0.0),
        JointType::Universal => (6, [0.0; 3], 0.0),
        _ => {
            let reason = format!("native oracles take no {} joint ({})", body.joint.kind.name(), body.joint.name);
            return Err(NoAnswer::NotOffered(reason));
        }
    };
    let mut armature = [0.0; 6];
    armature.iter_mut().zip(&body.joint.armature).for_each(|(to, from)| *to = *from);
    let placement = &body.joint.placement;
    Ok(Body {
        parent: body.parent.map_or(-1, |parent| parent as i32),
        joint,
        mass: body.mass,
        com: body.com,
        inertia: body.inertia,
        axis,
        pitch,
        rotation: placement.rotation,
        translation: placement.translation,
        armature,
    })
}

/// A robot in the engine.
pub(super) struct Built<'a> {
    library: &'a Library,
    handle: NonNull<Handle>,
    nq: usize,
    nv: usize,
    count: usize,
    /// The method and body that are ready for these states.
    ready: Option<(usize, usize)>,
}

impl Built<'_> {
    /// Gives the engine a batch of states: q, v, a and τ, row after row.
    ///
    /// # Errors
    /// [`NoAnswer`], when the arrays are not as long as they should be or the engine fails.
    pub(super) fn states(&mut self, count: usize, [q, v, a, tau]: [&[f64]; 4]) -> Result<(), NoAnswer> {
        (self.count, self.ready) = (0, None);
        if count == 0 || q.len() != count * self.nq || [v, a, tau].iter().any(|array| array.len() != count * self.nv) {
            return Err(NoAnswer::Failed(format!("these are not {count} states of this robot")));
        }
        let states = States { count, q: q.as_ptr(), v: v.as_ptr(), a: a.as_ptr(), tau: tau.as_ptr() };
        // SAFETY: the handle is valid; the arrays have the announced lengths and outlive the call.
        checked(|reason| unsafe { (self.library.states)(self.handle.as_ptr(), &states, reason) })?;
        self.count = count;
        Ok(())
    }

    /// The states that the engine holds.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The last method and body that are ready for these states.
    pub(super) fn is_ready(&self) -> Option<(usize, usize)> {
        self.ready
    }

    /// Prepares the input of a method, unless that is done.
    ///
    /// # Errors
    /// [`NoAnswer`], when there are no states or no such method, or the engine fails.
    pub(super) fn ready(&mut self, method: usize, body: usize) -> Result<(), NoAnswer> {
        if self.count == 0 || method >= self.library.methods.len() {
            return Err(NoAnswer::Failed("there are no states, or there is no such method".into()));
        }
        if self.ready != Some((method, body)) {
            self.ready = None;
            // SAFETY: the handle is valid and has states; the method is one of the table's.
            checked(|reason| unsafe { (self.library.ready)(self.handle.as_ptr(), method, body, reason) })?;
            self.ready = Some((method, body));
        }
        Ok(())
    }

    /// Evaluates states by the method that is ready: what is timed.
    ///
    /// # Errors
    /// [`NoAnswer`], when none is ready or the engine fails.
    pub(super) fn run(&mut self, first: usize, count: usize) -> Result<(), NoAnswer> {
        let (method, _) = self.ready.ok_or_else(|| NoAnswer::Failed("no method is ready".into()))?;
        // SAFETY: the handle is valid, has states, and the method is ready; states beyond the batch begin again.
        checked(|reason| unsafe { (self.library.run)(self.handle.as_ptr(), method, first, count, reason) })
    }

    /// Writes the value of the last state that was run, which has `value.len()` numbers.
    ///
    /// # Errors
    /// [`NoAnswer`], when no method is ready or the engine fails.
    pub(super) fn read(&mut self, value: &mut [f64]) -> Result<(), NoAnswer> {
        let (method, _) = self.ready.ok_or_else(|| NoAnswer::Failed("no method is ready".into()))?;
        // SAFETY: the handle is valid and the method was run; the caller gives space for one value of its quantity, by `Quantity::size`.
        checked(|reason| unsafe { (self.library.read)(self.handle.as_ptr(), method, value.as_mut_ptr(), reason) })
    }
}

impl Drop for Built<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle came from `create` and is destroyed once.
        unsafe { (self.library.destroy)(self.handle.as_ptr()) }
    }
}

/// A call with space for its reason.
fn checked(call: impl FnOnce(*mut c_char) -> c_int) -> Result<(), NoAnswer> {
    let mut reason = [0_u8; REASON];
    let status = call(reason.as_mut_ptr().cast());
    let words = || match CStr::from_bytes_until_nul(&reason) {
        Ok(words) if !words.is_empty() => words.to_string_lossy().into_owned(),
        _ => "the library gives no reason".to_owned(),
    };
    match status {
        OK => Ok(()),
        UNSUPPORTED => Err(NoAnswer::NotOffered(words())),
        _ => Err(NoAnswer::Failed(words())),
    }
}
