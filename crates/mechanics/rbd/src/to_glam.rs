//! Placements and vectors as types of glam, in double precision, and back.
//!
//! The version of glam is that of rapier3d.
//!
//! ```
//! use featherbench_rbd::{Robot, to_glam};
//! let robot = Robot::generated("chain:n=2")?;
//! let x = robot.placement(&[0.3; 2], robot.bodies()[1])?;
//! assert_eq!(to_glam::transform(&to_glam::affine(&x)), x);
//! # Ok::<(), featherbench_rbd::Error>(())
//! ```

use featherbench_spatial::{Mat3, Transform, Vec3};
use glam::{DAffine3, DMat3, DVec3};

/// A vector.
///
/// ```
/// use featherbench_rbd::{spatial::Vec3, to_glam};
/// assert_eq!(to_glam::vector(Vec3::new(1.0, 2.0, 3.0)), glam::DVec3::new(1.0, 2.0, 3.0));
/// ```
pub fn vector(v: Vec3<f64>) -> DVec3 {
    DVec3::from_array(v.to_array())
}

/// A rotation matrix. glam stores its columns, ours its rows.
///
/// ```
/// use featherbench_rbd::{spatial::Mat3, to_glam};
/// let turn = Mat3::from_array([0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
/// assert_eq!(to_glam::matrix(turn) * glam::DVec3::X, glam::DVec3::Y);
/// ```
pub fn matrix(r: Mat3<f64>) -> DMat3 {
    DMat3::from_cols_array(&r.transpose().to_array())
}

/// A placement.
///
/// ```
/// use featherbench_rbd::{spatial::Transform, to_glam};
/// assert_eq!(to_glam::affine(&Transform::identity()), glam::DAffine3::IDENTITY);
/// ```
pub fn affine(x: &Transform<f64>) -> DAffine3 {
    DAffine3 { matrix3: matrix(x.rotation), translation: vector(x.translation) }
}

/// A placement from glam. The matrix must be a rotation.
///
/// ```
/// use featherbench_rbd::{spatial::Transform, to_glam};
/// assert_eq!(to_glam::transform(&glam::DAffine3::IDENTITY), Transform::identity());
/// ```
pub fn transform(x: &DAffine3) -> Transform<f64> {
    Transform::new(Mat3::from_array(x.matrix3.to_cols_array()).transpose(), Vec3::from_array(x.translation.to_array()))
}
