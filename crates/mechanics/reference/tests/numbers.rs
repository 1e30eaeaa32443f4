//! The arithmetic of the reference: rounding, texts, and sine and cosine against a series written here, for huge and tiny arguments.

use crate::support;

use featherbench_reference::{Error, Mp, Precision, nearest_doubles};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use support::close;

const BITS: [Precision; 3] = [Precision::bits(106), Precision::STANDARD, Precision::bits(1506)];

/// π by Machin's formula 16 arctan(1/5) − 4 arctan(1/239): sums and quotients only.
fn machin(precision: Precision) -> Mp {
    let arctan = |inverse: i64| {
        let mut power = precision.integer(1) / precision.integer(inverse);
        let square = precision.integer(inverse * inverse);
        let (mut sum, mut k) = (power.clone(), 1);
        while power.to_f64() != 0.0 || k < i64::try_from(precision.get()).unwrap() {
            power = -(power / &square);
            k += 2;
            sum = sum + &power / precision.integer(k);
        }
        sum
    };
    precision.integer(16) * arctan(5) - precision.integer(4) * arctan(239)
}

/// sin x and cos x by Taylor's series after x − k·2π. The precision suffices for k and for all digits of x.
fn series(x: &Mp, precision: Precision) -> (Mp, Mp) {
    let wide = Precision::bits(precision.get() + 1200);
    let turn = machin(wide).twice();
    // The whole number of turns, bit by bit: the crate's comparison and doubling are the only functions used.
    let mut rest = x.at(wide).abs();
    let mut multiples = vec![turn];
    while multiples[multiples.len() - 1] < rest {
        multiples.push(multiples[multiples.len() - 1].twice());
    }
    for multiple in multiples.iter().rev() {
        if *multiple <= rest {
            rest = rest - multiple;
        }
    }
    let (mut term, mut sin, mut cos) = (wide.integer(1), Mp::zero(), Mp::zero());
    for k in 0..700 {
        match k % 4 {
            0 => cos = cos + &term,
            1 => sin = sin + &term,
            2 => cos = cos - &term,
            _ => sin = sin - &term,
        }
        term = term * &rest / wide.integer(k + 1);
    }
    (if x.is_negative() { -sin } else { sin }, cos)
}

/// Zeros of the sine to 16 digits, its steepest places, huge numbers, the largest double, and numbers whose square is below any double.
/// Among the huge ones: 1e22 is the classic, and of all doubles 6381956970095103·2⁷⁹⁷ comes closest to a multiple of π/2.
const ARGUMENTS: [f64; 20] = [
    0.5,
    -0.5,
    1.0,
    std::f64::consts::FRAC_PI_4,
    std::f64::consts::FRAC_PI_2,
    std::f64::consts::PI,
    -std::f64::consts::TAU,
    3.5,
    -100.0,
    355.0,
    1e5,
    12_345_678.9,
    1e22,
    -1e22,
    5.319372648326541e255,
    1e308,
    -f64::MAX,
    1e-30,
    1e-300,
    f64::MIN_POSITIVE,
];

#[test]
fn sine_and_cosine_are_right_for_huge_and_tiny_arguments() {
    for precision in BITS {
        let tolerance = 2.0_f64.powi(-i32::try_from(precision.get().min(1060)).unwrap()) * 1.01;
        for argument in ARGUMENTS {
            let x = precision.number(argument).unwrap();
            let ((sin, cos), (right_sin, right_cos)) = (x.sin_cos(), series(&x, precision));
            for (name, got, right) in [("sin", &sin, &right_sin), ("cos", &cos, &right_cos)] {
                // Half a unit in the last place, relative.
                let error = ((got - right) / right).abs();
                close(&format!("{name} {argument:e} at {} bits", precision.get()), &error, tolerance);
            }
            let one = &sin * &sin + &cos * &cos;
            close("sin² + cos²", &(one - precision.integer(1)).abs(), 8.0 * tolerance);
        }
    }
}

#[test]
fn sine_and_cosine_keep_their_identities() {
    let precision = Precision::STANDARD;
    for argument in ARGUMENTS {
        let x = precision.number(argument).unwrap();
        let ((sin, cos), (double_sin, double_cos)) = (x.sin_cos(), x.twice().sin_cos());
        close("sin 2x", &(&sin * &cos).twice().at(precision).minus(&double_sin), 1e-133);
        close("cos 2x", &(&cos * &cos - &sin * &sin).minus(&double_cos), 1e-133);
        let (of_negative, even) = (-&x).sin_cos();
        assert_eq!((-of_negative, even), (sin, cos), "{argument:e}");
    }
    assert_eq!(precision.number(5.319372648326541e255).unwrap().sin_cos().1.to_f64(), -4.687165924254628e-19, "closest to zero");
    assert_eq!(precision.number(0.0).unwrap().sin_cos(), (Mp::zero(), precision.integer(1)));
    assert_eq!(Mp::zero().sin_cos().1.to_f64(), 1.0, "zero of no precision");
}

trait Minus {
    fn minus(&self, other: &Mp) -> Mp;
}

impl Minus for Mp {
    fn minus(&self, other: &Mp) -> Mp {
        (self - other).abs()
    }
}

