//! The kernels over `f64` that are compiled here, once, and linked by all crates that call them.
//!
//! A generic function that is never inlined is compiled by the first crate that needs it, and crates above that one link it. So each entry
//! point of a kernel is marked `inline(never)`, and this list needs those that several crates call. An instance that one crate calls is
//! compiled there: kernels over lanes, `f32` and duals in the crate `kernels`, those over double-double in `bench`, counted ones in the study
//! `scaling`.
//!
//! | instances over `f64` | beside the library and its tests, called by |
//! |---|---|
//! | [`Rnea`], [`Aba`], [`Crba`] | bench, constrained, contact, continua, residuals, uncertainty |
//! | [`Bias`], [`Kinematics`], [`Jacobian`] | constrained, contact, continua, learning |
//! | [`Ltdl`] | bench, constrained, kernels, uncertainty |
//! | [`IdDerivatives`], [`FdDerivatives`], [`Coriolis`] | kernels, lesson, uncertainty |
//! | [`Regressor`] | identification, kernels, uncertainty |

use crate::{
    Aba, Bias, CenterOfMass, Coriolis, Crba, Energy, FdDerivatives, IdDerivatives, Jacobian, Kinematics, Ltdl, Momentum, Regressor, Rnea,
};
use featherbench_model::Model;

/// The entry points, as addresses: naming one compiles it. A function that may be inlined is compiled where it is called, and this one is
/// called nowhere. Then a crate that is compiled with less optimisation would compile them for all.
#[doc(hidden)]
#[inline(never)]
pub fn instances() -> [*const (); 21] {
    [
        Model::<f64>::build as *const (),
        Rnea::<f64>::run::<f64> as *const (),
        Bias::<f64>::run::<f64> as *const (),
        Aba::<f64>::run::<f64> as *const (),
        Aba::<f64>::solve::<f64> as *const (),
        Crba::<f64>::run::<f64> as *const (),
        Kinematics::<f64>::run::<f64> as *const (),
        Jacobian::<f64>::run::<f64> as *const (),
        CenterOfMass::<f64>::run::<f64> as *const (),
        Momentum::<f64>::run::<f64> as *const (),
        Energy::<f64>::run::<f64> as *const (),
        Ltdl::<f64>::run as *const (),
        Ltdl::<f64>::factor as *const (),
        Ltdl::<f64>::solve as *const (),
        Ltdl::<f64>::inverse as *const (),
        Ltdl::<f64>::selected_inverse as *const (),
        IdDerivatives::<f64>::run::<f64> as *const (),
        FdDerivatives::<f64>::run::<f64> as *const (),
        Coriolis::<f64>::run::<f64> as *const (),
        Regressor::<f64>::torque::<f64> as *const (),
        Regressor::<f64>::energy::<f64> as *const (),
    ]
}
