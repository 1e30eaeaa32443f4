//! The uncertain numbers of a robot: those of its bodies, of its dofs, and the affine functions that they make.

use crate::Lanes;
use featherbench_model::{Acts, Model, TargetField};
use featherbench_spatial::{Dual, Real, RigidBodyInertia, Sym3, Vec3};

/// Inertial parameters of a body.
pub(super) const TEN: usize = 10;

/// A body that has uncertain numbers.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Its place among the described bodies.
    pub(super) place: usize,
    pub(super) mass: f64,
    pub(super) com: [f64; 3],
    pub(super) inertia: [f64; 6],
    pub(super) edits: Vec<(usize, Acts, TargetField)>,
    /// Whether its centre of mass is uncertain: its parameters are not affine in the variables.
    pub(super) bent: bool,
}

/// An uncertain number of a dof.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dof {
    pub(super) dof: usize,
    pub(super) variable: usize,
    pub(super) acts: Acts,
    pub(super) nominal: f64,
    pub(super) field: TargetField,
}

/// Affine functions of θ: numbers of M in its tree-sparse order, then those of h; or those of τ alone.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    pub(super) base: Vec<f64>,
    /// Where the terms of each row end.
    pub(super) ends: Vec<usize>,
    /// θ's index and its coefficient.
    pub(super) terms: Vec<(u32, f64)>,
}

impl Columns {
    /// From dense columns: the base, and one for each θ.
    pub(super) fn new(base: Vec<f64>, columns: &[Vec<f64>]) -> Self {
        let (mut ends, mut terms) = (Vec::with_capacity(base.len()), Vec::new());
        for row in 0..base.len() {
            let here = columns.iter().enumerate().map(|(j, column)| (j as u32, column[row]));
            terms.extend(here.filter(|(_, coefficient)| *coefficient != 0.0));
            ends.push(terms.len());
        }
        Self { base, ends, terms }
    }

    pub(super) fn run(&self, theta: &[Lanes], mut write: impl FnMut(usize, Lanes)) {
        let mut begin = 0;
        for (row, (base, end)) in self.base.iter().zip(&self.ends).enumerate() {
            let terms = self.terms[begin..*end].iter();
            let sum = terms.fold(Lanes::from_f64(*base), |sum, (j, c)| theta[*j as usize].mul_add(Lanes::from_f64(*c), sum));
            write(row, sum);
            begin = *end;
        }
    }
}

/// A number that follows a variable.
pub(super) fn follow<T: Real>(acts: Acts, nominal: f64, x: T) -> T {
    match acts {
        Acts::Value => x,
        Acts::Factor => T::from_f64(nominal) * x,
    }
}

impl Body {
    /// The ten parameters: mass, m c, and the inertia about the origin, `I_c + m (|c|² 1 − c cᵀ)`.
    pub(super) fn parameters<T: Real>(&self, x: &[T]) -> [T; TEN] {
        let (mut mass, mut com, mut inertia) = (T::from_f64(self.mass), self.com.map(T::from_f64), self.inertia.map(T::from_f64));
        for &(variable, acts, field) in &self.edits {
            let x = x[variable];
            match field {
                TargetField::Mass => mass = follow(acts, self.mass, x),
                TargetField::Density => {
                    mass = follow(Acts::Factor, self.mass, x);
                    inertia = self.inertia.map(|entry| follow(Acts::Factor, entry, x));
                }
                TargetField::Com(k) => com[k] = follow(acts, self.com[k], x),
                TargetField::Inertia(k) => inertia[k] = follow(acts, self.inertia[k], x),
                TargetField::Armature(_) | TargetField::Damping(_) | TargetField::Friction(_) => {}
            }
        }
        let [cx, cy, cz] = com;
        let [mx, my, mz] = com.map(|c| mass * c);
        let [xx, xy, xz, yy, yz, zz] = inertia;
        [mass, mx, my, mz, xx + my * cy + mz * cz, xy - mx * cy, xz - mx * cz, yy + mx * cx + mz * cz, yz - my * cz, zz + mx * cx + my * cy]
    }

    /// The derivatives of the ten parameters by a variable.
    pub(super) fn slope(&self, x: &[f64], variable: usize) -> [f64; TEN] {
        let seeded = |(k, x): (usize, &f64)| Dual::new(*x, f64::from(u8::from(k == variable)));
        let x: Vec<Dual<f64>> = x.iter().enumerate().map(seeded).collect();
        self.parameters(&x).map(|parameter| parameter.derivative)
    }
}

/// The ten parameters as the inertia of a body in its compiled axes.
pub(super) fn compiled<T: Real>(model: &Model<f64>, body: usize, parameters: [T; TEN]) -> RigidBodyInertia<T> {
    let label = model.labels[body];
    let [mass, x, y, z, xx, xy, xz, yy, yz, zz] = parameters;
    // B Ī Bᵀ, by two turns of columns.
    let half = label.rotation_to_compiled(Sym3::from_array([xx, xy, xz, yy, yz, zz]).to_mat3()).transpose();
    let rotational = Sym3::from_upper(label.rotation_to_compiled(half));
    RigidBodyInertia { mass, first_moment: label.to_compiled(Vec3::new(x, y, z)), rotational }
}
