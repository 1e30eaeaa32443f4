//! The text of registers that is the same for all widths.

/// A register over a vector type of the processor, with its arithmetic, and its functions as a register of a batch.
///
/// `$enter` runs a closure with the instructions, `$kernel` a kernel. The build's registers have `$count` / `$groups` numbers.
macro_rules! register {
    (
        $(#[$doc:meta])*
        $name:ident($vector:ident): $scalar:ident, $count:literal, $groups:literal, transposed by $square:path, $side:literal;
        $enter:ident, $kernel:ident, $sin_cos:ident;
        $set:ident, $add:ident, $subtract:ident, $multiply:ident, $divide:ident, $root:ident, $multiply_add:ident
    ) => {
        $(#[$doc])*
        ///
        /// SAFETY of all its functions: there is no register unless the processor has the instructions
        /// ([`Instructions::check`](crate::batch::selected::Instructions::check)).
        #[derive(Clone, Copy, Debug)]
        #[repr(transparent)]
        pub struct $name($vector);

        impl $name {
            #[inline(always)]
            pub(super) fn new(numbers: [$scalar; $count]) -> Self {
                // SAFETY: of one size, and each bit pattern is a value of both.
                Self(unsafe { std::mem::transmute::<[$scalar; $count], $vector>(numbers) })
            }

            #[inline(always)]
            pub(super) fn as_array(&self) -> &[$scalar; $count] {
                // SAFETY: of one size, each bit pattern is a value of both, and the vector is aligned to more.
                unsafe { &*(&raw const *self).cast() }
            }
        }

        impl Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                // SAFETY: as the type says.
                Self(unsafe { $add(self.0, other.0) })
            }
        }

        impl Sub for $name {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                // SAFETY: as the type says.
                Self(unsafe { $subtract(self.0, other.0) })
            }
        }

        impl Mul for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                // SAFETY: as the type says.
                Self(unsafe { $multiply(self.0, other.0) })
            }
        }

        impl Div for $name {
            type Output = Self;
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                // SAFETY: as the type says.
                Self(unsafe { $divide(self.0, other.0) })
            }
        }

        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                // SAFETY: as the type says. The compiler makes −0 − x a change of sign.
                Self(unsafe { $subtract($set(-0.0), self.0) })
            }
        }

        impl AddAssign for $name {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl SubAssign for $name {
            #[inline(always)]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }

        impl MulAssign for $name {
            #[inline(always)]
            fn mul_assign(&mut self, other: Self) {
                *self = *self * other;
            }
        }

        impl Real for $name {
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                // SAFETY: as the type says.
                Self(unsafe { $set(value as $scalar) })
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                // SAFETY: as the type says.
                Self(unsafe { $multiply_add(self.0, factor.0, addend.0) })
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: as the type says.
                Self(unsafe { $root(self.0) })
            }

            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                $sin_cos(self)
            }

            #[inline(always)]
            fn reciprocal_or_zero(self) -> Self {
                (Self::one() / self).zero_where_zero(self)
            }

            #[inline(always)]
            fn min_lane(self) -> f64 {
                if self.has_nan() {
                    return f64::NAN;
                }
                // by halves: a factorization waits for this number
                let mut lanes = *self.as_array();
                let mut count = lanes.len();
                while count > 1 {
                    count /= 2;
                    for lane in 0..count {
                        let other = lanes[lane + count];
                        lanes[lane] = if other < lanes[lane] { other } else { lanes[lane] };
                    }
                }
                f64::from(lanes[0])
            }
        }

        impl Lift<$name> for $scalar {
            #[inline(always)]
            fn lift(self) -> $name {
                // SAFETY: as the type says.
                $name(unsafe { $set(self) })
            }
        }

        impl Register<$scalar> for $name {
            methods_of_register!($scalar, $count, $square, $side);
            kernels_of_register!($scalar, $kernel);

            #[inline(always)]
            fn load_rows(array: &[$scalar], each: usize, group: usize, buffer: &mut [Self]) {
                // SAFETY: as the type says.
                unsafe { load_rows(array, each, group, buffer) }
            }

            #[inline(always)]
            fn store_rows(results: &[Self], part: &mut [$scalar]) {
                // SAFETY: as the type says.
                unsafe { store_rows(results, part) }
            }

            #[inline(always)]
            fn are_finite(registers: &[Self]) -> bool {
                // SAFETY: as the type says.
                unsafe { are_finite(registers) }
            }

            #[inline(always)]
            fn load_lanes<'a>(
                array: &'a [<$scalar as Number>::Lanes],
                each: usize,
                group: usize,
                buffer: &'a mut [Self],
            ) -> &'a [Self] {
                const EACH: usize = $count / $groups;
                let array = &array[group * $groups * each..];
                // What stands in lanes without a state is a copy.
                let last = if array.len() < $groups * each { 0 } else { $groups - 1 };
                let groups: [_; $groups] = std::array::from_fn(|k| &array[k.min(last) * each..][..buffer.len()]);
                for (entry, register) in buffer.iter_mut().enumerate() {
                    let mut numbers = [[0.0; EACH]; $groups];
                    for (numbers, group) in numbers.iter_mut().zip(&groups) {
                        *numbers = *group[entry].as_array();
                    }
                    *register = Self::new(*numbers.as_flattened().first_chunk().expect("all lanes"));
                }
                buffer
            }

            #[inline(always)]
            fn store_lanes(results: &[Self], part: &mut [<$scalar as Number>::Lanes]) {
                const EACH: usize = $count / $groups;
                for (k, group) in part.chunks_exact_mut(results.len().max(1)).enumerate() {
                    for (to, from) in group.iter_mut().zip(results) {
                        *to.as_mut_array() = *from.as_array()[k * EACH..].first_chunk().expect("the lanes of a group");
                    }
                }
            }

            #[inline(always)]
            fn with_instructions<R>(work: impl FnOnce() -> R) -> R {
                // SAFETY: as the type says. The workers of a batch have registers, and work with them.
                unsafe { $enter(work) }
            }
        }
    };
}
pub(super) use register;

