//! What the tests share: the arm, its motions, and models that learned from them.

use featherbench_learning::{Arm, Degrees, Fit, Lagrangian, Motion, Net, PortHamiltonian, Sample, Truth};
use featherbench_model::Model;

pub fn truth() -> Truth {
    let arm = Arm { masses: vec![2.0, 1.0], lengths: vec![1.0, 0.5], gravity: 9.81 };
    Truth::new(Model::build(&arm.describe()).unwrap()).unwrap()
}

pub const MOTION: Motion = Motion { amplitude: 0.8, frequency: 0.8, harmonics: 5, trajectories: 3, samples: 60, noise: 0.0 };

pub fn samples(noise: f64) -> Vec<Sample> {
    Motion { noise, ..MOTION }.samples(&truth(), 1, "learn").unwrap()
}

pub fn unseen() -> Vec<Sample> {
    Motion { trajectories: 2, ..MOTION }.samples(&truth(), 1, "held out").unwrap()
}

pub fn net() -> (Lagrangian, Fit) {
    Lagrangian::fit(&samples(0.0), Net { hidden: 8, epsilon: 1e-3, seed: 1, patience: 1 }).unwrap()
}

pub fn hamiltonian() -> PortHamiltonian {
    PortHamiltonian::fit(&samples(0.0), Degrees { total: 6, damping: false }, 1e-12).unwrap()
}
