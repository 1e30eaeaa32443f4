//! Linear algebra in double-double, for second routes.

use featherbench_spatial::{DoubleDouble, larger};

pub type Wide = DoubleDouble;

pub fn wide(x: f64) -> Wide {
    Wide::from(x)
}

/// The solution of A x = b by Gauss' elimination; A is positive definite.
pub fn solve(mut a: Vec<Vec<Wide>>, mut b: Vec<Wide>) -> Vec<Wide> {
    let n = b.len();
    for k in 0..n {
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            let (above, below) = a.split_at_mut(i);
            below[0][k..].iter_mut().zip(&above[k][k..]).for_each(|(entry, pivot)| *entry -= factor * *pivot);
            let product = factor * b[k];
            b[i] -= product;
        }
    }
    for k in (0..n).rev() {
        let rest = (k + 1..n).fold(b[k], |rest, j| rest - a[k][j] * b[j]);
        b[k] = rest / a[k][k];
    }
    b
}

pub fn times(a: &[Vec<Wide>], x: &[Wide]) -> Vec<Wide> {
    a.iter().map(|row| row.iter().zip(x).fold(wide(0.0), |sum, (a, x)| sum + *a * *x)).collect()
}

/// The smallest λ of K x = λ M x, by inverse iteration.
pub fn smallest_eigenvalue(k: &[Vec<Wide>], m: &[Vec<Wide>]) -> f64 {
    let mut x: Vec<Wide> = (0..m.len()).map(|i| wide(1.0 / (1.0 + i as f64))).collect();
    let mut quotient = wide(0.0);
    // The next eigenvalue is at least five times as large: forty steps leave 5⁻⁸⁰.
    for _ in 0..40 {
        x = solve(k.to_vec(), times(m, &x));
        let size = x.iter().fold(0.0, |a: f64, x| larger(a, x.to_f64().abs()));
        x.iter_mut().for_each(|x| *x = *x / wide(size));
        let product = |a: &[Vec<Wide>]| x.iter().zip(times(a, &x)).fold(wide(0.0), |sum, (x, y)| sum + *x * y);
        quotient = product(k) / product(m);
    }
    quotient.to_f64()
}
