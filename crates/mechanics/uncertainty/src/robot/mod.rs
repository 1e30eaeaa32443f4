//! The dynamics of a robot at a state, as a function of its uncertain parameters.
//!
//! At a fixed (q, v) the mass matrix M and the bias force h are linear in the inertial parameters π (ten per body, about the body's
//! origin). They are linear in armature, damping and friction, too. In turn, π is affine in mass, density and inertia. It is quadratic in a
//! centre of mass. So with
//!
//! - θ_k = x_k for every variable k that acts on such numbers,
//! - and θ_j = π_j(x) for the ten parameters of each body whose centre of mass is uncertain,
//!
//! `M(x) = M₀ + Σ θ_j M_j` and `h(x) = h₀ + Σ θ_j h_j` exactly. The columns M_j and h_j come from the regressor, once. A sample then costs its
//! nonzeros, one sparse factorization LᵀDL and one solution ([`Route::Affine`]). On long chains the columns have O(n³) nonzeros; there
//! [`Route::Recursive`] runs the articulated-body algorithm, or Newton and Euler's, on eight robots at once. [`RobotResponse::new`] takes what
//! has fewer operations.
//!
//! Derivatives: `∂v̇/∂π = −M⁻¹ Y(q, v, v̇)`, exactly (`featherbench_dynamics::ParameterSensitivity`).
//! Units: SI. Damping and dry friction are part of this function if, and only if, one of them is uncertain: `τ − d∘v − f∘sign v` moves the robot.

mod numbers;
mod samples;

use crate::{Error, Linear, Space};
use featherbench_dynamics::{ParameterSensitivity, TreeSparse, inertial_parameters, inverse_dynamics, mass_matrix, torque_regressor};
use featherbench_model::{Description, DimensionError, Model, TargetField};
use featherbench_spatial::Vec3;
use nalgebra::{DMatrix, DVector};
use numbers::{Body, Columns, Dof, compiled, follow};

/// Inertial parameters of a body.
const TEN: usize = 10;
/// Multiply-adds per body of the recursive algorithms, about: what decides between the routes.
const RECURSIVE: usize = 350;

/// What is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// v̇ of joint forces τ: forward dynamics.
    Acceleration,
    /// τ of accelerations v̇: inverse dynamics.
    Torque,
}

/// How a sample is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// From the precomputed columns of M and h.
    Affine,
    /// By the recursive algorithm, eight robots at once.
    Recursive,
}

/// A state: where the robot is, and what drives it.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Configuration, `nq` numbers.
    pub q: Vec<f64>,
    /// Velocity, `nv` numbers.
    pub v: Vec<f64>,
    /// Joint forces, or for [`Quantity::Torque`] accelerations: `nv` numbers.
    pub drive: Vec<f64>,
}

/// The dynamics as a response.
///
/// ```
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
/// use featherbench_uncertainty::{Quantity, RobotResponse, Space, State, first_order, spread};
///
/// // Every mass of an arm is known to 20 %.
/// let mut arm = Family::parse("chain:n=6,layout=spatial")?.generate()?;
/// arm.uncertain = spread(&arm, 0.2)?;
/// let model: Model<f64> = Model::build(&arm)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let state = State { q: states.q(0).into(), v: states.v(0).into(), drive: states.tau(0).into() };
/// let dynamics = RobotResponse::new(&arm, &state, Quantity::Acceleration, None)?;
/// let found = first_order(&Space::of(&arm.uncertain)?, &dynamics.linear()?)?;
/// assert!((0..6).all(|i| found.covariance[(i, i)] > 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RobotResponse {
    model: Model<f64>,
    state: State,
    quantity: Quantity,
    route: Route,
    inputs: usize,
    means: Vec<f64>,
    bodies: Vec<Body>,
    dofs: Vec<Dof>,
    /// Whether damping and friction are part of the function.
    lossy: bool,
    columns: Columns,
}

