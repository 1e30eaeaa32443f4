//! A Lagrangian net: M(q) = L(q) L(q)ᵀ + εI and V(q), with L and V from a net of one hidden layer.
//!
//! ```text
//! s = σ(W q + b)        [L; V] = U s + c        σ(x) = x / √(1 + x²)
//! τ = M a + Ṁ v − ½ ∂(vᵀM v)/∂q + ∂V/∂q
//! ```
//!
//! M ≻ εI whatever the weights are, so forward dynamics always has an answer, and the energy ½ vᵀM v + V is conserved without τ.
//! Source: M. Lutter, C. Ritter and J. Peters, *Deep Lagrangian Networks* (2019), who take the diagonal of L positive and a deeper net.
//!
//! The weights are those of least squares in τ, each joint scaled by its root mean square, by the method of Levenberg and Marquardt from weights
//! drawn with a seed. The derivative of τ by the weights has two factors: τ by [L; V] and their derivatives (dual numbers), and these by the
//! weights (written out below).

use crate::learned::{expect_state, solved};
use crate::motion::rms;
use crate::{Dynamics, ResidualError, Sample};
use featherbench_robots::Random;
use featherbench_spatial::{Dual, Real};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::DMatrix;
use nalgebra_of_levenberg_marquardt as lm;

/// How a net is made and fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Net {
    /// Units of the hidden layer.
    pub hidden: usize,
    /// ε, kg·m².
    pub epsilon: f64,
    /// The seed of the first weights.
    pub seed: u64,
    /// The most evaluations of torques, per weight.
    pub patience: usize,
}

/// A fitted net.
#[derive(Clone, Debug, PartialEq)]
pub struct Lagrangian {
    n: usize,
    hidden: usize,
    epsilon: f64,
    /// W (hidden × n), b (hidden), U (outputs × hidden), c (outputs), each row by row.
    weights: Vec<f64>,
}

/// What the fit did.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Evaluations of all torques.
    pub evaluations: usize,
    /// Root mean square of what is left, over that of the torques.
    pub left: f64,
}

/// L and V, and their derivatives by q: `values[m]`, `by[m·n + k]`.
struct Outputs<T> {
    values: Vec<T>,
    by: Vec<T>,
}

impl Lagrangian {
    /// Fits a net to samples.
    ///
    /// # Errors
    /// [`ResidualError::Learning`] without samples or hidden units, with numbers that are not finite, or if the optimiser cannot start.
    pub fn fit(samples: &[Sample], net: Net) -> Result<(Self, Fit), ResidualError> {
        let refuse = |reason: String| Err(ResidualError::Learning(reason));
        let n = samples.first().map_or(0, |sample| sample.q.len());
        if n == 0 || net.hidden == 0 || net.patience == 0 {
            return refuse("a net needs samples, hidden units and evaluations".into());
        }
        if !(net.epsilon.is_finite() && net.epsilon > 0.0) {
            return refuse("ε must be positive and finite".into());
        }
        for Sample { q, v, a, tau } in samples {
            expect_state(n, q, v, a)?;
            crate::learned::expect("joint forces τ", n, tau.len())?;
            if !q.iter().chain(v).chain(a).chain(tau).all(|x| x.is_finite()) {
                return refuse("a number of the samples is not finite".into());
            }
        }
        let scales: Vec<f64> = (0..n).map(|joint| rms(samples.iter().map(|sample| sample.tau[joint])).max(f64::MIN_POSITIVE)).collect();
        let mut random = Random::named(net.seed, "Lagrangian net");
        let outputs = n * (n + 1) / 2 + 1;
        let weights = net.hidden * n + net.hidden + outputs * net.hidden + outputs;
        // The outputs are sums over the hidden layer: their weights are smaller by its root, so that their size does not depend on it.
        let (inner, outer) = (net.hidden * (n + 1), 1.0 / (net.hidden as f64).sqrt());
        let draw = |k: usize| random.uniform(-1.0, 1.0) * if k < inner { 1.5 } else { outer };
        let first = Self { n, hidden: net.hidden, epsilon: net.epsilon, weights: (0..weights).map(draw).collect() };
        let problem = Problem { net: first, samples, scales };
        let method = LevenbergMarquardt::new().with_patience(net.patience).with_ftol(1e-10).with_xtol(1e-10).with_gtol(0.0);
        let (fitted, report) = method.minimize(problem);
        if report.termination.was_usage_issue() {
            return refuse(format!("the optimiser refused: {:?}", report.termination));
        }
        if !fitted.net.weights.iter().all(|x| x.is_finite()) {
            return refuse("the weights are not finite".into());
        }
        let rows = (samples.len() * n) as f64;
        let left = (2.0 * report.objective_function / rows).sqrt();
        Ok((fitted.net, Fit { evaluations: report.number_of_evaluations, left }))
    }

    fn outputs(&self) -> usize {
        self.n * (self.n + 1) / 2 + 1
    }

    /// The parts of the weights: W, b, U, c.
    fn parts(&self) -> [&[f64]; 4] {
        let (w, rest) = self.weights.split_at(self.hidden * self.n);
        let (b, rest) = rest.split_at(self.hidden);
        let (u, c) = rest.split_at(self.outputs() * self.hidden);
        [w, b, u, c]
    }

