//! What the tests share: robots, states, tolerances, and flow derivatives.

use featherbench_dynamics::TreeSparse;
use featherbench_model::{BodyDescription, Description, JointDescription, JointKind, JointType, Model, Placement, Topology, integrate};
use featherbench_robots::{Family, Random, StateBatch};
use featherbench_spatial::{Angle, Dual, Force, Lift, Motion, Quaternion, Real, Sym3, Vec3};
use nalgebra::DMatrix;

pub mod batched;
mod by_reciprocal;
pub mod dense;
pub mod fused;
#[path = "../../../robots/tests/share.rs"]
pub mod share;
mod tolerance;

pub use by_reciprocal::ByReciprocal;
pub use featherbench_spatial::larger;
pub use share::one_of;
pub use tolerance::assert_within as within;

/// The largest |a − b|, NaN if any difference is.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, larger)
}

/// The largest magnitude.
pub fn largest(a: &[f64]) -> f64 {
    distance(a, &vec![0.0; a.len()])
}

/// κ of a mass matrix scaled to a unit diagonal: the Rayleigh quotients of iterations with it and with its inverse. Neither is above its
/// eigenvalue, so a tolerance from κ is not too wide.
pub fn condition(matrix: &TreeSparse<f64>) -> f64 {
    let scale: Vec<f64> = matrix.diagonal().map(|d| 1.0 / d.sqrt()).collect();
    let factors = matrix.clone().into_ltdl().unwrap();
    let scaled = |x: &[f64], by: &dyn Fn(f64, f64) -> f64| x.iter().zip(&scale).map(|(x, s)| by(*x, *s)).collect::<Vec<f64>>();
    let eigenvalue = |apply: &dyn Fn(&[f64]) -> Vec<f64>| {
        let mut x: Vec<f64> = (0..matrix.size()).map(|k| 1.0 + (k as f64).sin()).collect();
        let mut before = 0.0;
        loop {
            let size = x.iter().map(|x| x * x).sum::<f64>().sqrt();
            x.iter_mut().for_each(|x| *x /= size);
            let y = apply(&x);
            let quotient = x.iter().zip(&y).map(|(x, y)| x * y).sum::<f64>();
            assert!(quotient.is_finite());
            if quotient - before <= 1e-4 * quotient {
                return quotient;
            }
            (before, x) = (quotient, y);
        }
    };
    let largest = eigenvalue(&|x| {
        let mut y = vec![0.0; x.len()];
        matrix.mul(&scaled(x, &|x, s| x * s), &mut y).unwrap();
        scaled(&y, &|y, s| y * s)
    });
    let inverse = eigenvalue(&|x| {
        let mut y = scaled(x, &|x, s| x / s);
        factors.solve(&mut y).unwrap();
        scaled(&y, &|y, s| y / s)
    });
    largest * inverse
}

/// How a random robot is made.
#[derive(Clone, Copy)]
pub struct Recipe {
    /// The kinds of joint, used in turn.
    pub kinds: &'static [Kind],
    pub bodies: usize,
    /// Whether a parent is drawn from the whole path to the last body, or is the last body.
    pub branched: bool,
    pub armature: bool,
}

/// A joint's kind, before its axis is drawn.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    Revolute,
    Prismatic,
    Helical,
    Spherical,
    Free,
    Planar,
    Universal,
    Translation,
    Cylindrical,
    EulerZyx,
}

use Kind::*;

/// Robots that have, between them: every kind of joint, chains and branches, fixed and floating bases, and a free joint in the middle.
pub const ROBOTS: [(&str, Recipe); 10] = [
    ("revolute chain", Recipe { kinds: &[Revolute], bodies: 8, branched: false, armature: false }),
    ("prismatic chain", Recipe { kinds: &[Prismatic, Revolute], bodies: 6, branched: false, armature: true }),
    ("helical chain", Recipe { kinds: &[Helical], bodies: 6, branched: false, armature: true }),
    ("spherical chain", Recipe { kinds: &[Spherical], bodies: 5, branched: false, armature: false }),
    ("spherical tree with armature", Recipe { kinds: &[Spherical, Revolute], bodies: 9, branched: true, armature: true }),
    ("composed joints", Recipe { kinds: &[Planar, Universal], bodies: 6, branched: true, armature: false }),
    (
        "every kind, fixed base",
        Recipe { kinds: &[Revolute, Prismatic, Helical, Spherical, Planar, Universal], bodies: 14, branched: true, armature: true },
    ),
    (
        "every kind, floating base",
        Recipe {
            kinds: &[Free, Revolute, Helical, Spherical, Prismatic, Universal, Planar, Revolute],
            bodies: 8,
            branched: true,
            armature: true,
        },
    ),
    ("free joints in the middle", Recipe { kinds: &[Revolute, Spherical, Free, Prismatic], bodies: 12, branched: true, armature: true }),
    ("more composed joints", Recipe { kinds: &[Translation, Cylindrical, EulerZyx], bodies: 9, branched: true, armature: true }),
];

