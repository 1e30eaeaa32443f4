//! The Delassus matrix of standing robots and of robots with loops: three routes in double precision, against the dense one in
//! double-double arithmetic. The unit is the largest entry of the diagonal.

use super::loops::Named;
use super::standing::Stand;
use super::{Case, error, failed, largest};
use featherbench_bench::NoAnswer;
use featherbench_constrained::delassus::{by_factors, by_propagation, dense};
use featherbench_constrained::{Attachment, Constraint, Constraints, Rows};
use featherbench_dynamics::mass_matrix;
use featherbench_model::{Model, integrate};
use featherbench_robots::Random;
use featherbench_spatial::{DoubleDouble, Lift};
use nalgebra::DMatrix;
use serde_json::json;

/// Configurations of each robot.
const DRAWS: usize = 20;

/// A robot with its rows, at a configuration that is moved at random.
#[derive(Clone, Copy)]
enum Held {
    /// Points of feet held on the ground.
    Feet(Stand),
    /// A robot with loops.
    Loops(Named),
}

pub(super) fn cases() -> Vec<Case> {
    let feet = [Stand::Humanoid, Stand::Quadruped(1), Stand::Quadruped(4), Stand::Quadruped(16)].map(Held::Feet);
    let loops = [Named::FourBar, Named::Bricard, Named::Squeezer, Named::Biped].map(Held::Loops);
    let held = feet.into_iter().chain(loops);
    held.flat_map(|held| ["dense", "factors", "propagation"].into_iter().map(move |route| case(held, route))).collect()
}

impl Held {
    fn name(self) -> String {
        match self {
            Self::Feet(stand) => stand.name(),
            Self::Loops(named) => named.name().to_owned(),
        }
    }

    fn make(self) -> Result<(Model<f64>, Constraints, Vec<f64>), NoAnswer> {
        match self {
            Self::Feet(stand) => {
                let standing = stand.make()?;
                let hold = |touch: &featherbench_contact::Touch| {
                    Constraint::point(&touch.name, Attachment::world([0.0; 3]), Attachment::point(touch.body, touch.point))
                };
                let list = standing.touches.iter().map(hold).collect();
                let constraints = Constraints::new(&standing.model.topology, list).map_err(failed)?;
                Ok((standing.model, constraints, standing.stance))
            }
            Self::Loops(named) => {
                let (mechanism, q) = named.make()?;
                Ok((mechanism.model, mechanism.constraints, q))
            }
        }
    }
}

fn case(held: Held, route: &'static str) -> Case {
    Case {
        name: held.name(),
        quantity: "delassus",
        method: route.into(),
        params: json!({"draws": DRAWS}),
        numbers: vec![error("error", "dense, double-double")],
        evaluate: Box::new(move |seed| {
            let (model, constraints, start) = held.make()?;
            let mut random = Random::named(seed, &held.name());
            let mut missed = 0.0;
            for _ in 0..DRAWS {
                let step: Vec<f64> = (0..model.topology.nv()).map(|_| random.uniform(-0.3, 0.3)).collect();
                let q = integrate(&model.topology, &start, &step).map_err(failed)?;
                let due = truth(&model, &constraints, &q)?;
                let found = by_route(route, &model, &constraints, &q)?;
                let scale = largest(due.diagonal().iter().copied());
                missed = largest([missed, largest((found - &due).iter().copied()) / scale]);
            }
            Ok(vec![missed])
        }),
    }
}

/// G, with J and M in double-double arithmetic too.
fn truth(model: &Model<f64>, constraints: &Constraints, q: &[f64]) -> Result<DMatrix<f64>, NoAnswer> {
    let q: Vec<DoubleDouble> = q.iter().map(|x| x.lift()).collect();
    let mut rows = Rows::<DoubleDouble>::new(constraints);
    rows.run(model, constraints, &q, &vec![0.0_f64.lift(); model.topology.nv()]).map_err(failed)?;
    let mass = mass_matrix(model, &q).map_err(failed)?;
    Ok(dense(rows.jacobian(), &mass).map_err(failed)?.map(DoubleDouble::to_f64))
}

fn by_route(route: &str, model: &Model<f64>, constraints: &Constraints, q: &[f64]) -> Result<DMatrix<f64>, NoAnswer> {
    let mut rows = Rows::new(constraints);
    rows.run(model, constraints, q, &vec![0.0; model.topology.nv()]).map_err(failed)?;
    let mass = || mass_matrix(model, q).map_err(failed);
    match route {
        "dense" => dense(rows.jacobian(), &mass()?).map_err(failed),
        "factors" => by_factors(rows.jacobian(), &mass()?.into_ltdl().map_err(failed)?).map_err(failed),
        _ => by_propagation(model, q, rows.rows()).map_err(failed),
    }
}
