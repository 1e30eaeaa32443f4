//! The truth about double-double numbers: the same operation by a multi-precision library, and the relative error in units of u² = 2⁻¹⁰⁶.

use dashu_float::round::mode::HalfEven;
use dashu_float::{DBig, FBig};
use featherbench_spatial::{DoubleDouble, Real};
use proptest::prelude::*;

/// A multi-precision number; its operators round to [`BITS`] bits.
pub type Big = FBig<HalfEven, 2>;

/// Sums of double-doubles whose exponents differ by some hundreds are exact in so many bits, and so are their products.
pub const BITS: usize = 2560;

/// A double-double as a multi-precision number, exactly.
pub fn exact(x: DoubleDouble) -> Big {
    let part = |x: f64| Big::try_from(x).expect("a finite number").with_precision(BITS).value();
    part(x.to_f64()) + part(x.rest())
}

/// A number from decimal digits; it keeps 100 significant digits at least.
pub fn parse(text: &str) -> Big {
    let decimal: DBig = text.parse().expect("a decimal number");
    decimal.with_base_and_precision::<2>(BITS).value().with_rounding()
}

/// The magnitude.
pub fn magnitude(x: &Big) -> Big {
    if *x < Big::ZERO { -x.clone() } else { x.clone() }
}

/// |x − truth| in units of 2⁻¹⁰⁶·|scale|; infinite if x is not finite.
pub fn error_in_u2(x: DoubleDouble, truth: &Big, scale: &Big) -> f64 {
    if !x.to_f64().is_finite() || !x.rest().is_finite() {
        return f64::INFINITY;
    }
    let error = magnitude(&(exact(x) - truth));
    if error == Big::ZERO {
        return 0.0;
    }
    if *scale == Big::ZERO {
        return f64::INFINITY;
    }
    (error / magnitude(scale)).to_f64().value() * 2.0_f64.powi(106)
}

/// Whether `hi` is the `f64` nearest to the sum of the parts.
pub fn is_normalized(x: DoubleDouble) -> bool {
    x.to_f64() + x.rest() == x.to_f64()
}

/// Double-doubles of both signs with exponents within `reach` of zero, all bits of both parts random, the lower part sometimes tiny.
pub fn double_double(reach: i32) -> impl Strategy<Value = DoubleDouble> {
    let significand = || {
        (any::<bool>(), 0..1_u64 << 52).prop_map(|(negative, bits)| {
            let x = f64::from_bits(1023 << 52 | bits);
            if negative { -x } else { x }
        })
    };
    let gap = prop_oneof![8 => Just(54), 2 => 54..60, 1 => 54..200];
    (significand(), significand(), -reach..=reach, gap).prop_map(|(hi, lo, exponent, gap)| {
        let unit = 2.0_f64.powi(exponent);
        DoubleDouble::from_sum(hi * unit, lo * unit * 2.0_f64.powi(-gap))
    })
}

/// A second operand that cancels most of the first: its negative with some of the lower digits changed.
pub fn nearly_opposite(x: DoubleDouble, change: f64) -> DoubleDouble {
    -(x + x * DoubleDouble::from_f64(change))
}
