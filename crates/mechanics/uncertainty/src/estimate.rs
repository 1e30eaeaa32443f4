//! A number with its standard error, and what that says: an interval, and how far a known number is.
//!
//! The error is estimated too: from N independent samples, or from R independent replicates. So an interval is Student's, with N − 1 or R − 1
//! degrees of freedom.

/// The 97.5 % point of the standard normal variable.
const NORMAL: f64 = 1.959_963_984_540_054;

/// A number with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
    /// The degrees of freedom ν of the error.
    pub freedom: f64,
}

impl Estimate {
    /// Half the width of the 95 % interval about the value.
    pub fn half_width(&self) -> f64 {
        self.error * student(self.freedom)
    }

    /// How far a known number is, in deviations of a normal variable that is as improbable: comparable for any number of degrees of freedom. A
    /// difference that the rounding of the known number explains is none.
    pub fn deviations(&self, known: f64) -> f64 {
        let rounding = 8.0 * f64::EPSILON * known.abs();
        let t = (self.value - known).abs() / (self.error + rounding);
        // `t` itself where its square has no number.
        if self.freedom.is_infinite() || t > 1e150 {
            t
        } else {
            factor(self.freedom) * (self.freedom * (t * t / self.freedom).ln_1p()).sqrt()
        }
    }
}

/// Student's 97.5 % point, by D. L. Wallace's approximation (*Ann. Math. Statist.* 30, 1959): above the true one by 2 % with 3 degrees of freedom,
/// by 0.3 % with 5 and by 0.02 % with 15.
pub fn student(freedom: f64) -> f64 {
    if freedom.is_infinite() {
        return NORMAL;
    }
    (freedom * ((NORMAL / factor(freedom)).powi(2) / freedom).exp_m1()).sqrt()
}

/// z = (8ν + 1)/(8ν + 3) √(ν ln(1 + t²/ν)).
fn factor(freedom: f64) -> f64 {
    (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0)
}

/// The mean of the values of independent replicates, two at least.
pub(crate) fn of_replicates(values: &[f64]) -> Estimate {
    let count = values.len() as f64;
    let value = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|x| (x - value).powi(2)).sum();
    Estimate { value, error: (square / (count * (count - 1.0))).sqrt(), freedom: count - 1.0 }
}

/// A function of all replicates, from what it is of all and without each of them (the jackknife: M. H. Quenouille, 1956; J. W. Tukey, 1958). A bias
/// of the order 1/R is taken off.
pub(crate) fn jackknife(all: f64, without: &[f64]) -> Estimate {
    let count = without.len() as f64;
    let pseudo: Vec<f64> = without.iter().map(|x| all + (count - 1.0) * (all - x)).collect();
    of_replicates(&pseudo)
}
