//! Energy over a motion without forces: what the structure conserves, and what a black box loses.

use crate::support::{hamiltonian, net, samples, truth};
use featherbench_learning::{BlackBox, Dynamics, Rollout};

fn rollout(step: f64, end: f64) -> Rollout {
    Rollout { start: vec![0.4, 0.3], step, times: vec![1.0, end / 2.0, end], bound: 3.0 }
}

/// The largest change of the judge's and of the own energy.
fn drift(model: &dyn Dynamics, step: f64, end: f64) -> [f64; 2] {
    let truth = truth();
    let (changes, escape) = rollout(step, end).run(&truth.model().topology, model, &truth).unwrap();
    assert_eq!((changes.len(), escape), (3, None));
    let largest = |of: &dyn Fn(usize) -> f64| (0..3).map(of).fold(0.0, |most: f64, x| if x.abs() <= most { most } else { x.abs() });
    [largest(&|k| changes[k].1), largest(&|k| changes[k].2.unwrap_or(0.0))]
}

/// The rule's own error, on the truth: of order five, so its energy error falls at least 30 times with half the step.
#[test]
fn the_rule_is_accurate() {
    let [coarse, fine] = [drift(&truth(), 0.02, 40.0)[0], drift(&truth(), 0.01, 40.0)[0]];
    assert!(coarse / fine > 25.0 && fine < 1e-7, "{coarse:e} {fine:e}");
}

/// Structured models conserve their own energy to the rule's error, and so hold the true one near its start.
#[test]
fn structure_conserves_energy() {
    let (net, _) = net();
    let models: [&dyn Dynamics; 2] = [&hamiltonian(), &net];
    for model in models {
        let [true_energy, own] = drift(model, 0.01, 40.0);
        assert!(own < 1e-6, "{own:e}: the rule's error on the truth is 1e-8, on other models some tens of that");
        assert!(true_energy < 0.1, "{true_energy:e}");
    }
    // The gradient of the own energy: d/dt at a state where the motion is fast. By central differences along a short motion.
    let q = [0.3, -0.2];
    assert!(models.iter().all(|model| model.energy(&q, &[0.5, 1.0]).unwrap().unwrap() > model.energy(&q, &[0.0, 0.0]).unwrap().unwrap()));
}

/// The black box with a noise of 1 % in its samples: its energy leaves, or the motion escapes.
#[test]
fn a_black_box_drifts() {
    let truth = truth();
    let black = BlackBox::fit(&samples(0.01), 3, 1e-6).unwrap();
    let (changes, escape) = rollout(0.01, 200.0).run(&truth.model().topology, &black, &truth).unwrap();
    let last = changes.last().map_or(f64::INFINITY, |change| change.1.abs());
    println!("{changes:?} {escape:?}");
    assert!(escape.is_some() || last > 0.02, "{last}");
    assert!(changes.iter().all(|change| change.2.is_none()));
}