impl RobotResponse {
    /// The dynamics of a description at a state, by a route or the cheaper one. The nominal numbers are the written ones, of the canonical form:
    /// a body has what is fixed to it.
    ///
    /// # Errors
    /// [`Error`] when the description is none, has no uncertain parameters, or the state does not fit it.
    pub fn new(description: &Description, state: &State, quantity: Quantity, route: Option<Route>) -> Result<Self, Error> {
        let robot = description.canonical()?;
        let model: Model<f64> = Model::build(&robot)?;
        let topology = &model.topology;
        DimensionError::expect("configuration q", topology.nq(), state.q.len())?;
        DimensionError::expect("velocity v", topology.nv(), state.v.len())?;
        DimensionError::expect("joint forces or accelerations", topology.nv(), state.drive.len())?;
        let space = Space::of(&robot.uncertain)?;
        let (mut bodies, mut dofs): (Vec<Body>, Vec<Dof>) = (Vec::new(), Vec::new());
        for (k, variable) in robot.uncertain.variables.iter().enumerate() {
            for target in &variable.on {
                match target.field {
                    TargetField::Armature(index) | TargetField::Damping(index) | TargetField::Friction(index) => {
                        let last = &topology.joints()[model.described[target.body]];
                        let first = last.v + last.kind.nv() - robot.bodies[target.body].joint.kind.nv();
                        let nominal = robot.nominal(*target).unwrap_or(0.0);
                        dofs.push(Dof { dof: first + index, variable: k, acts: variable.acts, nominal, field: target.field });
                    }
                    _ => {
                        let known = bodies.iter().position(|body| body.place == target.body);
                        let place = known.unwrap_or_else(|| {
                            let described = &robot.bodies[target.body];
                            let (mass, com, inertia) = (described.mass, described.com, described.inertia);
                            bodies.push(Body { place: target.body, mass, com, inertia, edits: Vec::new(), bent: false });
                            bodies.len() - 1
                        });
                        bodies[place].edits.push((k, variable.acts, target.field));
                        bodies[place].bent |= matches!(target.field, TargetField::Com(_));
                    }
                }
            }
        }
        let lossy = dofs.iter().any(|dof| !matches!(dof.field, TargetField::Armature(_)));
        let mut response = Self {
            state: state.clone(),
            quantity,
            route: Route::Affine,
            inputs: space.len(),
            means: space.means(),
            bodies,
            dofs,
            lossy,
            columns: Columns::default(),
            model,
        };
        response.precompute()?;
        let affine = response.columns.terms.len();
        let recursive = RECURSIVE * response.model.topology.bodies();
        response.route = route.unwrap_or(if affine <= recursive { Route::Affine } else { Route::Recursive });
        Ok(response)
    }

    /// The route that samples take.
    pub fn route(&self) -> Route {
        self.route
    }

    /// Multiply-adds of a sample that the precomputed columns take, before the factorization.
    pub fn terms(&self) -> usize {
        self.columns.terms.len()
    }

    /// Whether damping and friction are part of the function.
    pub fn is_lossy(&self) -> bool {
        self.lossy
    }

    fn nv(&self) -> usize {
        self.model.topology.nv()
    }

    /// The force of one unit of damping or friction of a dof.
    fn loss(&self, field: TargetField, dof: usize) -> f64 {
        let v = self.state.v[dof];
        match field {
            TargetField::Damping(_) => v,
            // At rest dry friction takes any value between its bounds: here it is zero.
            TargetField::Friction(_) if v != 0.0 => v.signum(),
            _ => 0.0,
        }
    }

    /// The force of all damping and friction that is certain (`at` is `None`), or of all at a point.
    fn losses(&self, at: Option<&[f64]>) -> Vec<f64> {
        let mut losses = vec![0.0; self.nv()];
        if !self.lossy {
            return losses;
        }
        for (dof, loss) in losses.iter_mut().enumerate() {
            for (field, nominal) in
                [(TargetField::Damping(0), self.model.damping[dof]), (TargetField::Friction(0), self.model.friction[dof])]
            {
                let same = |edit: &&Dof| edit.dof == dof && edit.field.name().0 == field.name().0;
                let value = match (self.dofs.iter().find(same), at) {
                    (None, _) => nominal,
                    (Some(_), None) => 0.0,
                    (Some(edit), Some(x)) => follow(edit.acts, edit.nominal, x[edit.variable]),
                };
                *loss += value * self.loss(field, dof);
            }
        }
        losses
    }

