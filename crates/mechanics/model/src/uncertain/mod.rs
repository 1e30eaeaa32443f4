//! Uncertain parameters of a description: random variables, the numbers of the robot that follow them, and their correlations.
//!
//! They are data. A [`Model`](crate::Model) has the written numbers, which are the nominal ones; `featherbench_uncertainty` computes what the
//! variables do to the dynamics. Bodies are named by their index in the description.

mod defect;

pub use defect::UncertainDefect;

use crate::{Description, JointType, Malformed};
use std::collections::HashSet;

/// The uncertain parameters of a description.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Uncertain {
    /// The random variables.
    pub variables: Vec<UncertainVariable>,
    /// How pairs of them are correlated. Other pairs are independent given these.
    pub correlations: Vec<Correlation>,
}

/// A random variable, and the numbers of the robot that follow it.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertainVariable {
    /// Its name, unique among the variables.
    pub name: String,
    /// How it is distributed.
    pub distribution: Distribution,
    /// Whether a number is the variable, or its nominal value times the variable.
    pub acts: Acts,
    /// The numbers that follow it: one at least.
    pub on: Vec<Target>,
}

/// How a number follows a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acts {
    /// The number is the variable.
    Value,
    /// The number is its nominal value times the variable.
    Factor,
}

/// A distribution of one variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Constant density between two bounds.
    Uniform {
        /// The lower bound.
        low: f64,
        /// The upper bound.
        high: f64,
    },
    /// Its logarithm is normal. The two numbers are those of the variable itself.
    Lognormal {
        /// The mean.
        mean: f64,
        /// The standard deviation.
        deviation: f64,
    },
    /// Density ∝ x^(k−1) e^(−x/s), with mean ks and variance ks².
    Gamma {
        /// The mean.
        mean: f64,
        /// The standard deviation.
        deviation: f64,
    },
    /// Normal, for numbers of any sign.
    Normal {
        /// The mean.
        mean: f64,
        /// The standard deviation.
        deviation: f64,
    },
    /// Normal, given that it is between two bounds.
    TruncatedNormal {
        /// The mean before truncation.
        mean: f64,
        /// The standard deviation before truncation.
        deviation: f64,
        /// The lower bound.
        low: f64,
        /// The upper bound.
        high: f64,
    },
}

/// A number of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Target {
    /// The body; of a number of a joint, the body that the joint carries.
    pub body: usize,
    /// Which of its numbers.
    pub field: TargetField,
}

/// Which number of a body or its joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TargetField {
    /// The mass.
    Mass,
    /// Mass and inertia together, which change as the density does. It takes a factor alone.
    Density,
    /// x, y or z of the centre of mass.
    Com(usize),
    /// An entry of the inertia about the centre of mass: xx, xy, xz, yy, yz, zz.
    Inertia(usize),
    /// The armature of a dof.
    Armature(usize),
    /// The viscous damping of a dof.
    Damping(usize),
    /// The dry friction of a dof.
    Friction(usize),
}

/// The correlation of two variables: that of the normal variables behind them, which a Gaussian copula turns into the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correlation {
    /// The index of a variable.
    pub first: usize,
    /// The index of another.
    pub second: usize,
    /// Between −1 and 1.
    pub value: f64,
}

impl Distribution {
    /// The word for it in a description file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Uniform { .. } => "uniform",
            Self::Lognormal { .. } => "lognormal",
            Self::Gamma { .. } => "gamma",
            Self::Normal { .. } => "normal",
            Self::TruncatedNormal { .. } => "truncated_normal",
        }
    }

    /// Its numbers by name, in the order of a file.
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::Uniform { low, high } => vec![("low", low), ("high", high)],
            Self::Lognormal { mean, deviation } | Self::Gamma { mean, deviation } | Self::Normal { mean, deviation } => {
                vec![("mean", mean), ("deviation", deviation)]
            }
            Self::TruncatedNormal { mean, deviation, low, high } => {
                vec![("mean", mean), ("deviation", deviation), ("low", low), ("high", high)]
            }
        }
    }

    /// The infimum of its support.
    pub fn lowest(&self) -> f64 {
        match *self {
            Self::Uniform { low, .. } | Self::TruncatedNormal { low, .. } => low,
            Self::Lognormal { .. } | Self::Gamma { .. } => 0.0,
            Self::Normal { .. } => f64::NEG_INFINITY,
        }
    }

    /// An error unless its numbers make a distribution.
    ///
    /// # Errors
    /// The first [`UncertainDefect`].
    pub fn check(&self) -> Result<(), UncertainDefect> {
        for (field, value) in self.numbers() {
            if !value.is_finite() {
                return Err(UncertainDefect::NotFinite { field, value });
            }
        }
        let positive = |field, value| if value > 0.0 { Ok(()) } else { Err(UncertainDefect::NotPositive { field, value }) };
        let ordered = |low: f64, high: f64| if low < high { Ok(()) } else { Err(UncertainDefect::Bounds { low, high }) };
        match *self {
            Self::Uniform { low, high } => ordered(low, high),
            Self::Lognormal { mean, deviation } | Self::Gamma { mean, deviation } => {
                positive("mean", mean).and_then(|()| positive("deviation", deviation))
            }
            Self::Normal { deviation, .. } => positive("deviation", deviation),
            Self::TruncatedNormal { mean, deviation, low, high } => {
                positive("deviation", deviation)?;
                ordered(low, high)?;
                // Beyond three deviations on one side a thousandth is left, and quadrature in the normal variable has few points there.
                let reached = low < mean + 3.0 * deviation && high > mean - 3.0 * deviation;
                let wide = high - low > 2.5e-3 * deviation;
                if reached && wide { Ok(()) } else { Err(UncertainDefect::Tail { low, high }) }
            }
        }
    }
}

