//! Registers of the widths that a batch selects at run time, wider than those of the build.
//!
//! Their operations are instructions that the processor may not have. So these types cannot be named outside of the module of batches, and there a
//! register is only made after [`Instructions::check`]. With a build that has the instructions itself, a width stands for the build's.

use super::register::Register;
use super::{NoSuchWidth, Width};

#[cfg(all(target_arch = "x86_64", not(all(target_feature = "avx2", target_feature = "fma"))))]
mod avx2;
#[cfg(all(target_arch = "x86_64", not(target_feature = "avx512f")))]
mod avx512;
#[cfg(all(target_arch = "x86_64", not(target_feature = "avx512f")))]
mod operations;
#[cfg(all(target_arch = "x86_64", not(target_feature = "avx512f")))]
mod turns;

#[cfg(test)]
mod tests;

/// AVX2 with fused multiply-add.
#[derive(Clone, Copy, Debug)]
pub struct Avx2;

/// AVX-512.
#[derive(Clone, Copy, Debug)]
pub struct Avx512;

/// Instructions, and the registers that they work on.
pub trait Instructions {
    /// Registers of doubles.
    type F64: Register<f64>;
    /// Registers of singles.
    type F32: Register<f32>;

    /// An error that names the width, unless this build selects it and this processor has it.
    fn check(width: Width) -> Result<(), NoSuchWidth>;
}

/// A number that has a register at every width.
pub trait Selectable: Copy {
    /// The register.
    type Register<I: Instructions>: Register<Self>;
}

impl Selectable for f64 {
    type Register<I: Instructions> = I::F64;
}

impl Selectable for f32 {
    type Register<I: Instructions> = I::F32;
}

/// Instructions that this build does not select.
#[cfg(not(all(target_arch = "x86_64", not(all(target_feature = "avx2", target_feature = "fma")))))]
macro_rules! as_built {
    ($instructions:ident) => {
        impl Instructions for $instructions {
            type F64 = <f64 as super::Number>::Lanes;
            type F32 = <f32 as super::Number>::Lanes;

            fn check(width: Width) -> Result<(), NoSuchWidth> {
                Err(NoSuchWidth::Build(width))
            }
        }
    };
}

#[cfg(not(all(target_arch = "x86_64", not(all(target_feature = "avx2", target_feature = "fma")))))]
as_built!(Avx2);
#[cfg(not(all(target_arch = "x86_64", not(target_feature = "avx512f"))))]
as_built!(Avx512);
