//! Velocities in other coordinates than ours.

use featherbench_model::{BodyDescription, Description, JointType};

/// One state of a robot as it is sent, and featherbench's results for the bodies in it.
#[derive(Clone, Default)]
pub(super) struct State {
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) a: Vec<f64>,
    pub(super) tau: Vec<f64>,
    pub(super) wrench: Vec<f64>,
    /// featherbench's [`featherbench_bench::Quantity::BodyPlacement`].
    pub(super) placement: Vec<f64>,
    /// featherbench's [`featherbench_bench::Quantity::BodyVelocity`].
    pub(super) velocity: Vec<f64>,
    /// featherbench's [`featherbench_bench::Quantity::CenterOfMass`].
    pub(super) com: Vec<f64>,
    /// featherbench's [`featherbench_bench::Quantity::Momentum`].
    pub(super) momentum: Vec<f64>,
}

/// v_e = T v and a_e = T a + b, with an orthogonal T, instead of v and a.
pub(super) struct CoordinateChange {
    /// The rows of T: columns, in order, with their entries. All other entries are zero.
    t: Vec<Vec<(usize, f64)>>,
    /// b.
    pub(super) b: Vec<f64>,
}

/// Where each joint's numbers begin: (q, v, body).
pub(super) fn places(robot: &Description) -> Vec<(usize, usize, &BodyDescription)> {
    let (mut q, mut v) = (0, 0);
    let mut places = Vec::with_capacity(robot.bodies.len());
    for body in &robot.bodies {
        places.push((q, v, body));
        q += body.joint.kind.nq();
        v += body.joint.kind.nv();
    }
    places
}

pub(super) const ONE: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
pub(super) type Six = [[f64; 6]; 6];
pub(super) const SWAP: Six = [
    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
];

/// Rotations of a free joint's body.
pub(super) struct Rotations {
    /// Body axes to joint-frame axes.
    pub(super) joint: [f64; 9],
    /// Body axes to world axes, of a body whose parent is the world.
    pub(super) world: [f64; 9],
}

/// T of every free joint; where `carried`, b = T [ω × v; 0] (in T's order), with v and ω in body axes.
pub(super) fn of_free(robot: &Description, state: &State, block: impl Fn(&Rotations) -> (Six, bool)) -> CoordinateChange {
    let mut change = CoordinateChange::identity(state.v.len());
    for (q, at, body) in places(robot) {
        if body.joint.kind == JointType::Free {
            let joint = rotation(&state.q[q + 3..q + 7]);
            let rotations = Rotations { joint, world: product_of_rotations(&body.joint.placement.rotation, &joint) };
            let (t, carried) = block(&rotations);
            let given = &state.v[at..at + 6];
            let neutral: Vec<f64> = (0..6).map(|j| (0..6).map(|i| t[i][j] * given[i]).sum()).collect();
            let omega_v = cross(&neutral[3..], &neutral[..3]);
            for (i, row) in t.iter().enumerate() {
                row.iter().enumerate().for_each(|(j, &entry)| *change.entry(at + i, at + j) = entry);
                change.b[at + i] = if carried { row.iter().zip(omega_v).map(|(entry, x)| entry * x).sum() } else { 0.0 };
            }
        }
    }
    change
}

pub(super) fn of_spherical(robot: &Description, state: &State) -> CoordinateChange {
    let mut change = CoordinateChange::identity(state.v.len());
    for (q, at, _) in places(robot).into_iter().filter(|(.., body)| body.joint.kind == JointType::Spherical) {
        let r = rotation(&state.q[q..q + 4]);
        (0..9).for_each(|k| *change.entry(at + k / 3, at + k % 3) = r[k]);
    }
    change
}

pub(super) fn of_planar(robot: &Description, state: &State) -> CoordinateChange {
    let mut change = CoordinateChange::identity(state.v.len());
    for (q, at, _) in places(robot).into_iter().filter(|(.., body)| body.joint.kind == JointType::Planar) {
        let (sin, cos) = state.q[q + 2].sin_cos();
        (*change.entry(at, at), *change.entry(at, at + 1)) = (cos, sin);
        (*change.entry(at + 1, at), *change.entry(at + 1, at + 1)) = (-sin, cos);
        let [x, y, rate] = [state.v[at], state.v[at + 1], state.v[at + 2]];
        (change.b[at], change.b[at + 1]) = (rate * y, -rate * x);
    }
    change
}

/// v_e has our numbers in another order. T is the permutation by `ours`, the place in our order of each number of v_e.
pub(super) fn of_order(ours: &[usize]) -> CoordinateChange {
    let n = ours.len();
    CoordinateChange { t: ours.iter().map(|&column| vec![(column, 1.0)]).collect(), b: vec![0.0; n] }
}

/// Puts numbers of another order into ours.
pub(super) fn put_back(ours: &[usize], numbers: &mut [f64]) {
    let given = numbers.to_vec();
    ours.iter().zip(given).for_each(|(&place, number)| numbers[place] = number);
}

impl CoordinateChange {
    fn identity(n: usize) -> Self {
        Self { t: (0..n).map(|row| vec![(row, 1.0)]).collect(), b: vec![0.0; n] }
    }

    fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        let row = &mut self.t[row];
        let at = row.binary_search_by_key(&column, |&(column, _)| column).unwrap_or_else(|at| {
            row.insert(at, (column, 0.0));
            at
        });
        &mut row[at].1
    }

    /// T x.
    pub(super) fn forth(&self, x: &[f64]) -> Vec<f64> {
        self.t.iter().map(|row| row.iter().map(|&(column, t)| t * x[column]).sum()).collect()
    }

    /// T' x.
    pub(super) fn back(&self, x: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; x.len()];
        for (row, x) in self.t.iter().zip(x) {
            row.iter().for_each(|&(column, t)| sums[column] += t * x);
        }
        sums
    }
}

pub(super) fn blocks(linear: &[f64; 9], angular: &[f64; 9]) -> Six {
    let mut t = [[0.0; 6]; 6];
    for k in 0..9 {
        t[k / 3][k % 3] = linear[k];
        t[3 + k / 3][3 + k % 3] = angular[k];
    }
    t
}

pub(super) fn product(a: &Six, b: &Six) -> Six {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|k| a[i][k] * b[k][j]).sum()))
}

fn product_of_rotations(a: &[f64; 9], b: &[f64; 9]) -> [f64; 9] {
    std::array::from_fn(|at| (0..3).map(|k| a[3 * (at / 3) + k] * b[3 * k + at % 3]).sum())
}

pub(super) fn transposed(r: &[f64; 9]) -> [f64; 9] {
    std::array::from_fn(|at| r[3 * (at % 3) + at / 3])
}

/// R of the unit quaternion (x, y, z, w), row-major.
fn rotation(quaternion: &[f64]) -> [f64; 9] {
    let change = featherbench_spatial::Quaternion::from_array([quaternion[0], quaternion[1], quaternion[2], quaternion[3]]).to_rotation();
    change.to_array()
}

/// R' x in place, R being the first nine numbers, row-major.
pub(super) fn rotated_back(r: &[f64], x: &mut [f64]) {
    let rotated: [f64; 3] = std::array::from_fn(|column| (0..3).map(|row| r[3 * row + column] * x[row]).sum());
    x.copy_from_slice(&rotated);
}

pub(super) fn cross(a: &[f64], b: &[f64]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
