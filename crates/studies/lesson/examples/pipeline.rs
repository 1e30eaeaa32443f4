//! Problem 5 of the lesson: `cargo run -p featherbench-lesson --example pipeline`.

use featherbench_lesson::Failure;
use featherbench_lesson::pipeline::{STAGES, Setting, run};

fn main() -> Result<(), Failure> {
    let noisy = Setting::default();
    let settings = [
        ("as it is", noisy),
        ("without noise", Setting { noise: 0.0, ..noisy }),
        ("without noise and couplings", Setting { noise: 0.0, coupling: 0.0, ..noisy }),
    ];
    for (name, setting) in settings {
        let outcome = run(&setting)?;
        println!("{name}: {} base parameters, noise {:.1e} of the torques", outcome.identified, outcome.noise);
        for (stage, (logged, held_out)) in STAGES.iter().zip(outcome.logged.iter().zip(outcome.held_out)) {
            println!("  {stage:<16} log {logged:.2e}   held out {held_out:.2e}");
        }
        let [log, unseen] = outcome.touching.map(|share| 100.0 * share);
        println!(
            "  touching the ground: {log:.0} % and {unseen:.0} %; parameters off by {:.1e}, together {:.1e}; rank of the residual {}",
            outcome.parameters[0], outcome.parameters[1], outcome.rank
        );
    }
    Ok(())
}