/// The robot of a recipe, whose tree does not depend on the seed: skew axes and gravity, turned placements, products of inertia.
pub fn robot(recipe: &Recipe, seed: u64) -> Description {
    let mut random = Random::new(seed, recipe.bodies as u64);
    let mut description = Description { name: "random".into(), gravity: [1.3, -2.1, -9.4], ..Description::default() };
    let (mut tree, mut path) = (Random::new(1, recipe.bodies as u64), Vec::<usize>::new());
    for i in 0..recipe.bodies {
        if recipe.branched && i > 1 {
            path.truncate(1 + tree.below(path.len()));
        }
        let kind = recipe.kinds[i % recipe.kinds.len()];
        let axis = random.direction::<3>();
        let joint_type = match kind {
            Revolute => JointType::Revolute { axis },
            Prismatic => JointType::Prismatic { axis },
            Helical => JointType::Helical { axis, pitch: random.uniform(-0.5, 0.5) },
            Spherical => JointType::Spherical,
            Free => JointType::Free,
            Planar => JointType::Planar,
            Universal => JointType::Universal,
            Translation => JointType::Translation,
            Cylindrical => JointType::Cylindrical { axis },
            EulerZyx => JointType::EulerZyx,
        };
        let rotation = Quaternion::from_array(random.direction::<4>()).to_rotation().to_array();
        let vector = |random: &mut Random, reach: f64| std::array::from_fn(|_| random.uniform(-reach, reach));
        let translation = vector(&mut random, 0.5);
        let armature =
            if recipe.armature && kind != Free { (0..joint_type.nv()).map(|_| random.uniform(0.0, 0.3)).collect() } else { Vec::new() };
        description.bodies.push(BodyDescription {
            name: format!("body{i}"),
            parent: path.last().copied(),
            mass: random.uniform(0.5, 2.0),
            com: vector(&mut random, 0.3),
            inertia: inertia(&mut random),
            joint: JointDescription {
                name: format!("joint{i}"),
                kind: joint_type,
                placement: Placement { rotation, translation },
                armature,
                ..JointDescription::default()
            },
        });
        path.push(i);
    }
    description
}

/// A random inertia that some mass distribution has: `tr(Σ)·1 − Σ` with a positive definite second moment Σ.
fn inertia(random: &mut Random) -> [f64; 6] {
    let mut second = Sym3::scalar(0.02);
    for _ in 0..3 {
        second = second + Sym3::rank_one(random.uniform(0.01, 0.1), Vec3::from_array(random.direction::<3>()));
    }
    (Sym3::scalar(second.xx + second.yy + second.zz) - second).to_array()
}

/// The model of a recipe.
pub fn build(recipe: &Recipe) -> Model<f64> {
    Model::build(&robot(recipe, 11)).expect("the recipe is well formed")
}

/// A reference chain of dyadic numbers: one revolute or other screw joint after another along x, unit mass, half a metre each.
pub fn dyadic_chain(axes: &[[f64; 3]], bodies: usize) -> Model<f64> {
    let body = |i: usize| BodyDescription {
        name: format!("body{i}"),
        parent: i.checked_sub(1),
        mass: 1.0,
        com: [0.25, 0.0, 0.0],
        inertia: [0.0078125, 0.0, 0.0, 0.03125, 0.0, 0.03125],
        joint: JointDescription {
            kind: JointType::Revolute { axis: axes[i % axes.len()] },
            placement: Placement { translation: [if i == 0 { 0.0 } else { 0.5 }, 0.0, 0.0], ..Placement::default() },
            ..JointDescription::default()
        },
    };
    let description = Description { gravity: [0.0, 0.0, -9.8125], bodies: (0..bodies).map(body).collect(), ..Description::default() };
    Model::build(&description).expect("a chain is well formed")
}

/// A topology given by (parent body or −1, kind).
pub fn topology(tree: &[(i64, JointKind)]) -> Topology {
    let tree: Vec<_> = tree.iter().map(|&(parent, kind)| (usize::try_from(parent).ok(), kind)).collect();
    Topology::new(&tree).expect("depth-first")
}

/// A configuration that moves: q with the rate of change that v gives it.
pub fn flow<T: Angle>(model: &Model<f64>, q: &[T], v: &[T]) -> Vec<Dual<T>> {
    let still: Vec<_> = q.iter().map(|q| Dual::constant(*q)).collect();
    let rate: Vec<_> = v.iter().map(|v| Dual::new(T::zero(), *v)).collect();
    integrate(&model.topology, &still, &rate).expect("q and v are the model's")
}