impl TargetField {
    /// The word for it in a description file, and the index, of the fields that have one.
    pub fn name(self) -> (&'static str, Option<usize>) {
        match self {
            Self::Mass => ("mass", None),
            Self::Density => ("density", None),
            Self::Com(index) => ("com", Some(index)),
            Self::Inertia(index) => ("inertia", Some(index)),
            Self::Armature(index) => ("armature", Some(index)),
            Self::Damping(index) => ("damping", Some(index)),
            Self::Friction(index) => ("friction", Some(index)),
        }
    }

    /// Whether the number must be positive (`Some(true)`), not negative (`Some(false)`), or may have any sign.
    fn sign(self) -> Option<bool> {
        match self {
            Self::Mass | Self::Density | Self::Inertia(0 | 3 | 5) => Some(true),
            Self::Armature(_) | Self::Damping(_) | Self::Friction(_) => Some(false),
            Self::Com(_) | Self::Inertia(_) => None,
        }
    }
}

impl Description {
    /// The nominal value of a number; of a density, one. `None` if the robot has no such number.
    pub fn nominal(&self, target: Target) -> Option<f64> {
        let body = self.bodies.get(target.body)?;
        let per_dof = |list: &[f64], k: usize| (k < body.joint.kind.nv()).then(|| list.get(k).copied().unwrap_or(0.0));
        match target.field {
            TargetField::Mass => Some(body.mass),
            TargetField::Density => Some(1.0),
            TargetField::Com(k) => body.com.get(k).copied(),
            TargetField::Inertia(k) => body.inertia.get(k).copied(),
            TargetField::Armature(k) => per_dof(&body.joint.armature, k),
            TargetField::Damping(k) => per_dof(&body.joint.damping, k),
            TargetField::Friction(k) => per_dof(&body.joint.friction, k),
        }
    }

    /// The first malformed uncertain variable or correlation.
    pub(crate) fn validate_uncertain(&self) -> Result<(), Malformed> {
        let Uncertain { variables, correlations } = &self.uncertain;
        let (mut names, mut taken) = (HashSet::new(), HashSet::new());
        for (index, variable) in variables.iter().enumerate() {
            let bad = |defect| Malformed::Uncertain { name: variable.name.clone(), place: Some(index), defect };
            if !names.insert(variable.name.as_str()) {
                return Err(bad(UncertainDefect::DuplicateName));
            }
            variable.distribution.check().map_err(bad)?;
            if variable.on.is_empty() {
                return Err(bad(UncertainDefect::NoTarget));
            }
            for &target in &variable.on {
                self.check_target(variable, target).map_err(bad)?;
                let TargetField::Density = target.field else {
                    if taken.insert(target) {
                        continue;
                    }
                    return Err(bad(repeated(target)));
                };
                // A density is mass and inertia.
                for field in [TargetField::Mass].into_iter().chain((0..6).map(TargetField::Inertia)) {
                    if !taken.insert(Target { field, ..target }) {
                        return Err(bad(repeated(target)));
                    }
                }
            }
        }
        let bad = |defect| Malformed::Uncertain { name: "correlations".into(), place: None, defect };
        let mut pairs = HashSet::new();
        for (index, &Correlation { first, second, value }) in correlations.iter().enumerate() {
            let what = if first >= variables.len() || second >= variables.len() {
                format!("there are {} variables, counted from 0", variables.len())
            } else if first == second {
                format!("'{}' is correlated with itself", variables[first].name)
            } else if !pairs.insert((first.min(second), first.max(second))) {
                format!("'{}' and '{}' are named twice", variables[first].name, variables[second].name)
            } else if !(value > -1.0 && value < 1.0) {
                format!("the value is {value}; it is between -1 and 1")
            } else {
                continue;
            };
            return Err(bad(UncertainDefect::Correlation { index, what }));
        }
        match self.uncertain.correlation_factor() {
            Ok(_) => Ok(()),
            Err(pivot) => Err(bad(UncertainDefect::Indefinite { pivot })),
        }
    }

