//! Bad input is refused.

use crate::support::{samples, truth};
use featherbench_learning::{BlackBox, Degrees, Dynamics, Lagrangian, Net, PortHamiltonian, ResidualError, Rollout, held_out};

const NET: Net = Net { hidden: 4, epsilon: 1e-3, seed: 1, patience: 1 };
const DEGREES: Degrees = Degrees { total: 2, damping: true };

#[test]
fn samples_are_checked() {
    let mut nan = samples(0.0);
    nan[5].tau[1] = f64::NAN;
    let mut short = samples(0.0);
    short[5].v.pop();
    let mut still = samples(0.0);
    still.iter_mut().for_each(|sample| sample.q = vec![0.1, 0.2]);
    for bad in [&[], nan.as_slice(), &still] {
        assert!(PortHamiltonian::fit(bad, DEGREES, 1e-9).is_err());
        assert!(BlackBox::fit(bad, 2, 1e-9).is_err());
    }
    for bad in [&[], nan.as_slice(), &short] {
        assert!(Lagrangian::fit(bad, NET).is_err());
    }
    assert!(matches!(PortHamiltonian::fit(&short, DEGREES, 1e-9), Err(ResidualError::Dimension(_))));
    assert!(held_out(&truth(), &[]).is_err());
}

#[test]
fn settings_are_checked() {
    let samples = samples(0.0);
    for lambda in [0.0, -1.0, f64::NAN] {
        assert!(PortHamiltonian::fit(&samples, DEGREES, lambda).is_err());
        assert!(BlackBox::fit(&samples, 2, lambda).is_err());
    }
    for net in [Net { hidden: 0, ..NET }, Net { epsilon: 0.0, ..NET }, Net { epsilon: f64::NAN, ..NET }, Net { patience: 0, ..NET }] {
        assert!(Lagrangian::fit(&samples, net).is_err());
    }
    let truth = truth();
    let tree = &truth.model().topology;
    let rollout = Rollout { start: vec![0.4, 0.3], step: 0.01, times: vec![1.0], bound: 3.0 };
    for bad in [
        Rollout { start: vec![0.0; 2], ..rollout.clone() },
        Rollout { step: 0.0, ..rollout.clone() },
        Rollout { start: vec![0.1], ..rollout.clone() },
    ] {
        assert!(bad.run(tree, &truth, &truth).is_err());
    }
    assert!(truth.inverse(&[0.0], &[0.0; 2], &[0.0; 2]).is_err());
}