    /// Of each hidden unit: σ, σ′ and σ″. With r = 1/√(1 + x²) they are x r, r³ and −3 x r⁵.
    fn layer(&self, q: &[f64]) -> Vec<[f64; 3]> {
        let [w, b, _, _] = self.parts();
        let unit = |h: usize| {
            let x = b[h] + (0..self.n).map(|k| w[h * self.n + k] * q[k]).sum::<f64>();
            let r = 1.0 / (1.0 + x * x).sqrt();
            [x * r, r * r * r, -3.0 * x * r.powi(5)]
        };
        (0..self.hidden).map(unit).collect()
    }

    fn evaluate(&self, layer: &[[f64; 3]]) -> Outputs<f64> {
        let [w, _, u, c] = self.parts();
        let (n, hidden) = (self.n, self.hidden);
        let sum = |m: usize, factor: &dyn Fn(usize) -> f64| (0..hidden).map(|h| u[m * hidden + h] * factor(h)).sum::<f64>();
        let values = (0..self.outputs()).map(|m| c[m] + sum(m, &|h| layer[h][0])).collect();
        let by = (0..self.outputs() * n).map(|at| sum(at / n, &|h| layer[h][1] * w[h * n + at % n])).collect();
        Outputs { values, by }
    }

    /// τ of outputs.
    fn torque<T: Real>(&self, outputs: &Outputs<T>, v: &[f64], a: &[f64]) -> Vec<T> {
        let n = self.n;
        let number = T::from_f64;
        let entry = |i: usize, j: usize| i * (i + 1) / 2 + j;
        let zero = || vec![T::zero(); n];
        // w = Lᵀv, and Lᵀa + L̇ᵀv with L̇ = Σ ∂L/∂q_k v_k.
        let (mut w, mut moved) = (zero(), zero());
        let rate = |m: usize| (0..n).fold(T::zero(), |sum, k| sum + outputs.by[m * n + k] * number(v[k]));
        for i in 0..n {
            for j in 0..=i {
                let m = entry(i, j);
                w[j] += outputs.values[m] * number(v[i]);
                moved[j] += outputs.values[m] * number(a[i]) + rate(m) * number(v[i]);
            }
        }
        // M a + Ṁ v = L (Lᵀa + L̇ᵀv) + L̇ Lᵀv + εa, and ½ ∂(vᵀMv)/∂q_k = wᵀ (∂L/∂q_k)ᵀ v.
        let mut tau: Vec<T> = a.iter().map(|&a| number(self.epsilon * a)).collect();
        for i in 0..n {
            for j in 0..=i {
                let m = entry(i, j);
                tau[i] += outputs.values[m] * moved[j] + rate(m) * w[j];
                let square = number(v[i]) * w[j];
                tau.iter_mut().zip(&outputs.by[m * n..]).for_each(|(tau, by)| *tau -= *by * square);
            }
        }
        let potential = self.outputs() - 1;
        (0..n).for_each(|k| tau[k] += outputs.by[potential * n + k]);
        tau
    }

    fn mass(&self, outputs: &Outputs<f64>) -> DMatrix<f64> {
        let lower = DMatrix::from_fn(self.n, self.n, |i, j| if j <= i { outputs.values[i * (i + 1) / 2 + j] } else { 0.0 });
        &lower * lower.transpose() + DMatrix::identity(self.n, self.n) * self.epsilon
    }

    /// Writes the derivative of a sample's torques by the weights, a row per joint.
    fn torque_by_weights(&self, sample: &Sample, mut write: impl FnMut(usize, usize, f64)) {
        let (n, hidden, outputs) = (self.n, self.hidden, self.outputs());
        let layer = self.layer(&sample.q);
        let [w, _, u, _] = self.parts();
        let Outputs { values, by } = self.evaluate(&layer);
        // τ by each value and derivative of the outputs.
        let constants = |numbers: &[f64]| numbers.iter().map(|&x| Dual::constant(x)).collect::<Vec<Dual<f64>>>();
        let mut duals = Outputs { values: constants(&values), by: constants(&by) };
        // A row for each of them, a column for each joint.
        let mut slopes = Vec::with_capacity(outputs * (n + 1));
        for place in 0..outputs * (n + 1) {
            let seed = |outputs_of: &mut Outputs<Dual<f64>>, slope: f64| match place < outputs {
                true => outputs_of.values[place].derivative = slope,
                false => outputs_of.by[place - outputs].derivative = slope,
            };
            seed(&mut duals, 1.0);
            slopes.push(self.torque(&duals, &sample.v, &sample.a).iter().map(|tau| tau.derivative).collect::<Vec<f64>>());
            seed(&mut duals, 0.0);
        }
        // values_m = c_m + Σ U_mh σ_h and by_mk = Σ U_mh σ′_h W_hk.
        let [at_b, at_u] = [hidden * n, hidden * n + hidden];
        let at_c = at_u + outputs * hidden;
        for joint in 0..n {
            let of_joint: Vec<f64> = slopes.iter().map(|row| row[joint]).collect();
            let slope = |place: usize| of_joint[place];
            for h in 0..hidden {
                let [s, d, dd] = layer[h];
                let mut by_input = 0.0;
                for m in 0..outputs {
                    let weight = u[m * hidden + h];
                    let mut along = 0.0;
                    for k in 0..n {
                        let by = slope(outputs + m * n + k);
                        along += by * w[h * n + k];
                        write(joint, h * n + k, by * weight * d);
                    }
                    write(joint, at_u + m * hidden + h, slope(m) * s + along * d);
                    by_input += weight * (slope(m) * d + along * dd);
                }
                write(joint, at_b + h, by_input);
                (0..n).for_each(|k| write(joint, h * n + k, by_input * sample.q[k]));
            }
            (0..outputs).for_each(|m| write(joint, at_c + m, slope(m)));
        }
    }
}

