//! Forward dynamics of a humanoid that carries a rod of many links, beside a rigid chain of as many joints: time per joint.
//!
//! `cargo run --release -p featherbench-continua --example rod_on_humanoid [LINKS] [CALLS]`; 100000 links and 7 calls without arguments.
//!
//! What is measured: one call of `Solver::forward` on the humanoid with the rod, at rest, and one of `Aba::run` on the chain, at zero. A link is one
//! joint with a spring, so that both trees have one joint per link. A call of one is followed by one of the other; the smallest time of each
//! counts, over its number of dofs. Building the models is not in it. The answers and the number of operations per link are tested in
//! `tests/coupling.rs`.

use featherbench_continua::{Assembly, Element, Hinges, Rod, Solver, Strain};
use featherbench_dynamics::Aba;
use featherbench_model::{Model, Placement};
use featherbench_robots::Family;
use std::error::Error;
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let links: usize = arguments.next().map_or(Ok(100_000), |text| text.parse())?;
    let calls: usize = arguments.next().map_or(Ok(7), |text| text.parse())?;

    let mut assembly = Assembly::new(Family::parse("humanoid")?.generate()?);
    let host = assembly.description().bodies.len().checked_sub(1);
    // Elements of a centimetre. EI = 1 N·m², ρA = 0.1 kg/m.
    let rod = Rod::textbook(1.0, 0.1, 0.01 * links as f64)?;
    let element = Element::Links { count: links, hinges: Hinges::Middle, strains: vec![Strain::BendZ] };
    assembly.attach("rod", &rod, &element, host, Placement::default())?;
    let continuum = assembly.build()?;
    let chain: Model<f64> = Model::build(&Family::parse(&format!("chain:n={links}"))?.generate()?)?;

    let (rod_dofs, chain_dofs) = (continuum.topology().nv(), chain.topology.nv());
    let (mut solver, mut aba) = (Solver::new(&continuum), Aba::new(&chain.topology));
    let s = continuum.rest();
    let zeros = vec![0.0; rod_dofs.max(chain_dofs)];
    let (mut second, mut a) = (vec![0.0; rod_dofs], vec![0.0; chain_dofs]);
    let q = featherbench_model::neutral::<f64>(&chain.topology);
    let (mut best_rod, mut best_chain) = (Duration::MAX, Duration::MAX);
    for _ in 0..calls {
        let start = Instant::now();
        solver.forward(&continuum, &s, &zeros[..rod_dofs], &zeros[..rod_dofs], &[], &mut second)?;
        best_rod = best_rod.min(start.elapsed());
        let start = Instant::now();
        aba.run(&chain, &q, &zeros[..chain_dofs], &zeros[..chain_dofs], None, &mut a)?;
        best_chain = best_chain.min(start.elapsed());
    }
    let per = |time: Duration, dofs: usize| time.as_secs_f64() * 1e9 / dofs as f64;
    let (rod_time, chain_time) = (per(best_rod, rod_dofs), per(best_chain, chain_dofs));
    println!("humanoid with a rod: {rod_dofs} dofs, {rod_time:.1} ns per dof");
    println!("rigid chain:         {chain_dofs} dofs, {chain_time:.1} ns per dof");
    println!("ratio:               {:.2}", rod_time / chain_time);
    Ok(())
}