    fn precompute(&mut self) -> Result<(), Error> {
        let (model, State { q, v, drive }) = (&self.model, &self.state);
        let nv = model.topology.nv();
        let count = TEN * model.described.len();
        // The parameters of the base and of each θ.
        let mut base = inertial_parameters::<f64, f64>(model);
        let zero = vec![0.0; self.inputs];
        let mut parameters = vec![vec![0.0; count]; self.inputs];
        for body in &self.bodies {
            let range = TEN * body.place..TEN * (body.place + 1);
            if body.bent {
                base[range.clone()].fill(0.0);
                parameters.extend(range.map(|column| (0..count).map(|c| f64::from(u8::from(c == column))).collect()));
            } else {
                base[range.clone()].copy_from_slice(&body.parameters(&zero));
                for (k, parameters) in parameters[..self.inputs].iter_mut().enumerate() {
                    parameters[range.clone()].copy_from_slice(&body.slope(&zero, k));
                }
            }
        }
        // Column i of M(π) is Y(q, 0, e_i) π without gravity; h(π) = Y(q, v, 0) π.
        let still = Model { gravity: Vec3::zero(), ..model.clone() };
        let unit = |i: usize| -> Vec<f64> { (0..nv).map(|k| f64::from(u8::from(k == i))).collect() };
        let rest = vec![0.0; nv];
        let masses = (0..nv).map(|i| torque_regressor(&still, q, &rest, &unit(i))).collect::<Result<Vec<_>, _>>()?;
        let bias = torque_regressor(model, q, v, &rest)?;
        let split = |parameters: &[f64]| -> Result<(DMatrix<f64>, Vec<f64>), DimensionError> {
            let (mut mass, mut h) = (DMatrix::zeros(nv, nv), vec![0.0; nv]);
            for (i, regressor) in masses.iter().enumerate() {
                regressor.mul(parameters, mass.column_mut(i).as_mut_slice())?;
            }
            bias.mul(parameters, &mut h)?;
            Ok((mass, h))
        };
        let with_dofs = |(mut mass, mut h): (DMatrix<f64>, Vec<f64>), theta: Option<usize>| {
            match theta {
                None => {
                    let uncertain =
                        |dof: usize| self.dofs.iter().any(|edit| edit.dof == dof && matches!(edit.field, TargetField::Armature(_)));
                    (0..nv).filter(|dof| !uncertain(*dof)).for_each(|dof| mass[(dof, dof)] += model.armature[dof]);
                    h.iter_mut().zip(self.losses(None)).for_each(|(h, loss)| *h += loss);
                }
                Some(k) => {
                    for edit in self.dofs.iter().filter(|edit| edit.variable == k) {
                        let slope = follow(edit.acts, edit.nominal, 1.0);
                        match edit.field {
                            TargetField::Armature(_) => mass[(edit.dof, edit.dof)] += slope,
                            field => h[edit.dof] += slope * self.loss(field, edit.dof),
                        }
                    }
                }
            }
            (mass, h)
        };
        let quantity = self.quantity;
        let rows = |(mass, h): (DMatrix<f64>, Vec<f64>)| -> Vec<f64> {
            match quantity {
                Quantity::Acceleration => {
                    let sparse = TreeSparse::from_fn(&model.topology, |i, j| mass[(i, j)]);
                    sparse.values().iter().copied().chain(h).collect()
                }
                Quantity::Torque => (mass * DVector::from_column_slice(drive)).iter().zip(h).map(|(moving, h)| moving + h).collect(),
            }
        };
        let first = rows(with_dofs(split(&base)?, None));
        let mut columns = Vec::with_capacity(parameters.len());
        for (k, parameters) in parameters.iter().enumerate() {
            columns.push(rows(with_dofs(split(parameters)?, Some(k))));
        }
        self.columns = Columns::new(first, &columns);
        Ok(())
    }

    /// The model of a point of the variables.
    pub fn model_at(&self, x: &[f64]) -> Model<f64> {
        let mut model = self.model.clone();
        for body in &self.bodies {
            let place = self.model.described[body.place];
            model.inertias[place] = compiled(&self.model, place, body.parameters(x));
        }
        for edit in self.dofs.iter().filter(|edit| matches!(edit.field, TargetField::Armature(_))) {
            model.armature[edit.dof] = follow(edit.acts, edit.nominal, x[edit.variable]);
        }
        model
    }

