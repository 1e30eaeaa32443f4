//! Lossless coding of doubles that are nearly equal to others. The answers of engines to one question differ by a few units in the last
//! place: that takes one byte instead of eight.

/// The bits of a double as an integer that increases with the double: neighbouring doubles are neighbouring integers, and −0 is below 0.
fn ordered(x: f64) -> i64 {
    flipped(x.to_bits() as i64)
}

/// The double of such an integer.
fn unordered(n: i64) -> f64 {
    f64::from_bits(flipped(n) as u64)
}

/// Inverts all bits but the sign of a negative number; twice gives the number back.
fn flipped(bits: i64) -> i64 {
    bits ^ (bits >> 63) & i64::MAX
}

/// Eight bytes each, little-endian.
pub(crate) fn plain(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// The values of [`plain`] bytes.
pub(crate) fn from_plain(bytes: &[u8]) -> Option<Vec<f64>> {
    let (chunks, rest) = bytes.as_chunks::<8>();
    rest.is_empty().then(|| chunks.iter().map(|&chunk| f64::from_le_bytes(chunk)).collect())
}

/// The exact distances of the values from those of a base of the same length, in units in the last place.
///
/// They are zigzag numbers in LEB128; a zero is followed by the number of further zeros.
pub(crate) fn delta(values: &[f64], base: &[f64]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(values.len());
    let mut distances = values.iter().zip(base).map(|(value, base)| distance(*value, *base)).peekable();
    while let Some(distance) = distances.next() {
        // Zigzag: small magnitudes of either sign become small unsigned numbers.
        push_leb128(&mut bytes, (distance << 1 ^ distance >> 63) as u64);
        if distance == 0 {
            let further = std::iter::from_fn(|| distances.next_if_eq(&0)).count();
            push_leb128(&mut bytes, further as u64);
        }
    }
    bytes
}

/// The values of [`delta`] bytes, or `None` when these are damaged.
pub(crate) fn from_delta(bytes: &[u8], base: &[f64]) -> Option<Vec<f64>> {
    let mut bytes = bytes.iter();
    let mut values = Vec::with_capacity(base.len());
    let mut zeros = 0;
    for base in base {
        if zeros > 0 {
            zeros -= 1;
            values.push(*base);
            continue;
        }
        let zigzag = take_leb128(&mut bytes)?;
        if zigzag == 0 {
            zeros = take_leb128(&mut bytes)?;
        }
        let distance = (zigzag >> 1) as i64 ^ -((zigzag & 1) as i64);
        values.push(unordered(ordered(*base).wrapping_add(distance)));
    }
    (bytes.next().is_none() && zeros == 0).then_some(values)
}

fn push_leb128(bytes: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

fn take_leb128(bytes: &mut std::slice::Iter<u8>) -> Option<u64> {
    let (mut number, mut shift) = (0_u64, 0);
    loop {
        let byte = *bytes.next()?;
        number |= u64::from(byte & 0x7f).checked_shl(shift)?;
        if byte < 0x80 {
            return Some(number);
        }
        shift += 7;
    }
}

fn distance(value: f64, base: f64) -> i64 {
    ordered(value).wrapping_sub(ordered(base))
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_robots::Random;

    #[test]
    fn every_bit_comes_back() {
        let mut random = Random::new(1, 2);
        let special =
            [0.0, -0.0, 1.0, -1.0, f64::MIN_POSITIVE, -f64::MIN_POSITIVE, f64::MAX, f64::MIN, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
        let any: Vec<f64> = special.into_iter().chain((0..1000).map(|_| f64::from_bits(random.bits64()))).collect();
        let base: Vec<f64> = any.iter().rev().copied().collect();
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(from_delta(&delta(&any, &base), &base).map(|values| bits(&values)), Some(bits(&any)));
        assert_eq!(from_plain(&plain(&any)).map(|values| bits(&values)), Some(bits(&any)));
    }

    #[test]
    fn neighbours_take_one_byte() {
        let base = [1.0, -1.0, 3.5e-9, 0.0];
        let near = [1.0 + f64::EPSILON, -1.0 - f64::EPSILON, 3.5e-9, -0.0];
        assert!(delta(&near, &base).len() <= 5, "a step each, and a run of one zero");
        assert_eq!(delta(&[1.5; 100], &[1.5; 100]), [0, 99], "equal values take no room");
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let base = [1.0, 2.0];
        let good = delta(&[1.5, 2.0], &base);
        assert_eq!(from_delta(&good[..good.len() - 1], &base), None);
        assert_eq!(from_delta(&[&good[..], &[0]].concat(), &base), None);
        assert_eq!(from_delta(&[0xff; 12], &base), None);
        assert_eq!(from_plain(&[0; 7]), None);
    }
}