/// Numbers with their rates of change.
pub fn with_rate(values: &[f64], rates: &[f64]) -> Vec<Dual<f64>> {
    values.iter().zip(rates).map(|(&value, &rate)| Dual::new(value, rate)).collect()
}

/// The rate of change of a vector.
pub fn rate(v: Vec3<Dual<f64>>) -> Vec3<f64> {
    Vec3::new(v.x.derivative, v.y.derivative, v.z.derivative)
}

/// Numbers in another scalar.
pub fn lifted<T: Real>(values: &[f64]) -> Vec<T>
where
    f64: Lift<T>,
{
    values.iter().map(|value| value.lift()).collect()
}

/// Random wrenches, one per compiled body.
pub fn wrenches(model: &Model<f64>, seed: u64) -> Vec<Force<f64>> {
    let mut random = Random::new(seed, 77);
    (0..model.topology.bodies()).map(|_| Force::from_array(std::array::from_fn(|_| random.uniform(-1.0, 1.0)))).collect()
}

/// The six numbers of the difference of two motions.
pub fn gap(a: Motion<f64>, b: Motion<f64>) -> f64 {
    distance(&a.to_array(), &b.to_array())
}

/// A unit vector.
pub fn unit<T: Real>(n: usize, k: usize) -> Vec<T> {
    (0..n).map(|i| if i == k { T::one() } else { T::zero() }).collect()
}

/// Numbers that do not move.
pub fn constant<T: Real>(values: &[T]) -> Vec<Dual<T>> {
    values.iter().map(|&value| Dual::constant(value)).collect()
}

/// The robot of a family.
pub fn describe(spec: &str) -> Description {
    Family::parse(spec).and_then(|family| family.generate()).unwrap_or_else(|bad| panic!("{spec}: {bad}"))
}

/// The model of a family's robot.
pub fn generated(spec: &str) -> Model<f64> {
    Model::build(&describe(spec)).expect("the robot is well formed")
}

/// The recipes' robots, and generated ones: every joint of the family `joints` on both bases, trees, chains, legs and hands.
pub fn robots() -> Vec<(String, Model<f64>)> {
    let recipes = ROBOTS.iter().map(|(name, recipe)| (name.to_string(), build(recipe)));
    recipes.chain(GENERATED.iter().map(|name| (name.to_string(), generated(name)))).collect()
}

const GENERATED: [&str; 12] = [
    "joints:kind=all,base=fixed",
    "joints:kind=all,base=free",
    "joints:kind=free,base=fixed",
    "joints:kind=euler_zyx,base=free",
    "humanoid",
    "quadruped",
    "hand",
    "chain:n=12,layout=spatial",
    "chain:n=36,layout=planar",
    "chain:n=36,layout=spatial",
    "tree:n=24",
    "star:n=6",
];

/// Each robot with one state of each case, by day with half of them in turn: q, v, a, τ and wrenches. The last ones are far from the world's
/// origin.
pub fn each_robot_and_state(mut check: impl FnMut(&str, &Model<f64>, [&[f64]; 4], &[Force<f64>])) {
    for (at, (name, model)) in robots().iter().enumerate() {
        let states = StateBatch::agreement(model, StateBatch::HEAD, 3);
        for k in (0..states.count()).skip(at % one_of(2)).step_by(one_of(2)) {
            let mut q = states.q(k).to_vec();
            let far = k + 1 == states.count() && model.topology.joints()[0].kind == JointKind::Free;
            if far {
                q[..3].copy_from_slice(&[1e6, -3e6, 2e6]);
            }
            let label = format!("{name}, state {k} ({}{})", states.cases[k].name(), if far { ", far" } else { "" });
            check(&label, model, [&q, states.v(k), states.a(k), states.tau(k)], &wrenches(model, k as u64));
        }
    }
}

/// The largest difference over the largest entry, each entry (i, j) over √(M_ii·M_jj): so units drop out.
pub fn over_inertias(matrix: &TreeSparse<f64>, truth: &DMatrix<f64>, found: &DMatrix<f64>) -> f64 {
    let root: Vec<f64> = matrix.diagonal().map(f64::sqrt).collect();
    let over = |entries: &DMatrix<f64>| {
        entries.iter().enumerate().map(|(k, x)| x.abs() / (root[k % root.len()] * root[k / root.len()])).fold(0.0, larger)
    };
    let scale = over(truth);
    let error = over(&(found - truth));
    if error == 0.0 { 0.0 } else { error / scale }
}
