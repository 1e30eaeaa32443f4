//! Decimal texts of multi-precision numbers, and numbers of decimal texts.
//!
//! Computes: x·10ᵏ with 64 extra bits, rounded to a whole number whose digits are written. And back: the digits as a whole number times a
//! power of ten. `dashu-float` 0.6.2 has conversions of its own, which are not used. At low precisions they are wrong: 0.65686… becomes 3e2
//! with one digit and 6.56e-1 with three. Source: Steele & White, PLDI 1990, in its simplest form. Cost: O(digits) products.

use crate::{Error, Mp, Precision};

/// Bits beyond what the digits need.
const SPARE: usize = 64;

/// Digits that are converted together: a power of ten that fits 64 bits.
const CHUNK: usize = 18;

impl Mp {
    /// In scientific notation with this number of significant digits (at least one), rounded to nearest.
    pub fn to_decimal(&self, digits: usize) -> String {
        if self.is_zero() {
            return "0".to_owned();
        }
        let digits = digits.max(1);
        let wide = Precision::bits(self.precision().get().max(digits * 10 / 3) + SPARE);
        let size = self.abs().at(wide);
        // 10^exponent ≤ |x| < 10^(exponent + 1), except for the logarithm's rounding. The number of digits shows that.
        let mut exponent = (self.binary_exponent() as f64 * std::f64::consts::LOG10_2).floor() as i64;
        loop {
            let text = (&size * power_of_ten(digits as i64 - 1 - exponent, wide)).whole_digits();
            match text.len().cmp(&digits) {
                std::cmp::Ordering::Less => exponent -= 1,
                std::cmp::Ordering::Greater => exponent += 1,
                std::cmp::Ordering::Equal => {
                    let sign = if self.is_negative() { "-" } else { "" };
                    let (first, rest) = text.split_at(1);
                    let rest = rest.trim_end_matches('0');
                    let point = if rest.is_empty() { "" } else { "." };
                    return format!("{sign}{first}{point}{rest}e{exponent}");
                }
            }
        }
    }
}

impl Precision {
    /// The decimal number of a text such as `-12.5e-3`, rounded to this precision.
    ///
    /// # Errors
    /// [`Error::NotANumber`].
    pub fn parse(self, text: &str) -> Result<Mp, Error> {
        self.read(text).ok_or_else(|| Error::NotANumber { text: text.to_owned() })
    }

    fn read(self, text: &str) -> Option<Mp> {
        let (negative, unsigned) = match text.as_bytes().first()? {
            b'-' => (true, &text[1..]),
            b'+' => (false, &text[1..]),
            _ => (false, text),
        };
        let (decimal, exponent) = match unsigned.split_once(['e', 'E']) {
            Some((decimal, exponent)) => (decimal, exponent.parse::<i32>().ok()?),
            None => (unsigned, 0),
        };
        let (whole, fraction) = decimal.split_once('.').unwrap_or((decimal, ""));
        let digits = format!("{whole}{fraction}");
        if digits.is_empty() || !digits.bytes().all(|digit| digit.is_ascii_digit()) {
            return None;
        }
        let wide = Precision::bits(self.get().max(digits.len() * 10 / 3) + SPARE);
        let mut number = Mp::zero();
        for chunk in digits.as_bytes().chunks(CHUNK) {
            let value = chunk.iter().fold(0, |value: i64, digit| 10 * value + i64::from(digit - b'0'));
            number = number * power_of_ten(chunk.len() as i64, wide) + wide.integer(value);
        }
        let shift = i64::from(exponent) - i64::try_from(fraction.len()).ok()?;
        // Dividing by an exact power, as short ones are, rounds once; multiplying by its reciprocal would round twice.
        let number = if shift < 0 { number / power_of_ten(-shift, wide) } else { number * power_of_ten(shift, wide) };
        Some(if negative { -number } else { number }.at(self))
    }
}

/// 10ᵏ, to nearly all bits.
fn power_of_ten(k: i64, precision: Precision) -> Mp {
    let (mut result, mut square, mut rest) = (precision.integer(1), precision.integer(10), k.unsigned_abs());
    while rest > 0 {
        if rest & 1 == 1 {
            result = result * &square;
        }
        square = &square * &square;
        rest >>= 1;
    }
    if k < 0 { precision.integer(1) / result } else { result }
}
