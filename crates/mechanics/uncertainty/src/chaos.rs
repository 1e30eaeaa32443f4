//! Polynomial chaos: the answer as a series of polynomials that are orthonormal for the variables, projected by Gauss quadrature.
//!
//! Source: D. Xiu and G. E. Karniadakis, 2002; B. Sudret, 2008 (Sobol' indices from the coefficients). With ψ_α = Π ψ_{α_i}(t_i) over the germs,
//! |α| ≤ p: c_α = E y ψ_α, mean c_0, variance Σ_{α≠0} c_α². The expectation is a tensor rule of p + 1 points in each direction.
//! Cost: (p + 1)ⁿ evaluations. Correlated variables use the independent normal variables behind them, with Hermite polynomials; indices are not
//! defined for them.

use crate::quadrature::Rule;
use crate::response::at_each;
use crate::variable::ORDERS;
use crate::{Error, Response, Space};

/// The most nodes of a rule.
const LIMIT: usize = 1 << 18;
/// The highest order: the polynomials of a variable are known up to it.
const HIGHEST: usize = ORDERS - 2;

/// The series of each output.
#[derive(Clone, Debug, PartialEq)]
pub struct Chaos {
    /// The order p.
    pub order: usize,
    /// The nodes of the rule.
    pub nodes: usize,
    /// The multi-indices α, the constant first.
    pub indices: Vec<Vec<usize>>,
    /// The coefficients of each output, in the order of the indices.
    pub coefficients: Vec<Vec<f64>>,
    /// E (y − E y)² of each output, by the rule.
    pub quadrature_variance: Vec<f64>,
    correlated: bool,
}

/// The largest order whose rule has at most so many nodes.
pub fn largest_order(variables: usize, nodes: usize) -> usize {
    (0..=HIGHEST).rev().find(|p| ((p + 1) as f64).powi(variables as i32) <= nodes as f64).unwrap_or(0)
}

/// The series up to an order.
///
/// # Errors
/// [`Error`] when the order is too high, the rule has too many nodes, or the answer at one is not finite.
pub fn chaos<R: Response>(space: &Space, response: &R, order: usize) -> Result<Chaos, Error> {
    let variables = space.len();
    let highest = largest_order(variables, LIMIT);
    if order > HIGHEST {
        return Err(Error::OrderTooHigh { order, limit: HIGHEST, highest });
    }
    if order > highest {
        return Err(Error::TooManyNodes { points: order + 1, variables, limit: LIMIT, highest });
    }
    let nodes = (order + 1).pow(variables as u32);
    let polynomials = space.polynomials();
    let rules: Vec<Rule> = polynomials.iter().map(|known| known.rule(order + 1)).collect();
    // The values of all polynomials at the nodes of each direction.
    let values: Vec<Vec<Vec<f64>>> =
        polynomials.iter().zip(&rules).map(|(known, rule)| rule.nodes.iter().map(|t| known.orthonormal(order, *t)).collect()).collect();
    let basis = Basis { order, variables, nodes, rules, values };
    let mut germs = vec![0.0; variables];
    let answers = at_each(response, nodes, |node, x| {
        germs.iter_mut().enumerate().for_each(|(i, t)| *t = basis.rules[i].nodes[basis.digit(node, i)]);
        space.of_germs(&germs, x);
    });
    basis.series(&answers, response.outputs(), space.is_correlated())
}

/// The polynomials of each direction at the nodes of its rule.
struct Basis {
    order: usize,
    variables: usize,
    nodes: usize,
    rules: Vec<Rule>,
    /// By direction, node and degree.
    values: Vec<Vec<Vec<f64>>>,
}

impl Basis {
    /// The place of a node of the tensor rule in a direction.
    fn digit(&self, node: usize, i: usize) -> usize {
        node / (self.order + 1).pow(i as u32) % (self.order + 1)
    }

    /// The series of the answers at all nodes.
    fn series(&self, answers: &[f64], outputs: usize, correlated: bool) -> Result<Chaos, Error> {
        let Self { order, variables, nodes, .. } = *self;
        let (rules, values, digit) = (&self.rules, &self.values, |node, i| self.digit(node, i));
        if let Some(place) = answers.iter().position(|y| !y.is_finite()) {
            return Err(Error::NotFinitePoint { method: "polynomial chaos", point: place / outputs });
        }
        let indices = multi_indices(variables, order);
        let mut coefficients = vec![vec![0.0; indices.len()]; outputs];
        let mut squares = vec![0.0; outputs];
        let weights: Vec<f64> = (0..nodes).map(|node| (0..variables).map(|i| rules[i].weights[digit(node, i)]).product()).collect();
        for (node, weight) in weights.iter().enumerate() {
            let here = &answers[node * outputs..(node + 1) * outputs];
            for (place, index) in indices.iter().enumerate() {
                let of_degree = index.iter().enumerate().filter(|(_, degree)| **degree > 0);
                let psi: f64 = of_degree.map(|(i, degree)| values[i][digit(node, i)][*degree]).product();
                coefficients.iter_mut().zip(here).for_each(|(c, y)| c[place] += weight * psi * y);
            }
        }
        for (node, weight) in weights.iter().enumerate() {
            for (k, square) in squares.iter_mut().enumerate() {
                *square += weight * (answers[node * outputs + k] - coefficients[k][0]).powi(2);
            }
        }
        Ok(Chaos { order, nodes, indices, coefficients, quadrature_variance: squares, correlated })
    }
}

impl Chaos {
    /// The mean of an output.
    pub fn mean(&self, output: usize) -> f64 {
        self.coefficients[output][0]
    }

    /// The variance of an output.
    pub fn variance(&self, output: usize) -> f64 {
        self.coefficients[output][1..].iter().map(|c| c * c).sum()
    }

    /// The first-order and total Sobol' index of each variable, of an output.
    ///
    /// # Errors
    /// [`Error::Correlated`].
    pub fn sobol_indices(&self, output: usize) -> Result<Vec<[f64; 2]>, Error> {
        if self.correlated {
            return Err(Error::Correlated);
        }
        let variance = self.variance(output);
        let part = |keep: &dyn Fn(&[usize]) -> bool| -> f64 {
            let kept = self.indices.iter().zip(&self.coefficients[output]).filter(|(index, _)| keep(index));
            kept.map(|(_, c)| c * c).sum::<f64>() / variance
        };
        let variables = self.indices[0].len();
        let alone = |i: usize, index: &[usize]| index.iter().enumerate().all(|(k, degree)| (k == i) == (*degree > 0));
        Ok((0..variables).map(|i| [part(&|index| alone(i, index)), part(&|index| index[i] > 0)]).collect())
    }
}

/// All α with |α| ≤ order, by rising |α|.
fn multi_indices(variables: usize, order: usize) -> Vec<Vec<usize>> {
    let mut all = vec![vec![0; variables]];
    let mut begin = 0;
    for _ in 0..order {
        let end = all.len();
        for place in begin..end {
            let last = all[place].iter().rposition(|degree| *degree > 0).unwrap_or(0);
            for i in last..variables {
                let mut next = all[place].clone();
                next[i] += 1;
                all.push(next);
            }
        }
        begin = end;
    }
    all
}
