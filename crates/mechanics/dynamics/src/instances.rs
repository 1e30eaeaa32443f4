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
//!
//! Tests are compiled without optimisation. A debug build has more instances, so that their long sums are fast: those over double-double, duals
//! and duals of these, which the crate `bench` calls as well.

use crate::{
    Aba, Bias, CenterOfMass, Coriolis, Crba, Energy, FdDerivatives, IdDerivatives, Jacobian, Kinematics, Ltdl, Momentum, Regressor, Rnea,
};
use featherbench_model::Model;
#[cfg(debug_assertions)]
use {
    featherbench_spatial::{Counted, DoubleDouble, Dual},
    wide::f64x4,
};

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

/// Kernels over another scalar, as addresses.
#[cfg(debug_assertions)]
macro_rules! over {
    ($($scalar:ty),*) => {
        [$(
            [
                Rnea::<$scalar>::run::<f64> as *const (),
                Rnea::<$scalar>::run::<$scalar> as *const (),
                Bias::<$scalar>::run::<f64> as *const (),
                Aba::<$scalar>::run::<f64> as *const (),
                Aba::<$scalar>::run::<$scalar> as *const (),
                Crba::<$scalar>::run::<f64> as *const (),
                Ltdl::<$scalar>::factor as *const (),
                Ltdl::<$scalar>::solve as *const (),
            ],
        )*]
    };
}

/// What tests call besides.
#[cfg(debug_assertions)]
#[doc(hidden)]
#[inline(never)]
pub fn instances_of_tests() -> ([[*const (); 8]; 5], [*const (); 2]) {
    let lanes = [Ltdl::<f64x4>::factor as *const (), Ltdl::<f64x4>::solve as *const ()];
    (over!(Counted, Dual<f64>, Dual<Dual<f64>>, DoubleDouble, Dual<DoubleDouble>), lanes)
}
