//! The inertial parameters π of a model: ten numbers for each described body, in which the equations of motion are linear.
//!
//! Order and frame: mass, first moments of mass (x, y, z), inertia about the body's *origin* (xx, xy, xz, yy, yz, zz), in the described axes
//! of the body. Bodies are in the order of the compiled model. Units: kg, kg·m, kg·m².

use featherbench_model::Model;
use featherbench_spatial::{Lift, Real, Sym3};

/// Parameters per body.
pub const PARAMETERS: usize = 10;

/// The parameters π of a model, body after body; it allocates.
///
/// ```
/// use featherbench_dynamics::{inertial_parameters, inverse_dynamics, torque_regressor};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=4,layout=spatial")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let (q, v, a) = (states.q(0), states.v(0), states.a(0));
/// let mut tau = [0.0; 4];
/// torque_regressor(&model, q, v, a)?.mul(&inertial_parameters(&model), &mut tau)?;
/// let expected = inverse_dynamics(&model, q, v, a)?;
/// assert!(tau.iter().zip(&expected).all(|(tau, expected)| (tau - expected).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn inertial_parameters<T: Real, P: Real + Lift<T>>(model: &Model<P>) -> Vec<T> {
    let of_body = |&body: &usize| {
        let (inertia, label) = (model.inertias[body].lift::<T>(), model.labels[body]);
        // B Ī Bᵀ
        let half = label.rotation_to_described(inertia.rotational.to_mat3()).transpose();
        let rotational = Sym3::from_upper(label.rotation_to_described(half)).to_array();
        [inertia.mass].into_iter().chain(label.to_described(inertia.first_moment).to_array()).chain(rotational)
    };
    model.described.iter().flat_map(of_body).collect()
}
