//! §7 and §8: the residual's regressor, the zero residual's length, and its bits.

use crate::arm::Arm;
use crate::claim::{Claim, Failure, Holds, Number};
use featherbench_dynamics::inverse_dynamics;
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model};
use featherbench_robots::{Family, StateBatch};
use nalgebra::{DMatrix, DVector};

/// The regressor of the lab: the same row φᵀ for each joint.
fn tiled(phi: &[f64], joints: usize) -> DMatrix<f64> {
    DMatrix::from_fn(joints, phi.len(), |_, k| phi[k])
}

/// I ⊗ φᵀ: each joint has parameters of its own.
fn blocks(phi: &[f64], joints: usize) -> DMatrix<f64> {
    DMatrix::from_fn(joints, joints * phi.len(), |i, k| if k / phi.len() == i { phi[k % phi.len()] } else { 0.0 })
}

/// An orthonormal basis of the torques that a regressor reaches: eigenvectors of Φ Φᵀ, whose other eigenvalues are rounding.
fn range(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = (matrix * matrix.transpose()).symmetric_eigen();
    let limit = 1e-12 * eigen.eigenvalues.amax();
    let kept: Vec<_> = (0..matrix.nrows()).filter(|k| eigen.eigenvalues[*k] > limit).map(|k| eigen.eigenvectors.column(k)).collect();
    DMatrix::from_columns(&kept)
}

fn regressors(joints: usize, seed: u64) -> Result<Vec<Number>, Failure> {
    let mut random = featherbench_robots::Random::named(seed, "lesson: regressor");
    let mut state = |count: usize| -> Vec<f64> { (0..count).map(|_| random.uniform(-1.0, 1.0)).collect() };
    let motion = state(3 * joints);
    // The lab's φ has n ones, for n joints.
    let long: Vec<f64> = motion.iter().copied().chain(vec![1.0; joints]).collect();
    let phi: Vec<f64> = motion.iter().copied().chain([1.0]).collect();
    let (theirs, ours) = (tiled(&long, joints), blocks(&phi, joints));
    let rank = |matrix: &DMatrix<f64>| range(matrix).ncols();
    // Torques that one θ of the right form gives, and the best that the lab's form makes of them: their mean for each joint.
    let theta = DVector::from_vec(state(ours.ncols()));
    let wanted = &ours * theta;
    let mean = wanted.mean();
    let missed: f64 = wanted.iter().map(|r| (r - mean) * (r - mean)).sum::<f64>().sqrt() / wanted.norm();
    let basis = range(&theirs);
    let left = (&wanted - &basis * (basis.transpose() * &wanted)).norm() / wanted.norm();
    let named = |what: &str| format!("{what}, {joints} joints");
    let off = 3.0 * joints as f64 + 1.0 - (4 * joints) as f64;
    Ok(vec![
        Number::count(named("parameters of one row"), theirs.ncols(), 4 * joints).stated((3 * joints + 1) as f64, off),
        Number::count(named("rank of the regressor"), rank(&ours), joints).stated(rank(&theirs) as f64, 1.0 - joints as f64),
        Number::count(named("parameters"), ours.ncols(), joints * (3 * joints + 1)),
        Number::new(named("what the lab's rows leave of a residual"), "1", left, missed),
    ])
}

/// `LinearResidual`.
pub(super) const REGRESSOR: Claim = Claim {
    id: "linear_residual",
    place: "§7",
    title: "The linear residual",
    says: "Φθ with the row (q, q̇, q̈, 1) for each joint, and 3n + 1 parameters.",
    right: "Its row has 4n numbers: the lab's own call fails. With 4n all joints get the same torque. Right is I ⊗ (q, q̇, q̈, 1)ᵀ, n(3n + 1) numbers.",
    holds: Holds::No,
    numbers: |seed| Ok([regressors(2, seed)?, regressors(6, seed)?].concat()),
};

/// `zeros_like(q)`.
pub(super) const ZEROS: Claim = Claim {
    id: "zeros_like",
    place: "§7",
    title: "The length of no residual",
    says: "Without a residual the torques are less zeros as long as q.",
    right: "Torques are as long as q̇: a free base has 7 coordinates and 6 velocities. The lab's subtraction then fails.",
    holds: Holds::InPart,
    numbers: |_| {
        let body = |kind: JointType| BodyDescription {
            name: "body".into(),
            parent: None,
            mass: 1.0,
            com: [0.0; 3],
            inertia: [1.0, 0.0, 0.0, 1.0, 0.0, 1.0],
            joint: JointDescription { kind, ..JointDescription::default() },
        };
        let mut numbers = Vec::new();
        for (name, kind, due) in [("a hinge", JointType::Revolute { axis: [0.0, 1.0, 0.0] }, 1), ("a free base", JointType::Free, 6)] {
            let model = Model::<f64>::build(&Description { bodies: vec![body(kind)], ..Description::default() })?;
            let (nq, nv) = (model.topology.nq(), model.topology.nv());
            let mut q = vec![0.0; nq];
            if let [.., w] = &mut q[..] {
                *w = if nq == 7 { 1.0 } else { 0.0 };
            }
            let torques = inverse_dynamics(&model, &q, &vec![0.0; nv], &vec![0.0; nv])?.len();
            numbers.push(Number::count(format!("torques of {name}"), torques, due).stated(nq as f64, nq as f64 - nv as f64));
        }
        Ok(numbers)
    },
};

/// How many of the numbers have other bits.
fn changed(before: &[f64], after: impl Fn(f64) -> f64) -> usize {
    before.iter().filter(|&&x| after(x).to_bits() != x.to_bits()).count()
}

/// The plug-in's zero residual.
pub(super) const BITS: Claim = Claim {
    id: "zero_residual_bits",
    place: "§8",
    title: "A residual of zero changes nothing",
    says: "τ_nominal − 0 is τ_nominal.",
    right: "To the bit it is. With the sign corrected it is not for −0: −0 + 0 = +0. So a wrapper must add nothing where there is no residual.",
    holds: Holds::Yes,
    numbers: |_| {
        let model: Model<f64> =
            Model::build(&Family::parse("chain:n=12,layout=spatial").map_err(Failure::of)?.generate().map_err(Failure::of)?)?;
        let states = StateBatch::random(&model, 20, 7);
        let mut torques = Vec::new();
        for k in 0..states.count() {
            torques.extend(inverse_dynamics(&model, states.q(k), states.v(k), states.a(k))?);
        }
        // An arm at rest without gravity.
        let still = Arm { gravity: 0.0, v: [0.0; 2], ..Arm::default() };
        let model = still.body()?;
        torques.extend(inverse_dynamics(&model, &still.q, &still.v, &[0.0; 2])?);
        let (none, zero) = (0, 0.0);
        Ok(vec![
            Number::count("torques whose bits τ − 0 changes", changed(&torques, |x| x - zero), none).stated(0.0, 0.0),
            Number::count("bits of −0 that −0 − 0 changes", changed(&[-0.0], |x| x - zero), none).stated(0.0, 0.0),
            Number::count("bits of −0 that −0 + 0 changes", changed(&[-0.0], |x| x + zero), 1),
        ])
    },
};