    fn check_target(&self, variable: &UncertainVariable, target: Target) -> Result<(), UncertainDefect> {
        let (body, count) = (target.body, self.bodies.len());
        let described = self.bodies.get(body).ok_or(UncertainDefect::NoBody { body, count })?;
        let (field, index) = target.field.name();
        if described.joint.kind == JointType::Fixed {
            return Err(UncertainDefect::FixedBody { body });
        }
        let count = match target.field {
            TargetField::Com(_) => 3,
            TargetField::Inertia(_) => 6,
            _ => described.joint.kind.nv(),
        };
        if let Some(index) = index.filter(|index| *index >= count) {
            return Err(UncertainDefect::NoIndex { body, field, index, count });
        }
        if described.joint.kind == JointType::Free && matches!(target.field, TargetField::Armature(_)) {
            return Err(UncertainDefect::FreeArmature { body });
        }
        match (variable.acts, target.field) {
            (Acts::Value, TargetField::Density) => return Err(UncertainDefect::DensityValue { body }),
            (Acts::Factor, _) if self.nominal(target) == Some(0.0) => return Err(UncertainDefect::FactorOfZero { body, field }),
            _ => {}
        }
        let Some(positive) = target.field.sign() else { return Ok(()) };
        let low = variable.distribution.lowest();
        match variable.distribution {
            Distribution::Normal { .. } => Err(UncertainDefect::Gaussian { body, field }),
            // Densities of these vanish at zero faster than any power; of the gamma distribution, as x^(k−1) with k = (mean/deviation)².
            Distribution::Lognormal { .. } => Ok(()),
            Distribution::Gamma { mean, deviation } if positive && deviation >= mean * std::f64::consts::FRAC_1_SQRT_2 => {
                Err(UncertainDefect::HeavyGamma { mean, deviation, limit: std::f64::consts::FRAC_1_SQRT_2 })
            }
            Distribution::Gamma { .. } => Ok(()),
            _ if positive && low <= 0.0 => Err(UncertainDefect::Reaches { body, field, demand: "stay above zero", low }),
            _ if low < 0.0 => Err(UncertainDefect::Reaches { body, field, demand: "not be negative", low }),
            _ => Ok(()),
        }
    }
}

fn repeated(target: Target) -> UncertainDefect {
    UncertainDefect::Repeated { body: target.body, field: target.field.name().0 }
}

impl Uncertain {
    /// Whether there are no variables.
    pub fn is_empty(&self) -> bool {
        self.variables.is_empty() && self.correlations.is_empty()
    }

    /// L of the correlation matrix R = L Lᵀ of the normal variables: row i has i + 1 numbers.
    ///
    /// # Errors
    /// The first pivot that is not above 1e-12: R is not positive definite then, by more than the rounding of its elimination.
    pub fn correlation_factor(&self) -> Result<Vec<Vec<f64>>, f64> {
        let count = self.variables.len();
        let mut rows: Vec<Vec<f64>> = (0..count).map(|i| (0..=i).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        for correlation in &self.correlations {
            let (low, high) = (correlation.first.min(correlation.second), correlation.first.max(correlation.second));
            if let Some(entry) = rows.get_mut(high).and_then(|row| row.get_mut(low)) {
                *entry = correlation.value;
            }
        }
        // Cholesky's elimination, row by row.
        for i in 0..count {
            for j in 0..=i {
                let (above, row) = rows.split_at(i);
                let row = &row[0];
                let known: f64 = (0..j).map(|k| row[k] * if j == i { row[k] } else { above[j][k] }).sum();
                let rest = row[j] - known;
                rows[i][j] = if j < i {
                    rest / rows[j][j]
                } else if rest > 1e-12 {
                    rest.sqrt()
                } else {
                    return Err(rest);
                };
            }
        }
        Ok(rows)
    }
}
