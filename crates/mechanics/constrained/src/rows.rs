//! The rows of all constraints at a state: φ(q), J and J̇v.
//!
//! Each row is two wrenches on bodies, or numbers per dof (`laws/`). A row of J has the entry `S_jᵀ f` for each dof j that supports the
//! body: the power of the wrench in the columns of the body's Jacobian. The bias is the row's acceleration at v̇ = 0, from the classical
//! accelerations of [`Kinematics`]. Shapes: J has one row of `nv` numbers per row of the constraints, row after row. Units: of [`Law`], per
//! rad or m; SI. Frames: [`Law`]. Cost: O(n) per constraint. A call does not allocate but for lists of dofs in the first one.

use crate::attachment::Anchor;
use crate::constraint::{Constraints, Law, coordinate};
use crate::error::Error;
use crate::laws::coordinates::{Coordinate, set_gear, set_mimic};
use crate::laws::{Row, distance, orientation, parallel, point};
use featherbench_dynamics::{Jacobian, Kinematics};
use featherbench_model::Model;
use featherbench_spatial::{Lift, Real};

/// The rows of constraints at a state, and the workspace that computes them.
#[derive(Clone, Debug)]
pub struct Rows<T> {
    kinematics: Kinematics<T>,
    body: Jacobian<T>,
    zeros: Vec<T>,
    rows: Vec<Row<T>>,
    /// J, row after row.
    jacobian: Vec<T>,
    dofs: usize,
}

impl<T: Real> Rows<T>
where
    f64: Lift<T>,
{
    /// A workspace for these constraints.
    pub fn new(constraints: &Constraints) -> Self {
        let topology = constraints.topology();
        let (rows, dofs) = (constraints.rows(), topology.nv());
        Self {
            kinematics: Kinematics::new(topology),
            body: Jacobian::new(topology),
            zeros: vec![T::zero(); dofs],
            rows: vec![Row::empty(); rows],
            jacobian: vec![T::zero(); rows * dofs],
            dofs,
        }
    }

    /// The rows at configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`Error`]: an argument does not fit or is not finite, the model has another tree, or a weld is half a turn off.
    ///
    /// ```
    /// use featherbench_constrained::{Attachment, Constraint, Constraints, Rows};
    /// use featherbench_model::Model;
    /// use featherbench_robots::Family;
    /// let model: Model<f64> = Model::build(&Family::parse("chain:n=3")?.generate()?)?;
    /// let held = Constraint::point("tip", Attachment::world([0.0; 3]), Attachment::point(2, [0.0; 3]));
    /// let constraints = Constraints::new(&model.topology, vec![held])?;
    /// let mut rows = Rows::new(&constraints);
    /// rows.run(&model, &constraints, &[0.1, 0.2, 0.3], &[0.0; 3])?;
    /// assert_eq!(rows.jacobian().len(), 9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, constraints: &Constraints, q: &[T], v: &[T]) -> Result<(), Error> {
        if model.topology != *constraints.topology() {
            return Err(Error::OtherTree);
        }
        expect_finite("configuration q", q)?;
        expect_finite("velocity v", v)?;
        self.kinematics.run(model, q, v, &self.zeros)?;
        for row in &mut self.rows {
            row.wrenches = [None; 2];
            row.dofs.clear();
        }
        for (k, constraint) in constraints.list().iter().enumerate() {
            let rows = &mut self.rows[constraints.rows_of(k)];
            let half_turn = || Error::HalfTurn { constraint: constraint.name.clone() };
            match constraint.law.frames() {
                Some(frames) => {
                    let [Some(first), Some(second)] = frames.map(|frame| Anchor::of(frame, &self.kinematics)) else {
                        return Err(Error::OtherTree);
                    };
                    hold(&constraint.law, &[first, second], rows).ok_or_else(half_turn)?;
                }
                None => relate(&constraint.law, model, q, v, &mut rows[0]),
            }
        }
        self.fill_jacobian(model, constraints, q)
    }

    /// J: for each row, the power of its wrenches in each column of the bodies' Jacobians.
    fn fill_jacobian<P: Real + Lift<T>>(&mut self, model: &Model<P>, constraints: &Constraints, q: &[T]) -> Result<(), Error> {
        self.jacobian.fill(T::zero());
        for k in 0..constraints.list().len() {
            let range = constraints.rows_of(k);
            for side in 0..2 {
                let Some((body, _)) = self.rows[range.clone()].iter().find_map(|row| row.wrenches[side]) else { continue };
                self.body.run(model, q, body)?;
                for row in range.clone() {
                    let Some((_, wrench)) = self.rows[row].wrenches[side] else { continue };
                    let mut dof = Some(last_dof(model, body));
                    while let Some(j) = dof {
                        self.jacobian[row * self.dofs + j] += self.body.columns()[j].dot(wrench);
                        dof = model.topology.dof_parents()[j];
                    }
                }
            }
            for row in range {
                for &(dof, number) in &self.rows[row].dofs {
                    self.jacobian[row * self.dofs + dof] += number;
                }
            }
        }
        Ok(())
    }

    /// J of the last run, row after row.
    pub fn jacobian(&self) -> &[T] {
        &self.jacobian
    }

    /// Row `row` of J, which must exist.
    pub fn jacobian_row(&self, row: usize) -> &[T] {
        &self.jacobian[row * self.dofs..][..self.dofs]
    }

    /// The rows of the last run, with their wrenches.
    pub fn rows(&self) -> &[Row<T>] {
        &self.rows
    }

    /// The residual φ(q) of each row.
    pub fn residuals(&self) -> impl ExactSizeIterator<Item = T> {
        self.rows.iter().map(|row| row.residual)
    }

    /// The bias J̇v of each row.
    pub fn biases(&self) -> impl ExactSizeIterator<Item = T> {
        self.rows.iter().map(|row| row.bias)
    }

    /// `J x` into one number per row.
    ///
    /// # Errors
    /// [`Error::Dimension`] when a vector does not fit.
    pub fn multiply(&self, x: &[T], result: &mut [T]) -> Result<(), Error> {
        featherbench_dynamics::DimensionError::expect("vector x", self.dofs, x.len())?;
        featherbench_dynamics::DimensionError::expect("result", self.rows.len(), result.len())?;
        for (row, result) in result.iter_mut().enumerate() {
            *result = self.jacobian_row(row).iter().zip(x).fold(T::zero(), |sum, (j, x)| j.mul_add(*x, sum));
        }
        Ok(())
    }
}

