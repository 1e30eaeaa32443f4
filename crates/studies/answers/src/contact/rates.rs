//! How fast first-order solvers converge: predicted from the matrix, and fitted to the steps of a run.

use super::{Case, error, failed, told};
use featherbench_bench::NoAnswer;
use featherbench_contact::systems::Stack;
use featherbench_contact::{Admm, GaussSeidel, Solver, rate};
use serde_json::json;

const QUANTITY: &str = "convergence";

pub(super) fn cases() -> Vec<Case> {
    stacks().into_iter().flat_map(|(name, stack)| gauss_seidel(&name, stack.clone()).into_iter().chain(admm(&name, &stack))).collect()
}

/// Two bodies of the mass ratio R have ρ = R/(1 + R), and n equal ones cos²(π/2n).
fn stacks() -> Vec<(String, Stack)> {
    let two = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0].map(|ratio| (format!("stack of two, {ratio}"), Stack::two(ratio)));
    let equal = [3, 4, 8, 20].map(|count| (format!("stack of {count}"), Stack::equal(count)));
    two.into_iter().chain(equal).collect()
}

fn gauss_seidel(name: &str, stack: Stack) -> Option<Case> {
    stack.rate()?;
    Some(Case {
        name: name.into(),
        quantity: QUANTITY,
        method: "gauss_seidel".into(),
        params: json!({"masses": stack.masses}),
        numbers: vec![error("rate_error", "closed form"), told("iterations", "1"), told("rate", "1"), error("fitted_rate_error", "theory")],
        evaluate: Box::new(move |_| {
            let problem = stack.problem().map_err(failed)?;
            let due = stack.rate().ok_or_else(|| NoAnswer::Failed("the stack has no closed form".into()))?;
            let predicted = rate::gauss_seidel(&problem).ok_or_else(|| NoAnswer::Failed("a diagonal entry is not positive".into()))?;
            let solution = GaussSeidel { sweeps: 100_000, ..GaussSeidel::default() }.solve(&problem).map_err(failed)?;
            let mut numbers = vec![(predicted - due).abs(), solution.iterations as f64, predicted];
            // Few steps have no rate to fit: two equal bodies need some thirty.
            numbers.extend(rate::fitted(&solution.steps).map(|fitted| (fitted / due - 1.0).abs()));
            Ok(numbers)
        }),
    })
}

/// ρ/(ρ + λ_min) while all contacts stay closed.
fn admm(name: &str, stack: &Stack) -> Vec<Case> {
    let of = |rho: f64| {
        let stack = stack.clone();
        Case {
            name: name.into(),
            quantity: QUANTITY,
            method: format!("admm, ρ = {rho}"),
            params: json!({"masses": stack.masses, "rho": rho}),
            numbers: vec![told("iterations", "1"), told("rate", "1"), error("fitted_rate_error", "theory")],
            evaluate: Box::new(move |_| {
                let problem = stack.problem().map_err(failed)?;
                let solution = Admm { rho: Some(rho), ..Admm::default() }.solve(&problem).map_err(failed)?;
                let due = rate::admm(&problem, rho);
                let mut numbers = vec![solution.iterations as f64, due];
                numbers.extend(rate::fitted(&solution.steps).map(|fitted| (fitted / due - 1.0).abs()));
                Ok(numbers)
            }),
        }
    };
    [0.05, 0.5, 2.0].map(of).into()
}
