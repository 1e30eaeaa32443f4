//! The polynomial basis: counts, values and derivatives.

use featherbench_learning::{Chebyshev, Range};

/// Of n variables there are C(n + d, n) products of degree at most d.
#[test]
fn products_are_counted() {
    let of = |n: usize, degree: usize| Chebyshev::new(vec![Range { low: -1.0, high: 1.0 }; n], degree).len();
    assert_eq!([of(1, 5), of(2, 6), of(6, 4), of(3, 0)], [6, 28, 210, 1]);
}

/// T_e(cos t) = cos et; and derivatives as central differences have them.
#[test]
fn values_are_cosines() {
    let basis = Chebyshev::new(vec![Range { low: -3.0, high: 1.0 }], 7);
    let t = 0.7_f64;
    let x = -1.0 + 2.0 * t.cos();
    for (e, value) in basis.values(&[x]).iter().enumerate() {
        assert!((value - (e as f64 * t).cos()).abs() < 1e-14, "{e}");
    }
    let basis = Chebyshev::new(vec![Range { low: -3.0, high: 1.0 }, Range { low: 0.0, high: 2.0 }], 5);
    let (values, by) = basis.gradients(&[-0.4, 1.3]);
    assert_eq!(values, basis.values(&[-0.4, 1.3]));
    let h = 1e-6;
    for (k, [dx, dy]) in [[h, 0.0], [0.0, h]].into_iter().enumerate() {
        let (plus, minus) = (basis.values(&[-0.4 + dx, 1.3 + dy]), basis.values(&[-0.4 - dx, 1.3 - dy]));
        for (e, slope) in by[k].iter().enumerate() {
            assert!(((plus[e] - minus[e]) / (2.0 * h) - slope).abs() < 1e-8, "{k} {e}"); // rounding over h
        }
    }
}
