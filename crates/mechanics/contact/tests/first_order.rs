//! First-order solvers: their rate where no closed form is known, and their cap. The closed forms are cases of the study `contact`.

use featherbench_contact::systems::Stack;
use featherbench_contact::{Admm, GaussSeidel, Solver, rate};

/// Of a stack without a closed form the fitted rate is the predicted one too, within 1e-4.
#[test]
fn gauss_seidel_falls_at_its_rate() {
    let stack = Stack { masses: vec![3.0, 1.0, 4.0], gravity: 9.81 };
    assert_eq!(stack.rate(), None);
    let problem = stack.problem().unwrap();
    let solution = GaussSeidel::default().solve(&problem).unwrap();
    assert_eq!(solution.status(), "converged");
    let (found, due) = (rate::fitted(&solution.steps).unwrap(), rate::gauss_seidel(&problem).unwrap());
    assert!((found - due).abs() < 1e-4 * due, "{found} {due}");
}

/// A cap is no convergence, for each iterative solver.
#[test]
fn a_cap_is_no_convergence() {
    let problem = Stack::two(1000.0).problem().unwrap();
    for solver in [&GaussSeidel { sweeps: 50, ..GaussSeidel::default() } as &dyn Solver, &Admm { iterations: 3, ..Admm::default() }] {
        let solution = solver.solve(&problem).unwrap();
        assert_eq!(solution.status(), "cap_reached", "{}", solver.name());
        assert!(solution.point().is_none() && solution.points().is_empty());
    }
}
