//! Lies that depend on the state, the body, the joint, the quantity or the method are convicted wherever they are.
//!
//! A lie is one wrong number: of one quantity by one method at one of twenty states. Its size is relative to what its error is divided by, and
//! 1e-13 is the smallest one: ten times the gate. A Jacobian is told by products where it is not the deepest body's. There a lie in one column
//! has its size times |x_j| s_j / Σ |x_k| s_k, and it is drawn so that twice the gate is left of it.

use crate::share::one_of;
use featherbench_bench::measure::{Magnitudes, scaled_error, worst};
use featherbench_bench::{Engine, Quantity, Robot};
use featherbench_doubles::{Answer, Double, beside_native, doubles, gates};
use featherbench_engines::Featherbench;
use featherbench_results::{ModelOrigin, Verdict};
use featherbench_robots::{Family, Random};
use std::collections::BTreeSet;

/// The states of most suites.
const STATES: usize = 20;
/// The gate of robots up to a depth of twenty (`ci/gates.toml`).
const GATE: f64 = 1e-14;

const QUANTITIES: [Quantity; 13] = [
    Quantity::InverseDynamics,
    Quantity::InverseDynamicsWrench,
    Quantity::Bias,
    Quantity::MassMatrix,
    Quantity::KineticEnergy,
    Quantity::PotentialEnergy,
    Quantity::CenterOfMass,
    Quantity::Momentum,
    Quantity::BodyPlacement,
    Quantity::BodyVelocity,
    Quantity::BodyAcceleration,
    Quantity::BodyJacobian,
    Quantity::BodyJacobians,
];

fn robot(random: &mut Random) -> Robot {
    const SPECS: [&str; 6] = [
        "joints:kind=mixed,base=free",
        "tree:n=9,joints=all,base=free,armature=true",
        "chain:n=10,layout=spatial",
        "quadruped",
        "tree:n=6,joints=all,base=fixed",
        "hand",
    ];
    let family = Family::parse(SPECS[random.below(SPECS.len())]).unwrap();
    Robot::new(&family.generate().unwrap(), family.name(), ModelOrigin::Generated, STATES, u64::from(random.bits32())).unwrap()
}

/// A lie about one number.
struct Lie {
    quantity: Quantity,
    method: String,
    state: usize,
    entry: usize,
    size: f64,
}

impl Lie {
    fn draw(robot: &Robot, quantity: Quantity, random: &mut Random) -> Self {
        let methods = Featherbench::new().methods(quantity);
        // The usual method of ours is the reference: the double's is another one's.
        let method = methods[random.below(methods.len())].clone();
        let size = 10.0_f64.powf(random.uniform(-13.0, -3.0));
        Self { quantity, method, state: random.below(STATES), entry: random.below(quantity.size(robot)), size }
    }

    /// Adds it to an answer.
    fn tell(&self, Answer { robot, quantity, method, state, values }: Answer) {
        if (quantity, method, state) != (self.quantity, &*self.method, self.state) {
            return;
        }
        let at = Magnitudes::new(robot, state);
        // The error of one is the inverse of the magnitude.
        let mut off = values.clone();
        off[self.entry] += 1.0;
        let magnitude = scaled_error(robot, quantity, &at, values, &off).recip();
        if quantity != Quantity::BodyJacobians {
            // Where nothing moves, nothing is divided by: any number but zero is wrong.
            values[self.entry] += self.size * if magnitude > 0.0 { magnitude } else { 1.0 };
            return;
        }
        // One column: in both products by its x. The lie is at least twice what the gate lets pass.
        let (nv, probe) = (robot.states.nv, robot.probe());
        let column = self.entry % nv;
        let rates = [probe[column], probe[nv + column]];
        let largest = rates.iter().map(|x| x.abs()).fold(0.0, worst);
        let size = (2.0 * GATE).max(self.size) * magnitude / largest;
        let (body, row) = (self.entry / 12, self.entry % 6);
        for (place, rate) in rates.iter().enumerate() {
            values[12 * body + 6 * place + row] += size * rate;
        }
    }
}

#[test]
fn a_lie_is_convicted_at_every_state_and_body() {
    let mut random = Random::named(44, "lies anywhere");
    let (mut told, mut states) = (0, BTreeSet::new());
    let judged = gates("");
    for round in 0..24 / one_of(8) {
        for quantity in QUANTITIES {
            let robot = robot(&mut random);
            let lie = Lie::draw(&robot, quantity, &mut random);
            let (state, entry, size, method) = (lie.state, lie.entry, lie.size, lie.method.clone());
            let records = beside_native(&robot, &judged, Double::twisting(&robot, move |answer| lie.tell(answer)));
            let about =
                format!("round {round}: {} of {} by {method} at state {state}, entry {entry}, {size:e}", quantity.name(), robot.name);
            let wrong = |verdict| doubles(&records, verdict).into_iter().map(|row| (row.quantity.clone(), row.method.clone()));
            let convicted: BTreeSet<_> = wrong(Verdict::Fail).chain(wrong(Verdict::Error)).collect();
            assert_eq!(convicted, BTreeSet::from([(quantity.name().to_owned(), method)]), "{about}");
            told += 1;
            states.insert(state);
        }
    }
    assert!(told >= 39 && states.iter().any(|state| *state > 6), "{told} lies at states {states:?}");
}

/// Answers under another quantity's name, of the same shape.
#[test]
fn swapped_names_are_convicted() {
    let mut random = Random::named(44, "swapped names");
    for (asked, answered) in [
        (Quantity::BodyVelocity, Quantity::BodyAcceleration),
        (Quantity::BodyAcceleration, Quantity::BodyVelocity),
        (Quantity::Bias, Quantity::InverseDynamics),
        (Quantity::InverseDynamics, Quantity::InverseDynamicsWrench),
        (Quantity::InverseDynamicsWrench, Quantity::Bias),
        (Quantity::KineticEnergy, Quantity::PotentialEnergy),
    ] {
        let robot = robot(&mut random);
        let twist = move |answer: Answer| {
            if answer.quantity == asked {
                let ours = Featherbench::new();
                let methods = ours.methods(answered);
                let mut other = ours.prepare(answer.robot, answered, &methods[0], &answer.robot.states).unwrap();
                other.run(answer.state..answer.state + 1).unwrap();
                answer.values.copy_from_slice(other.read());
            }
        };
        let records = beside_native(&robot, &gates(""), Double::twisting(&robot, twist));
        let convicted: BTreeSet<_> = doubles(&records, Verdict::Fail).into_iter().map(|row| row.quantity.as_str()).collect();
        assert_eq!(convicted, BTreeSet::from([asked.name()]), "{} for {}", answered.name(), asked.name());
    }
}
