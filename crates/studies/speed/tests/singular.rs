//! A robot whose M is singular: our kernels answer what has an answer, and refuse the rest by known deviations alone.

use featherbench_bench::{Engine, Gates, Robot, Study};
use featherbench_comparison::Agreement;
use featherbench_doubles::{SEED, STATES, engines, gates_folder, whole};
use featherbench_engines::{Featherbench, timed};
use featherbench_results::{Feature, ModelOrigin, Verdict};
use featherbench_robots::Family;
use featherbench_speed::{Timing, TimingSettings};

/// A chain whose last body has no inertia, with the project's gates.
fn singular() -> (Robot, Gates) {
    let family = Family::parse("chain:n=4,layout=planar").unwrap();
    let mut description = family.generate().unwrap();
    description.name = "singular".into();
    let last = description.bodies.last_mut().unwrap();
    (last.mass, last.com, last.inertia) = (0.0, [0.0; 3], [0.0; 6]);
    let robot = Robot::new(&description, "singular", ModelOrigin::Generated, STATES, SEED).unwrap();
    assert!(robot.properties().features.contains(&Feature::SingularMass));
    let gates = Gates::read(&gates_folder(), &engines()).unwrap();
    let named = gates.with_robots([("singular".to_owned(), robot.properties())]).unwrap();
    (robot, named)
}

#[test]
fn what_a_singular_mass_matrix_leaves_without_an_answer_is_known() {
    let (robot, gates) = singular();
    let settings = TimingSettings {
        states: STATES,
        seconds: 0.0,
        engines: Vec::new(),
        quantities: Vec::new(),
        best_of: Vec::new(),
        derivatives: false,
    };
    let timing = Timing { settings, kernels: timed };
    let asked: [(&dyn Study, &[&str]); 2] =
        [(&Agreement, &["fd"]), (&timing, &["factorization", "fd", "fd_f32", "mass_matrix_inverse", "solve"])];
    for (study, without) in asked {
        let ours: [Box<dyn Engine>; 1] = [Box::new(Featherbench::new())];
        let rows = whole(study, &robot, &gates, &ours);
        let errors: Vec<_> = rows.iter().filter(|row| row.verdict == Verdict::Error).collect();
        let told: Vec<_> = errors.iter().map(|row| (&row.method, &row.quantity, &row.metric, &row.reason)).collect();
        assert!(errors.is_empty(), "{}: {told:?}", study.name());
        let known = |quantity: &str| rows.iter().any(|row| row.quantity == quantity && row.verdict == Verdict::Deviation);
        assert!(without.iter().all(|quantity| known(quantity)), "{}", study.name());
        assert!(!["id", "bias", "mass_matrix"].into_iter().any(known), "{}", study.name());
    }
}
