//! Placements, 6-vectors and matrices as types of nalgebra, and back. A motion or force is [angular; linear].
//!
//! ```
//! use featherbench_rbd::{Robot, to_nalgebra};
//! let robot = Robot::generated("chain:n=2")?;
//! let x = robot.placement(&[0.3; 2], robot.bodies()[1])?;
//! let isometry = to_nalgebra::isometry(&x);
//! let back = to_nalgebra::transform(&isometry);
//! assert!(x.rotation.to_array().iter().zip(back.rotation.to_array()).all(|(x, back)| (x - back).abs() < 1e-15));
//! # Ok::<(), featherbench_rbd::Error>(())
//! ```

use featherbench_spatial::{Force, Mat3, Motion, Transform, Vec3};
use nalgebra::{Isometry3, Matrix3, Matrix6xX, Rotation3, Translation3, UnitQuaternion, Vector3, Vector6};

/// A vector.
///
/// ```
/// use featherbench_rbd::{spatial::Vec3, to_nalgebra};
/// assert_eq!(to_nalgebra::vector(Vec3::new(1.0, 2.0, 3.0)), nalgebra::Vector3::new(1.0, 2.0, 3.0));
/// ```
pub fn vector(v: Vec3<f64>) -> Vector3<f64> {
    Vector3::from(v.to_array())
}

/// A rotation matrix. Its entries are taken as they are.
///
/// ```
/// use featherbench_rbd::{spatial::Mat3, to_nalgebra};
/// assert_eq!(to_nalgebra::rotation(Mat3::identity()), nalgebra::Rotation3::identity());
/// ```
pub fn rotation(r: Mat3<f64>) -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::from_row_slice(&r.to_array()))
}

/// A placement.
///
/// ```
/// use featherbench_rbd::{spatial::Transform, to_nalgebra};
/// assert_eq!(to_nalgebra::isometry(&Transform::identity()), nalgebra::Isometry3::identity());
/// ```
pub fn isometry(x: &Transform<f64>) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_rotation_matrix(&rotation(x.rotation));
    Isometry3::from_parts(Translation3::from(vector(x.translation)), turn)
}

/// A placement from nalgebra.
///
/// ```
/// use featherbench_rbd::{spatial::Transform, to_nalgebra};
/// assert_eq!(to_nalgebra::transform(&nalgebra::Isometry3::identity()), Transform::identity());
/// ```
pub fn transform(x: &Isometry3<f64>) -> Transform<f64> {
    let r = x.rotation.to_rotation_matrix();
    let rows = [0, 1, 2].map(|i| Vec3::new(r[(i, 0)], r[(i, 1)], r[(i, 2)]));
    Transform::new(Mat3::from_rows(rows[0], rows[1], rows[2]), Vec3::new(x.translation.x, x.translation.y, x.translation.z))
}

/// A motion, [angular; linear].
///
/// ```
/// use featherbench_rbd::{spatial::Motion, to_nalgebra};
/// let motion = Motion::from_array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
/// assert_eq!(to_nalgebra::motion(motion), nalgebra::Vector6::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0));
/// ```
pub fn motion(m: Motion<f64>) -> Vector6<f64> {
    Vector6::from(m.to_array())
}

/// A force from nalgebra, [moment; force].
///
/// ```
/// use featherbench_rbd::to_nalgebra;
/// let force = to_nalgebra::force(&nalgebra::Vector6::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0));
/// assert_eq!(force.lin.to_array(), [4.0, 5.0, 6.0]);
/// ```
pub fn force(f: &Vector6<f64>) -> Force<f64> {
    Force::from_array((*f).into())
}

/// A Jacobian of 6 rows and a column per dof.
///
/// ```
/// use featherbench_rbd::{Robot, to_nalgebra};
/// let robot = Robot::generated("chain:n=3")?;
/// let j = to_nalgebra::jacobian(&robot.jacobian(&[0.1; 3], robot.bodies()[2])?);
/// assert_eq!(j.shape(), (6, 3));
/// # Ok::<(), featherbench_rbd::Error>(())
/// ```
pub fn jacobian(columns: &[Motion<f64>]) -> Matrix6xX<f64> {
    Matrix6xX::from_fn(columns.len(), |i, j| columns[j].to_array()[i])
}
