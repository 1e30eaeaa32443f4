//! A constant factor: every value of an answer is that of the reference times one number. Another unit, a gravity with other digits and a wrong
//! sign are such.

/// Numbers of the reference that are not zero, below which a factor says nothing.
const FEWEST: usize = 6;
/// The share of a difference that may be left without the factor.
const LEFT: f64 = 1e-3;

/// How much larger the values are, as a part of the reference, if that explains the difference at each state; `size` is the number of values of
/// one state. Each state counts alike.
pub(super) fn excess(reference: &[f64], values: &[f64], size: usize) -> Option<f64> {
    let states = || {
        let pairs = reference.chunks_exact(size).zip(values.chunks_exact(size));
        pairs.filter_map(|(r, v)| {
            let norm = r.iter().map(|x| x * x).sum::<f64>().sqrt();
            (norm > 0.0).then(|| r.iter().zip(v).map(move |(r, v)| (r / norm, (v - r) / norm)))
        })
    };
    if reference.iter().filter(|&&x| x != 0.0).count() < FEWEST {
        return None;
    }
    let sum = |term: &dyn Fn(f64, f64) -> f64| states().flatten().map(|(r, d)| term(r, d)).sum::<f64>();
    let excess = sum(&|r, d| r * d) / sum(&|r, _| r * r);
    let (all, left) = (sum(&|_, d| d * d), sum(&|r, d| (d - excess * r) * (d - excess * r)));
    // What the reference has at zero has no factor.
    let beside = reference
        .chunks_exact(size)
        .zip(values.chunks_exact(size))
        .any(|(r, v)| r.iter().all(|&x| x == 0.0) && v.iter().any(|&x| x != 0.0));
    (all > 0.0 && left <= LEFT * LEFT * all && !beside).then_some(excess)
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_robots::Random;

    /// Drawn answers: a factor of any size is found to three digits, and what is none is none.
    #[test]
    fn a_factor_is_found_and_nothing_else() {
        let mut random = Random::named(1, "factors");
        let mut draw = |n: usize| -> Vec<f64> { (0..n).map(|_| random.uniform(-1.0, 1.0)).collect() };
        for k in 0..200 {
            let size = 1 + k % 7;
            let reference = draw(20 * size);
            let planted = [1e-12, -1e-9, 1e-3, -2.0, 9.81, 1e6][k % 6];
            let values: Vec<f64> = reference.iter().map(|x| x * (1.0 + planted)).collect();
            let found = excess(&reference, &values, size).unwrap_or_else(|| panic!("{planted}, {size} values a state"));
            assert!((found / planted - 1.0).abs() < 1e-3, "{found} for {planted}");
            // Noise of the same size, and a factor of the values of one state alone.
            let noise: Vec<f64> = reference.iter().zip(draw(20 * size)).map(|(x, noise)| x + planted * noise).collect();
            assert_eq!(excess(&reference, &noise, size), None, "noise of {planted}, {size} values a state");
            let one: Vec<f64> = reference.iter().enumerate().map(|(i, x)| if i < size { x * (1.0 + planted) } else { *x }).collect();
            assert_eq!(excess(&reference, &one, size), None, "a factor at one state");
            assert_eq!(excess(&reference, &reference, size), None);
        }
        assert_eq!(excess(&[1.0, 2.0], &[2.0, 4.0], 1), None, "two numbers say nothing");
    }
}
