//! A fault that is planted in an engine is reduced to the bodies that it takes.

use featherbench_bench::{Engine, Evaluation, Identity, NoAnswer, Quantity, Robot};
use featherbench_engines::Featherbench;
use featherbench_model::{Description, JointType};
use featherbench_reduction::{KEEP, Subject, reduce, severity};
use featherbench_results::ModelOrigin;
use featherbench_robots::{Family, StateBatch};
use std::ops::Range;

/// Our kernels on an altered robot: an engine whose way to build a robot has a fault.
pub struct Faulty {
    pub inner: Featherbench,
    pub alter: fn(&mut Description),
    /// Whether it answers NaN where the robot is altered.
    pub lost: bool,
}

struct Answer(Vec<f64>);

impl Evaluation for Answer {
    fn run(&mut self, _: Range<usize>) -> Result<(), NoAnswer> {
        Ok(())
    }

    fn read(&self) -> &[f64] {
        &self.0
    }
}

impl Engine for Faulty {
    fn identity(&self) -> &Identity {
        self.inner.identity()
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        self.inner.methods(quantity)
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        let mut description = robot.description.clone();
        (self.alter)(&mut description);
        let altered = Robot::new(&description, "altered", ModelOrigin::Generated, 1, 1).unwrap();
        let mut prepared = self.inner.prepare(&altered, quantity, method, states)?;
        prepared.run(0..states.count())?;
        let mut answer = prepared.read().to_vec();
        if self.lost && description != robot.description {
            answer.fill(f64::NAN);
        }
        Ok(Box::new(Answer(answer)))
    }
}

/// The body on a slide that a hinge carries is a millionth too heavy.
fn slide_on_a_hinge(description: &mut Description) {
    let hinged = |description: &Description, at: usize| matches!(description.bodies[at].joint.kind, JointType::Revolute { .. });
    for at in 0..description.bodies.len() {
        let carried = description.bodies[at].parent.is_some_and(|parent| hinged(description, parent));
        if carried && matches!(description.bodies[at].joint.kind, JointType::Prismatic { .. }) {
            description.bodies[at].mass *= 1.0 + 1e-6;
        }
    }
}

/// A ball is a millionth too heavy.
pub fn balls(description: &mut Description) {
    for body in description.bodies.iter_mut().filter(|body| body.joint.kind == JointType::Spherical) {
        body.mass *= 1.0 + 1e-6;
    }
}

pub fn robot(spec: &str) -> Robot {
    let description = Family::parse(spec).unwrap().generate().unwrap();
    Robot::new(&description, "tree", ModelOrigin::Generated, 1, 1).unwrap()
}

/// The first trees of a base that have the fault.
fn faulty(alter: fn(&mut Description), base: &str) -> Vec<Robot> {
    let trees = (1..100).map(|seed| robot(&format!("tree:n=16,joints=common,seed={seed},base={base}")));
    let has = |robot: &Robot| {
        let mut description = robot.description.clone();
        alter(&mut description);
        description != robot.description
    };
    trees.filter(has).take(2).collect()
}

#[test]
fn a_planted_fault_is_reduced_to_its_bodies() {
    let mut cases = 0;
    for (alter, bodies) in [(slide_on_a_hinge as fn(&mut Description), 2), (balls, 1)] {
        let engine = Faulty { inner: Featherbench::new(), alter, lost: false };
        for robot in [faulty(alter, "fixed"), faulty(alter, "free")].concat() {
            for (quantity, method) in
                [(Quantity::InverseDynamics, "rnea_packed"), (Quantity::MassMatrix, "crba"), (Quantity::ForwardDynamics, "aba")]
            {
                let what = format!("{} {method}", robot.name);
                let given = severity(&engine, &robot, quantity, method).unwrap();
                let reduced = reduce(Subject::of(&robot, 0), 1e-10, &|robot| severity(&engine, robot, quantity, method)).unwrap();
                assert_eq!(reduced.before, given, "{what}");
                assert!(reduced.case.description.bodies.len() <= bodies, "{what}: {:?}", reduced.case);
                // What is told of the reduced case is what the case itself shows, and it is the fault that shows it.
                let small = reduced.case.robot().unwrap();
                let again = severity(&engine, &small, quantity, method).unwrap();
                assert!(again == reduced.after && again >= KEEP * given, "{what}: {given} became {again}");
                assert!(severity(&Featherbench::new(), &small, quantity, method).unwrap() < 1e-3 * again, "{what}");
                cases += 1;
            }
        }
    }
    assert_eq!(cases, 24);
}

#[test]
fn a_case_is_the_robot_at_its_state() {
    let robot = robot("tree:n=9,joints=all,seed=5,base=free");
    let again = Subject::of(&robot, 0).robot().unwrap();
    let of = |robot: &Robot| [robot.states.q(0), robot.states.v(0), robot.states.a(0), robot.states.tau(0)].concat();
    assert_eq!((of(&again), &again.description.bodies), (of(&robot), &robot.description.bodies));
}
