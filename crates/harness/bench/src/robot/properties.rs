//! The properties of a robot, computed from its description, its states and its file. Known deviations are told by them.

use crate::measure::worst;
use crate::{FileFormat, Robot};
use featherbench_dynamics::{Bias, Crba, TreeSparse};
use featherbench_model::{BodyDescription, JointKind, JointType, Warning};
use featherbench_results::{Base, Feature, Properties};
use featherbench_robots::Case;

/// κ(M) is computed up to this many degrees of freedom.
const CONDITION_LIMIT: usize = 256;
/// Steps of iteration for each extreme eigenvalue of M. They find λ_min from above and λ_max from below: κ is never overrated.
const ITERATIONS: usize = 12;
/// What single precision holds: 24 bits.
const SINGLE: f64 = (1_u64 << 24) as f64;
/// An axis of +x, +y or +z misses it by less than this.
const AXIS_TOLERANCE: f64 = 1e-12;
const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

impl Robot {
    /// Its properties.
    pub fn properties(&self) -> Properties {
        let bodies = &self.description.bodies;
        let armed = bodies.iter().filter(|body| has_armature(body)).map(|body| body.joint.kind.name());
        let mut armature: Vec<String> = armed.map(str::to_owned).collect();
        armature.sort_unstable();
        armature.dedup();
        let masses = || bodies.iter().map(|body| body.mass).filter(|&mass| mass > 0.0);
        let (largest, least) = (masses().reduce(worst), masses().map(|mass| -mass).reduce(worst).map(|mass| -mass));
        let mass_ratio = largest.zip(least).map_or(0.0, |(largest, least)| largest / least);
        let [x, y, z] = bodies.first().map_or([0.0; 3], |body| body.joint.placement.translation);
        Properties {
            joints: self.joint_kinds().into_iter().map(str::to_owned).collect(),
            armature,
            base: if self.base() == Base::Free.as_str() { Base::Free } else { Base::Fixed },
            dofs: self.states.nv as u64,
            offset: x.hypot(y).hypot(z),
            mass_ratio: if mass_ratio.is_finite() { mass_ratio } else { 1.0 },
            features: self.features(),
        }
    }

    /// The features that it has, in the order of declaration.
    fn features(&self) -> Vec<Feature> {
        let of_file = self.file.as_ref().map(|file| file.features.as_slice()).unwrap_or_default();
        Feature::ALL.iter().copied().filter(|&feature| self.has(feature) || of_file.contains(&feature)).collect()
    }

    /// Whether its description has a feature. Those of files are not in it.
    fn has(&self, feature: Feature) -> bool {
        let bodies = &self.description.bodies;
        match feature {
            Feature::FreeJointOnBody => bodies.iter().any(|body| body.joint.kind == JointType::Free && body.parent.is_some()),
            Feature::SeveralRoots => {
                let is_mjcf = self.file.as_ref().is_some_and(|file| file.format == FileFormat::Mjcf);
                is_mjcf && bodies.iter().filter(|body| body.parent.is_none()).count() > 1
            }
            Feature::SkewArmature => bodies.iter().any(|body| has_armature(body) && is_skew(body)),
            Feature::JointChain => (0..bodies.len()).any(|body| self.is_only_a_joint(body)),
            Feature::ImpossibleBody => self.has_impossible_body(),
            Feature::SingularMass => self.mass_matrix().is_some_and(|mass| mass.diagonal().any(|entry| entry <= 0.0)),
            Feature::Balanced => self.at_rest().any(|state| self.is_balanced(state)),
            Feature::BeyondSingle => self.condition().is_some_and(|condition| condition > SINGLE),
            Feature::NegativeMoment
            | Feature::FixedMimic
            | Feature::UnknownMimic
            | Feature::Unnamed
            | Feature::WorldSite
            | Feature::HeightField
            | Feature::MeshWithoutInertial
            | Feature::MeshFormat => false,
        }
    }

