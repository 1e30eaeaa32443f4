//! Equations of motion from a Lagrangian, symbolically.
//!
//! L(q, q̇) = T − V gives, by Euler and Lagrange, M q̈ + h = τ with
//!
//! ```text
//! M = ∂²L/∂q̇∂q̇    h = (∂²L/∂q̇∂q) q̇ − ∂L/∂q
//! ```
//!
//! q̈ = M⁻¹(τ − h) by M = L D Lᵀ without pivots: the M of a real body is positive definite. Symbols: q and q̇ are those that the caller names.

use crate::algebra::{Algebra, AlgebraError, Expression};

/// The equations of motion of a Lagrangian, in the algebra that holds it.
#[derive(Clone, Debug)]
pub struct Equations {
    /// M, row by row.
    pub mass: Vec<Vec<Expression>>,
    /// h.
    pub bias: Vec<Expression>,
}

impl Equations {
    /// The equations of a Lagrangian in coordinates `q` with rates `rates`.
    ///
    /// ```
    /// use featherbench_lesson::{Algebra, Equations};
    /// // A spring: L = m v²/2 − k x²/2, so that m a + k x = f.
    /// let mut a = Algebra::default();
    /// let [x, v, m, k, half] = ["x", "v", "m", "k", "half"].map(|name| a.symbol(name));
    /// let (kinetic, potential) = (a.product(&[half, m, v, v]), a.product(&[half, k, x, x]));
    /// let lagrangian = a.sub(kinetic, potential);
    /// let spring = Equations::of(&mut a, lagrangian, &[x], &[v])?;
    /// let names = ["x", "v", "m", "k", "half"];
    /// let values = a.evaluate(&[spring.mass[0][0], spring.bias[0]], &names, &[0.5, 9.0, 3.0, 10.0, 0.5])?;
    /// assert_eq!(values, [3.0, 5.0]);
    /// # Ok::<(), featherbench_lesson::AlgebraError>(())
    /// ```
    ///
    /// # Errors
    /// [`AlgebraError::Shape`] if the numbers of rates and coordinates differ.
    pub fn of(a: &mut Algebra, lagrangian: Expression, q: &[Expression], rates: &[Expression]) -> Result<Self, AlgebraError> {
        if q.len() != rates.len() {
            return Err(AlgebraError::Shape { what: "rates", found: rates.len(), due: q.len() });
        }
        let momenta: Vec<Expression> = rates.iter().map(|&rate| a.derivative(lagrangian, rate)).collect();
        let mass = momenta.iter().map(|&p| rates.iter().map(|&rate| a.derivative(p, rate)).collect()).collect();
        let bias = momenta.iter().zip(q).map(|(&p, &own)| {
            let along = |(&q, &rate): (&Expression, &Expression)| {
                let slope = a.derivative(p, q);
                a.mul(slope, rate)
            };
            let terms: Vec<Expression> = q.iter().zip(rates).map(along).collect();
            let (transport, force) = (a.sum(&terms), a.derivative(lagrangian, own));
            a.sub(transport, force)
        });
        let bias = bias.collect();
        Ok(Self { mass, bias })
    }

    /// q̈ for the joint forces `tau`.
    ///
    /// # Errors
    /// [`AlgebraError::Shape`] if the numbers of forces and coordinates differ.
    pub fn accelerations(&self, a: &mut Algebra, tau: &[Expression]) -> Result<Vec<Expression>, AlgebraError> {
        let n = self.bias.len();
        if tau.len() != n {
            return Err(AlgebraError::Shape { what: "forces", found: tau.len(), due: n });
        }
        // M = L D Lᵀ, column by column; L below the diagonal.
        let (mut lower, mut pivots) = (vec![Vec::<Expression>::new(); n], Vec::new());
        for i in 0..n {
            for j in 0..=i {
                let mut entry = self.mass[i][j];
                for k in 0..j {
                    let term = if i == j {
                        a.product(&[lower[i][k], lower[i][k], pivots[k]])
                    } else {
                        a.product(&[lower[i][k], lower[j][k], pivots[k]])
                    };
                    entry = a.sub(entry, term);
                }
                if i == j {
                    pivots.push(entry);
                } else {
                    let scaled = a.div(entry, pivots[j]);
                    lower[i].push(scaled);
                }
            }
        }
        let mut x: Vec<Expression> = tau.iter().zip(&self.bias).map(|(&tau, &bias)| a.sub(tau, bias)).collect();
        for i in 0..n {
            for k in 0..i {
                let term = a.mul(lower[i][k], x[k]);
                x[i] = a.sub(x[i], term);
            }
        }
        for i in (0..n).rev() {
            x[i] = a.div(x[i], pivots[i]);
            for k in i + 1..n {
                let term = a.mul(lower[k][i], x[k]);
                x[i] = a.sub(x[i], term);
            }
        }
        Ok(x)
    }
}