/// The last dof of a body's joint.
fn last_dof<P>(model: &Model<P>, body: usize) -> usize {
    let joint = &model.topology.joints()[body];
    joint.v + joint.kind.nv() - 1
}

/// The rows of a law between frames; `None` at a half turn.
fn hold<T: Real>(law: &Law, frames: &[Anchor<T>; 2], rows: &mut [Row<T>]) -> Option<()>
where
    f64: Lift<T>,
{
    let (rotations, axes) = match law {
        Law::Point { axes, .. } => (0, *axes),
        Law::Joint { motion, .. } => (motion.held_rotations(), motion.held_axes()),
        Law::Distance { length, .. } => {
            distance::set(frames, *length, &mut rows[0]);
            return Some(());
        }
        Law::Gear { .. } | Law::Mimic { .. } => return Some(()),
    };
    let (turning, sliding) = rows.split_at_mut(rotations);
    if rotations == 3 {
        orientation::set(frames, turning)?;
    } else {
        turning.iter_mut().enumerate().for_each(|(k, row)| parallel::set(frames, k, row));
    }
    let held = (0..3).filter(|k| axes[*k]);
    sliding.iter_mut().zip(held).for_each(|(row, k)| point::set(frames, k, row));
    Some(())
}

/// The row of a law between coordinates.
fn relate<P, T: Real>(law: &Law, model: &Model<P>, q: &[T], v: &[T], row: &mut Row<T>) {
    // Constraints::new has checked that each dof has a coordinate.
    let at = |dof: usize| {
        let place = coordinate(dof, &model.topology).map_or(0, |(_, place)| place);
        Coordinate { dof, q: q[place], v: v[dof] }
    };
    match law {
        Law::Gear { terms, offset } => set_gear(terms.iter().map(|&(dof, coefficient)| (coefficient, at(dof))), *offset, row),
        Law::Mimic { follower, leader, polynomial } => set_mimic(at(*follower), at(*leader), polynomial, row),
        Law::Point { .. } | Law::Joint { .. } | Law::Distance { .. } => (),
    }
}

/// An error unless each number is finite: only then 0·x is zero.
pub(crate) fn expect_finite<T: Real>(what: &'static str, numbers: &[T]) -> Result<(), Error> {
    match numbers.iter().position(|x| (*x * T::zero()).min_lane() != 0.0) {
        Some(index) => Err(Error::NotFinite { what, index }),
        None => Ok(()),
    }
}
