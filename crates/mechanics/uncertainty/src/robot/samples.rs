//! Samples of a robot's dynamics, eight at once: by the columns, or by the recursive algorithms.

use super::numbers::{TEN, compiled, follow};
use super::{Quantity, RobotResponse, Route};
use crate::{Lanes, Response};
use featherbench_dynamics::{Aba, Ltdl, Rnea};
use featherbench_model::{Model, TargetField};
use featherbench_spatial::Real;

/// What a thread computes in.
#[derive(Debug)]
pub struct Scratch {
    theta: Vec<Lanes>,
    ltdl: Ltdl<Lanes>,
    force: Vec<Lanes>,
    recursive: Option<Box<Recursive>>,
}

#[derive(Debug)]
struct Recursive {
    model: Model<Lanes>,
    aba: Aba<Lanes>,
    rnea: Rnea<Lanes>,
    q: Vec<Lanes>,
    v: Vec<Lanes>,
}

impl Response for RobotResponse {
    type Scratch = Scratch;

    fn inputs(&self) -> usize {
        self.inputs
    }

    fn outputs(&self) -> usize {
        self.nv()
    }

    fn scratch(&self) -> Scratch {
        let topology = &self.model.topology;
        let lanes = |list: &[f64]| list.iter().map(|x| Lanes::from_f64(*x)).collect();
        let recursive = (self.route == Route::Recursive).then(|| {
            Box::new(Recursive {
                model: self.model.lift(),
                aba: Aba::new(topology),
                rnea: Rnea::new(topology),
                q: lanes(&self.state.q),
                v: lanes(&self.state.v),
            })
        });
        let bent = self.bodies.iter().filter(|body| body.bent).count();
        let theta = vec![Lanes::zero(); self.inputs + TEN * bent];
        Scratch { theta, ltdl: Ltdl::new(topology), force: vec![Lanes::zero(); topology.nv()], recursive }
    }

    fn evaluate(&self, scratch: &mut Scratch, x: &[Lanes], y: &mut [Lanes]) {
        match &mut scratch.recursive {
            Some(recursive) => self.recurse(recursive, &mut scratch.force, x, y),
            None => self.combine(scratch, x, y),
        }
    }
}

impl RobotResponse {
    /// By the columns.
    fn combine(&self, scratch: &mut Scratch, x: &[Lanes], y: &mut [Lanes]) {
        let Scratch { theta, ltdl, force, .. } = scratch;
        theta[..self.inputs].copy_from_slice(x);
        for (slot, body) in self.bodies.iter().filter(|body| body.bent).enumerate() {
            let begin = self.inputs + TEN * slot;
            theta[begin..begin + TEN].copy_from_slice(&body.parameters(x));
        }
        if self.quantity == Quantity::Torque {
            self.columns.run(theta, |row, tau| y[row] = tau);
            return;
        }
        let stored = self.columns.base.len() - force.len();
        let matrix = ltdl.matrix_mut().values_mut();
        self.columns.run(theta, |row, value| match row.checked_sub(stored) {
            None => matrix[row] = value,
            Some(dof) => force[dof] = Lanes::from_f64(self.state.drive[dof]) - value,
        });
        if ltdl.factor().is_ok() && ltdl.solve(force).is_ok() {
            y.copy_from_slice(force);
        } else {
            y.fill(Lanes::from_f64(f64::NAN));
        }
    }

    /// By the recursive algorithms.
    fn recurse(&self, recursive: &mut Recursive, force: &mut [Lanes], x: &[Lanes], y: &mut [Lanes]) {
        let Recursive { model, aba, rnea, q, v } = recursive;
        for body in &self.bodies {
            let place = self.model.described[body.place];
            model.inertias[place] = compiled(&self.model, place, body.parameters(x));
        }
        let drive = |dof: usize| Lanes::from_f64(self.state.drive[dof]);
        for (dof, force) in force.iter_mut().enumerate() {
            *force = drive(dof);
        }
        let mut losses: Vec<Lanes> = self.losses(None).into_iter().map(Lanes::from_f64).collect();
        for edit in &self.dofs {
            let value = follow(edit.acts, edit.nominal, x[edit.variable]);
            match edit.field {
                TargetField::Armature(_) => model.armature[edit.dof] = value,
                field => losses[edit.dof] = value.mul_add(Lanes::from_f64(self.loss(field, edit.dof)), losses[edit.dof]),
            }
        }
        let done = match self.quantity {
            Quantity::Acceleration => {
                force.iter_mut().zip(&losses).for_each(|(force, loss)| *force -= *loss);
                aba.run(model, q, v, force, None, y).is_ok()
            }
            Quantity::Torque => {
                let done = rnea.run(model, q, v, force, None, y).is_ok();
                y.iter_mut().zip(&losses).for_each(|(y, loss)| *y += *loss);
                done
            }
        };
        if !done {
            y.fill(Lanes::from_f64(f64::NAN));
        }
    }
}