    /// The answer and its derivatives by the variables, at their means.
    ///
    /// # Errors
    /// [`Error`] when the mean robot has no answer.
    pub fn linear(&self) -> Result<Linear, Error> {
        let (nv, x) = (self.nv(), &self.means);
        let (model, losses) = (self.model_at(x), self.losses(Some(x)));
        let State { q, v, drive } = &self.state;
        let width = TEN * model.described.len();
        let mut by_parameters = vec![0.0; nv * width];
        // `inverse` takes a force to what it changes: −M⁻¹, or one.
        let (value, a, inverse) = match self.quantity {
            Quantity::Acceleration => {
                let force: Vec<f64> = drive.iter().zip(&losses).map(|(tau, loss)| tau - loss).collect();
                let mut a = vec![0.0; nv];
                let state = featherbench_dynamics::State { q, v, given: &force, wrenches: None };
                ParameterSensitivity::new(&model).run(&model, state, &mut a, &mut by_parameters)?;
                let factors = mass_matrix(&model, q)?.into_ltdl().map_err(featherbench_dynamics::Error::from)?;
                (a.clone(), a, DMatrix::from_row_slice(nv, nv, &factors.dense_inverse()) * -1.0)
            }
            Quantity::Torque => {
                let tau = inverse_dynamics(&model, q, v, drive)?;
                torque_regressor(&model, q, v, drive)?.write_dense(&mut by_parameters)?;
                (tau.iter().zip(&losses).map(|(tau, loss)| tau + loss).collect(), drive.clone(), DMatrix::identity(nv, nv))
            }
        };
        let by_parameters = DMatrix::from_row_slice(nv, width, &by_parameters);
        let mut jacobian = DMatrix::zeros(nv, self.inputs);
        for k in 0..self.inputs {
            let mut column = DVector::zeros(nv);
            for body in &self.bodies {
                for (j, slope) in body.slope(x, k).into_iter().enumerate() {
                    column += by_parameters.column(TEN * body.place + j) * slope;
                }
            }
            for edit in self.dofs.iter().filter(|edit| edit.variable == k) {
                let force = match edit.field {
                    TargetField::Armature(_) => a[edit.dof],
                    field => self.loss(field, edit.dof),
                };
                column += inverse.column(edit.dof) * (follow(edit.acts, edit.nominal, 1.0) * force);
            }
            jacobian.set_column(k, &column);
        }
        Ok(Linear { at: x.clone(), value: DVector::from_vec(value), jacobian })
    }

    /// The exact bounds of each torque over the supports of the variables.
    ///
    /// A torque is affine in them: its extremes are at corners, each variable at the end that its coefficient says.
    ///
    /// # Errors
    /// [`Error::Unbounded`] for accelerations, for an uncertain centre of mass, and for a support without an end.
    pub fn torque_bounds(&self, space: &Space) -> Result<Vec<[f64; 2]>, Error> {
        if self.quantity != Quantity::Torque {
            return Err(Error::Unbounded("accelerations are not affine in the parameters; ask for torques"));
        }
        if self.bodies.iter().any(|body| body.bent) {
            return Err(Error::Unbounded("an uncertain centre of mass makes torques quadratic in the parameters"));
        }
        let supports: Vec<[f64; 2]> = space.variables().iter().map(crate::Variable::support).collect();
        let mut begin = 0;
        let mut bounds = Vec::with_capacity(self.columns.base.len());
        for (base, end) in self.columns.base.iter().zip(&self.columns.ends) {
            let [mut least, mut most] = [*base; 2];
            for &(k, slope) in &self.columns.terms[begin..*end] {
                let [low, high] = supports[k as usize];
                let (down, up) = if slope > 0.0 { (low, high) } else { (high, low) };
                (least, most) = (slope.mul_add(down, least), slope.mul_add(up, most));
            }
            if !(least.is_finite() && most.is_finite()) {
                return Err(Error::Unbounded("a variable has no bounds; truncate it"));
            }
            bounds.push([least, most]);
            begin = *end;
        }
        Ok(bounds)
    }
}
