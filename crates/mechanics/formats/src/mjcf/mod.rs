//! MJCF, MuJoCo's format, read and written.
//!
//! The import is of what can be read without MuJoCo's compiler. It reads bodies, joints, inertials, shapes whose mass has a closed form,
//! classes, angles in degrees or radians, all orientations, and files that are included. What MuJoCo's compiler alone makes of a file is an
//! error that names it: repeated and attached parts, meshes without an inertial, masses that the compiler edits. `featherbench gen mjcf`
//! reads such files by MuJoCo.
//!
//! - Positions are MuJoCo's: a hinge with a `ref` is at its place in the file when its coordinate is `ref`; a free joint's are relative to
//!   the world. Quaternions end with w, and a free joint's velocity is in body axes, as everywhere here.
//! - A body with several joints becomes a chain of bodies. All but the last have no mass, and are named `body/joint`.
//! - A joint's frame is at its anchor. Where that is not the body's origin, a frame has the body's name.
//! - Bodies without joints are merged, each leaving a frame with its name.
//! - Left out with a note: springs, gravity compensation, limits of balls, the sections contact, equality, tendon, actuator, sensor, and
//!   any other attribute or element by its name, of whatever version of MJCF. Left out without one: names and numbers for the user, what is
//!   only seen (sites, cameras, lights, materials), assets, memory and keyframes.
//!
//! Limits: 10 MB, a million XML nodes, no document type declaration. Nesting uses no stack.
//!
//! Some of what a file holds besides is found by [`contents`].

mod contents;
mod equality;
mod joints;
mod quaternion;
mod read;
mod write;

pub use contents::{Contents, contents};
pub(crate) use quaternion::estimate;
pub use read::{LIMIT, MjcfError, MjcfProblem, Note, import, read};
pub use write::{to_string, write};