/// Functions with the instructions of a width: they run a closure or a kernel, which is compiled as a part of them, or bring rows into lanes.
macro_rules! functions_with {
    ($features:literal, $enter:ident, $kernel:ident) => {
        #[target_feature(enable = $features)]
        fn $enter<R>(work: impl FnOnce() -> R) -> R {
            work()
        }

        #[target_feature(enable = $features)]
        fn are_finite<T: Real>(registers: &[T]) -> bool {
            crate::batch::run::are_finite(registers)
        }

        #[target_feature(enable = $features)]
        fn load_rows<S: Copy, L: Register<S>>(array: &[S], each: usize, group: usize, buffer: &mut [L]) {
            L::load_rows_inlined(array, each, group, buffer);
        }

        #[target_feature(enable = $features)]
        fn store_rows<S: Copy, L: Register<S>>(results: &[L], part: &mut [S]) {
            L::store_rows_inlined(results, part);
        }

        /// A function of its own: row order and lane order share it.
        #[inline(always)]
        fn $kernel<'w, K: Inlined<N>, T: Real, P: Real + Lift<T>, const N: usize>(
            workspace: &'w mut Workspace<T>,
            model: &Model<P>,
            inputs: [&[T]; N],
            wrenches: Option<&[Force<T>]>,
        ) -> (&'w [T], Result<(), Error>) {
            #[target_feature(enable = $features)]
            #[inline(never)]
            fn apart<'w, K: Inlined<N>, T: Real, P: Real + Lift<T>, const N: usize>(
                workspace: &'w mut Workspace<T>,
                model: &Model<P>,
                inputs: [&[T]; N],
                wrenches: Option<&[Force<T>]>,
            ) -> (&'w [T], Result<(), Error>) {
                K::run(workspace, model, inputs, wrenches)
            }
            // SAFETY: a workspace of registers T exists, so the processor has their instructions.
            unsafe { apart::<K, T, P, N>(workspace, model, inputs, wrenches) }
        }
    };
}
pub(super) use functions_with;