#[test]
fn pi_and_arcsine_are_right() {
    for precision in BITS {
        let pi = precision.pi();
        let tolerance = 2.0_f64.powi(-i32::try_from(precision.get().min(1060)).unwrap()) * 4.0;
        close("π", &pi.minus(&machin(precision)), 64.0 * tolerance);
        close("arcsin ½", &(precision.integer(1).half().asin() * precision.integer(6)).minus(&pi), 4.0 * tolerance);
        let x = precision.number(0.3).unwrap();
        close("arcsin sin", &x.sin_cos().0.asin().minus(&x), tolerance);
    }
}

#[test]
fn roots_are_right() {
    for precision in BITS {
        let two = precision.integer(2);
        let tolerance = 2.0_f64.powi(2 - i32::try_from(precision.get().min(1060)).unwrap());
        close("√2²", &(two.sqrt() * two.sqrt()).minus(&two), tolerance);
        assert_eq!(precision.integer(144).sqrt(), precision.integer(12));
    }
    assert!(Mp::zero().sqrt().is_zero());
}

#[test]
fn numbers_that_are_none_are_refused() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(Precision::STANDARD.number(value).is_none(), "{value}");
    }
    for text in ["", "one", "1.2.3", "nan", "inf", "1e", "--1"] {
        assert_eq!(Precision::STANDARD.parse(text), Err(Error::NotANumber { text: text.to_owned() }));
    }
}

/// Half-way between 2⁵³ and the double after it.
fn tie_of_two() -> Mp {
    Precision::STANDARD.integer((1 << 53) + 1)
}

#[test]
fn known_doubles_of_known_numbers() {
    let third = Precision::STANDARD.integer(1) / Precision::STANDARD.integer(3);
    assert_eq!(third.to_pair(), (1.0 / 3.0, 1.850371707708594e-17));
    assert_eq!(third.to_decimal(12), "3.33333333333e-1");
    for (x, digits, text) in [(999.96, 4, "1e3"), (999.94, 4, "9.999e2"), (-0.65686, 1, "-7e-1"), (1e-300, 3, "1e-300"), (0.0, 5, "0")] {
        assert_eq!(Precision::STANDARD.number(x).unwrap().to_decimal(digits), text);
    }
    for (text, x) in [("12.5e-1", 1.25), ("+.5", 0.5), ("-3.", -3.0), ("00100", 100.0), ("1E5", 1e5), ("1e-400", 0.0)] {
        assert_eq!(Precision::STANDARD.parse(text).unwrap().to_f64(), x);
    }
    // Noise does not change a zero or a tie.
    let noise = Precision::STANDARD.parse("1e-130").unwrap();
    assert_eq!(
        nearest_doubles(&[&tie_of_two() + &noise, &tie_of_two() - &noise, noise, Mp::zero()]),
        [9_007_199_254_740_992.0, 9_007_199_254_740_992.0, 0.0, 0.0]
    );
    assert_eq!(nearest_doubles(&[Mp::zero()]), [0.0]);
    // Ties go to even; a number beside a tie goes to the nearer double.
    let tie = tie_of_two();
    assert_eq!(tie.to_f64(), 9_007_199_254_740_992.0);
    assert_eq!((&tie + Precision::STANDARD.number(1e-60).unwrap()).to_f64(), 9_007_199_254_740_994.0);
    // Half of the smallest double is a tie with zero.
    let smallest = Precision::STANDARD.number(5e-324).unwrap();
    assert_eq!((smallest.half().to_f64(), (&smallest + smallest.half()).to_f64()), (0.0, 1e-323));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// Every finite double is represented exactly, written and read back.
    #[test]
    fn doubles_pass_unharmed(bits in any::<u64>()) {
        let value = f64::from_bits(bits);
        prop_assume!(value.is_finite());
        let number = Precision::STANDARD.number(value).unwrap();
        prop_assert_eq!(number.to_f64(), value);
        prop_assert_eq!(number.to_pair(), (value, 0.0));
        let text = number.to_decimal(40);
        prop_assert_eq!(Precision::STANDARD.parse(&text).unwrap().to_f64(), value);
        prop_assert_eq!(text.parse::<f64>().unwrap(), value);
    }

    /// Sums and products of whole numbers are those of integers; a/b·b is a.
    #[test]
    fn arithmetic_is_that_of_integers(a in any::<i32>(), b in any::<i32>(), c in any::<i32>()) {
        let number = |x: i64| Precision::STANDARD.integer(x);
        let (x, y, z) = (i64::from(a), i64::from(b), i64::from(c));
        prop_assert_eq!(number(x) * number(y) + number(z), number(x * y + z));
        prop_assert_eq!(number(x) - number(y), number(x - y));
        if b != 0 {
            let error = ((number(x) / number(y)) * number(y) - number(x)).abs();
            prop_assert!(error.to_f64() <= 1e-120);
        }
    }

    /// A number that is written with n digits and read back has an error of at most half a unit of the last digit.
    #[test]
    fn texts_keep_their_digits(a in 1_i64..1_000_000_000, b in 1_i64..1_000_000_000, digits in 1_usize..120) {
        let x = Precision::STANDARD.integer(a) / Precision::STANDARD.integer(b);
        let back = Precision::STANDARD.parse(&x.to_decimal(digits)).unwrap();
        let error = ((back - &x) / x).abs().to_f64();
        prop_assert!(error <= 5.000_001 * 10.0_f64.powi(-i32::try_from(digits).unwrap()), "{}", error);
    }
}
