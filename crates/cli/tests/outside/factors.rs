//! Libraries of linear algebra that factorize M, if they are built: faer and nalgebra. Their answers against our own kernels, and their fill-in.

use super::native::{self, Found};
use featherbench_bench::{Engine, NoAnswer, Quantity, Robot};
use featherbench_engines::Oracle;

fn ask(engine: &dyn Engine, robot: &Robot, quantity: Quantity, method: &str) -> Result<Vec<f64>, NoAnswer> {
    let mut prepared = engine.prepare(robot, quantity, method, &robot.states)?;
    prepared.run(0..1)?;
    Ok(prepared.read().to_vec())
}

/// Factors and solutions by every method: of all joints, several trees on the world, floating bases, armature, and sizes at which faer takes
/// supernodes.
pub fn agrees(engine: &Oracle) {
    let words = [
        "chain-spatial-10",
        "chain-spatial-100",
        "binary_tree:depth=6",
        "star-30",
        "humanoid",
        "quadruped",
        "hand",
        "g1",
        "tree-all-16-spread0.3-seed5-free",
        "tree-common-16-spread0.3-seed4-free-armature",
        "tree:n=100,seed=6,spread=0.3",
        "platform:robots=20,n=7",
    ];
    let methods: usize =
        [Quantity::Factorization, Quantity::Solve, Quantity::FactorEntries].iter().map(|of| engine.methods(*of).len()).sum();
    for words in words {
        let found = native::compare(engine, &native::robot(words, 4), &[]);
        // What it read back is one more.
        assert_eq!(found.len(), methods + 1, "{words}");
        for Found { quantity, method, share } in found {
            let share = share.unwrap_or_else(|reason| panic!("{words} {}: {reason}", quantity.name()));
            assert!(share <= 1.0, "{words} {} by {method}: {share} of its tolerance", quantity.name());
        }
    }
}

/// The counts of faer's symbolic analysis: nothing is filled leaves first, everything of each tree root first. Minimum degree fills nothing
/// either (`guide/studies/scaling.md`, "Fill-in"), and faer's approximation of it fills a little on some robots: 16 numbers on the hand.
pub fn fills_as_the_theory_says(faer: &Oracle) {
    let words = ["chain:n=36,layout=spatial", "star-30", "humanoid", "hand", "g1", "binary_tree:depth=8", "tree:n=100,seed=6,spread=0.3"];
    for words in words {
        let robot = native::robot(words, 1);
        let parents = robot.model.topology.dof_parents();
        let roots = (0..parents.len()).filter(|&dof| parents[dof].is_none()).chain([parents.len()]).collect::<Vec<_>>();
        let full: usize = roots.windows(2).map(|pair| (pair[1] - pair[0]) * (pair[1] - pair[0] + 1) / 2).sum();
        let (n, stored) = (parents.len(), robot.model.topology.stored());
        let entries = |method: &str| ask(faer, &robot, Quantity::FactorEntries, method).unwrap()[0];
        for (method, due) in [("sparse_leaves_first", stored), ("sparse_natural", full), ("dense", n * (n + 1) / 2)] {
            assert_eq!(entries(method), due as f64, "{words} by {method}");
        }
        let filled = entries("sparse_amd") - stored as f64;
        assert!((0.0..=(full - stored) as f64).contains(&filled), "{words}: {filled}");
        assert!(words != "hand" || filled == 16.0, "{filled}");
    }
}

/// A matrix that is too large when it is dense is refused, with its size. A singular one is an error that names the library.
pub fn refuses(engine: &Oracle) {
    let large = native::robot("star:n=3000", 1);
    let refused = ask(engine, &large, Quantity::Factorization, "dense");
    assert!(matches!(&refused, Err(NoAnswer::NotOffered(reason)) if reason.contains("3000 degrees of freedom")), "{refused:?}");
    let mut massless = native::robot("chain:n=2,layout=planar", 1).description;
    massless.bodies[1].mass = 0.0;
    massless.bodies[1].inertia = [0.0; 6];
    let massless = Robot::new(&massless, "massless", featherbench_results::ModelOrigin::Generated, 1, 1).unwrap();
    for method in engine.methods(Quantity::Factorization) {
        let failed = ask(engine, &massless, Quantity::Factorization, &method);
        assert!(matches!(&failed, Err(NoAnswer::Failed(reason)) if reason.contains("ositive")), "{method}: {failed:?}");
    }
}