    /// Its states of rest at the neutral configuration.
    fn at_rest(&self) -> impl Iterator<Item = usize> + '_ {
        self.states.cases.iter().enumerate().filter(|(_, case)| **case == Case::Zero).map(|(state, _)| state)
    }

    /// Whether a body is only a joint before its one child, whose joint frame has the same axes.
    fn is_only_a_joint(&self, index: usize) -> bool {
        let bodies = &self.description.bodies;
        let body = &bodies[index];
        let mut children = bodies.iter().filter(|other| other.parent == Some(index));
        let (Some(child), None) = (children.next(), children.next()) else { return false };
        let free = |body: &BodyDescription| body.joint.kind == JointType::Free;
        body.mass == 0.0
            && body.com == [0.0; 3]
            && body.inertia == [0.0; 6]
            && child.joint.placement.rotation == IDENTITY
            && !free(body)
            && !free(child)
    }

    fn has_impossible_body(&self) -> bool {
        self.description.warnings().iter().any(|warning| match warning {
            Warning::Unphysical { .. } => true,
            Warning::Massless { body } => {
                let index = self.description.bodies.iter().position(|other| other.name == *body);
                !index.is_some_and(|index| self.is_only_a_joint(index))
            }
            Warning::Normalised { .. } | Warning::Loops { .. } => false,
        })
    }

    /// Whether the given forces are exactly those at which the robot does not accelerate.
    fn is_balanced(&self, state: usize) -> bool {
        let states = &self.states;
        let mut bias = vec![f64::NAN; states.nv];
        let evaluated = Bias::new(&self.model.topology).run(&self.model, states.q(state), states.v(state), None, &mut bias);
        evaluated.is_ok() && bias == states.tau(state)
    }

    /// The neutral configuration: zeros, and quaternions without rotation.
    fn neutral(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.states.nq];
        for joint in self.model.topology.joints() {
            if matches!(joint.kind, JointKind::Spherical | JointKind::Free) {
                q[joint.q + joint.kind.nq() - 1] = 1.0;
            }
        }
        q
    }

    /// M at the neutral configuration.
    fn mass_matrix(&self) -> Option<TreeSparse<f64>> {
        let topology = &self.model.topology;
        let mut mass = TreeSparse::new(topology);
        Crba::new(topology).run(&self.model, &self.neutral(), &mut mass).ok()?;
        Some(mass)
    }

    /// κ(M) at the neutral configuration, from below; `None` if it is not computed, or if M is singular.
    fn condition(&self) -> Option<f64> {
        let n = self.states.nv;
        let mass = self.mass_matrix().filter(|_| n <= CONDITION_LIMIT)?;
        let factors = mass.clone().into_ltdl().ok()?;
        let start: Vec<f64> = (0..n).map(|dof| if dof % 2 == 0 { 1.0 } else { -1.0 } / (dof + 1) as f64).collect();
        let largest = growth(start.clone(), |x| {
            let mut y = vec![0.0; n];
            mass.mul(x, &mut y).ok()?;
            Some(y)
        })?;
        let least = growth(start, |x| {
            let mut y = x.to_vec();
            factors.solve(&mut y).ok()?;
            Some(y)
        })?;
        Some(largest * least)
    }
}

/// The growth of the vector's length in the last of some steps: at most the largest eigenvalue of the map, which is symmetric.
fn growth(mut x: Vec<f64>, map: impl Fn(&[f64]) -> Option<Vec<f64>>) -> Option<f64> {
    let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut grown = 0.0;
    for _ in 0..ITERATIONS {
        let before = length(&x);
        x.iter_mut().for_each(|x| *x /= before);
        x = map(&x)?;
        grown = length(&x);
    }
    Some(grown)
}

fn has_armature(body: &BodyDescription) -> bool {
    body.joint.armature.iter().any(|&armature| armature != 0.0)
}

/// Whether a revolute joint turns about another axis than +x, +y and +z of its frame.
fn is_skew(body: &BodyDescription) -> bool {
    let JointType::Revolute { axis } = body.joint.kind else { return false };
    axis.iter().all(|&x| (x - 1.0).abs() > AXIS_TOLERANCE)
}
