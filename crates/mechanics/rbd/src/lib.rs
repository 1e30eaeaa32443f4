//! Rigid-body dynamics of robots, for a program that is no benchmark.
//!
//! ```
//! use featherbench_rbd::Robot;
//!
//! # let text = r#"<robot name="arm"><link name="world"/><link name="upper"><inertial><origin xyz="0 0 -0.2"/><mass value="2"/>
//! #     <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.001"/></inertial></link><link name="lower"><inertial>
//! #     <origin xyz="0 0 -0.15"/><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.001"/></inertial></link>
//! #     <joint name="shoulder" type="continuous"><parent link="world"/><child link="upper"/><axis xyz="0 1 0"/></joint>
//! #     <joint name="elbow" type="continuous"><origin xyz="0 0 -0.4"/><parent link="upper"/><child link="lower"/>
//! #     <axis xyz="0 1 0"/></joint>
//! #     </robot>"#;
//! # let file = std::env::temp_dir().join("featherbench_library_arm.urdf");
//! # std::fs::write(&file, text)?;
//! let robot = Robot::from_urdf(&file)?;
//! let (mut q, v, a) = (robot.neutral(), vec![0.0; robot.nv()], vec![0.0; robot.nv()]);
//! q[robot.joint("elbow")?.q.start] = 1.2;
//!
//! let tau = robot.inverse_dynamics(&q, &v, &a)?; // what holds it there
//! let fall = robot.forward_dynamics(&q, &v, &[0.0, 0.0])?; // how it falls
//! let matrix = robot.mass_matrix(&q)?.to_dense();
//! let hand = robot.placement(&q, "lower")?.translation;
//! let jacobian = robot.jacobian(&q, "lower")?;
//! # assert!((hand.z + 0.4).abs() < 1e-15 && tau[1] > 0.0 && fall[1] < 0.0 && matrix[(0, 1)] > 0.0 && jacobian.len() == 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! - [`Robot`]: reading, names, and each quantity once.
//! - [`Workspace`]: each quantity again and again, without an allocation.
//! - [`Robot::batch`]: many states at once, on all cores, in `f64` or `f32`.
//! - [`Convention`]: Pinocchio's, MuJoCo's and Drake's coordinates, and back.
//! - [`Error`]: what can go wrong. A number that is not finite and a quaternion of zeros are errors, and a result is always finite.
//! - Features `nalgebra` and `glam`: `to_nalgebra` and `to_glam`.
//!
//! What is here in [`spatial`], [`model`], [`formats`], [`dynamics`] and [`robots`] is all of these crates: second derivatives, regressors,
//! integrators and more.
//!
//! [`Robot::from_mjcf`] reads what needs no compiler of MuJoCo. `featherbench gen mjcf --file IN --out OUT.json` compiles the rest by MuJoCo, and
//! writes what [`Robot::from_json`] reads.
//!
//! # Conventions
//!
//! | | |
//! |---|---|
//! | order of q and v | depth-first; siblings in the order of the file |
//! | quaternions | (x, y, z, w); a quaternion q stands for q/‖q‖ |
//! | free joint | q = [origin; quaternion], v = [linear; angular], both in *body* axes |
//! | spherical joint | q = quaternion, v = angular velocity in body axes |
//! | 6-vectors | [angular; linear], [moment; force] |
//! | motions and Jacobians | of the frame's origin, in world axes; accelerations are classical and contain no gravity |
//! | derivatives by q | on the tangent space: q moves as v = e_j moves it |
//! | units | SI, radians |

mod configuration;
mod convention;
mod coordinates;
mod error;
mod pinocchio;
mod quantities;
mod reading;
mod robot;
#[cfg(feature = "glam")]
pub mod to_glam;
#[cfg(feature = "nalgebra")]
pub mod to_nalgebra;
mod workspace;

pub use convention::Convention;
pub use error::Error;
pub use robot::{Frame, Joint, Robot};
pub use workspace::{Bodies, Workspace};

pub use featherbench_dynamics as dynamics;
pub use featherbench_formats as formats;
pub use featherbench_model as model;
pub use featherbench_robots as robots;
pub use featherbench_spatial as spatial;