impl Dynamics for Lagrangian {
    fn nv(&self) -> usize {
        self.n
    }

    fn inverse(&self, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<f64>, ResidualError> {
        expect_state(self.n, q, v, a)?;
        Ok(self.torque(&self.evaluate(&self.layer(q)), v, a))
    }

    fn forward(&self, q: &[f64], v: &[f64], tau: &[f64]) -> Result<Vec<f64>, ResidualError> {
        expect_state(self.n, q, v, tau)?;
        let outputs = self.evaluate(&self.layer(q));
        let bias = self.torque(&outputs, v, &vec![0.0; self.n]);
        solved(self.mass(&outputs), tau.iter().zip(bias).map(|(tau, bias)| tau - bias).collect())
    }

    fn energy(&self, q: &[f64], v: &[f64]) -> Result<Option<f64>, ResidualError> {
        expect_state(self.n, q, v, v)?;
        let outputs = self.evaluate(&self.layer(q));
        let v = nalgebra::DVector::from_column_slice(v);
        Ok(outputs.values.last().map(|potential| 0.5 * v.dot(&(self.mass(&outputs) * &v)) + potential))
    }
}

/// The least squares of a fit.
struct Problem<'a> {
    net: Lagrangian,
    samples: &'a [Sample],
    scales: Vec<f64>,
}

impl LeastSquaresProblem<f64, lm::Dyn, lm::Dyn> for Problem<'_> {
    type ResidualStorage = lm::VecStorage<f64, lm::Dyn, lm::U1>;
    type JacobianStorage = lm::VecStorage<f64, lm::Dyn, lm::Dyn>;
    type ParameterStorage = lm::VecStorage<f64, lm::Dyn, lm::U1>;

    fn set_params(&mut self, x: &lm::DVector<f64>) {
        self.net.weights.copy_from_slice(x.as_slice());
    }

    fn params(&self) -> lm::DVector<f64> {
        lm::DVector::from_column_slice(&self.net.weights)
    }

    fn residuals(&self) -> Option<lm::DVector<f64>> {
        let of = |sample: &Sample| {
            let torque = self.net.torque(&self.net.evaluate(&self.net.layer(&sample.q)), &sample.v, &sample.a);
            torque.iter().zip(&sample.tau).zip(&self.scales).map(|((found, due), scale)| (found - due) / scale).collect::<Vec<f64>>()
        };
        Some(lm::DVector::from_vec(self.samples.iter().flat_map(of).collect()))
    }

    fn jacobian(&self) -> Option<lm::DMatrix<f64>> {
        let n = self.net.n;
        let mut jacobian = lm::DMatrix::zeros(self.samples.len() * n, self.net.weights.len());
        for (number, sample) in self.samples.iter().enumerate() {
            self.net.torque_by_weights(sample, |joint, weight, slope| jacobian[(number * n + joint, weight)] += slope / self.scales[joint]);
        }
        Some(jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The written derivative by the weights against central differences.
    #[test]
    fn weights_have_the_right_derivative() {
        let mut random = Random::named(1, "derivative by weights");
        let mut draw = |count: usize| (0..count).map(|_| random.uniform(-1.0, 1.0)).collect::<Vec<f64>>();
        let (n, hidden) = (2, 5);
        let net = Lagrangian { n, hidden, epsilon: 1e-2, weights: draw(hidden * 3 + 4 * hidden + 4) };
        let sample = Sample { q: draw(n), v: draw(n), a: draw(n), tau: draw(n) };
        let mut found: DMatrix<f64> = DMatrix::zeros(n, net.weights.len());
        net.torque_by_weights(&sample, |joint, weight, slope| found[(joint, weight)] += slope);
        for weight in 0..net.weights.len() {
            let moved = |h: f64| {
                let mut other = net.clone();
                other.weights[weight] += h;
                other.inverse(&sample.q, &sample.v, &sample.a).unwrap()
            };
            let h = 1e-5;
            let (plus, minus) = (moved(h), moved(-h));
            for joint in 0..n {
                let slope = (plus[joint] - minus[joint]) / (2.0 * h);
                // h² of the central difference, and rounding over h.
                assert!((slope - found[(joint, weight)]).abs() < 1e-8, "{joint} {weight}: {slope} {}", found[(joint, weight)]);
            }
        }
    }
}
