//! Temporary.
use featherbench_dynamics::*;
use featherbench_model::Model;
use featherbench_robots::{Family, StateBatch};
use std::hint::black_box;
use std::time::Instant;

fn best<'a>(pairs: &mut [(&str, Box<dyn FnMut(usize) + 'a>, Box<dyn FnMut(usize) + 'a>)], joints: usize) {
    const N: usize = 256;
    for (name, old, new) in pairs {
        let mut least = [f64::INFINITY; 2];
        for _ in 0..40 {
            for (which, f) in [old.as_mut(), new.as_mut()].into_iter().enumerate() {
                let t = Instant::now();
                for k in 0..N {
                    f(k);
                }
                let e = t.elapsed().as_nanos() as f64 / N as f64;
                if e < least[which] {
                    least[which] = e;
                }
            }
        }
        println!(
            "  {name:14} {:8.1} {:8.1} ns  {:5.2}x   {:.1} ns/joint",
            least[0],
            least[1],
            least[0] / least[1],
            least[1] / joints as f64
        );
    }
}

fn main() {
    if std::env::args().nth(1).is_some() {
        let description = Family::parse("humanoid").unwrap().generate().unwrap();
        let model: Model<f64> = Model::build(&description).unwrap();
        let p = PackedModel::new(&model);
        let s = StateBatch::random(&model, 256, 3);
        let mut j = PackedJacobian::new(&p);
        for i in 0..20_000_000 {
            black_box(j.run(&p, s.q(i % 256), model.topology.bodies() - 1).unwrap());
        }
        return;
    }
    for spec in ["chain:n=36,layout=spatial", "humanoid", "chain:n=7,layout=spatial"] {
        let description = Family::parse(spec).unwrap().generate().unwrap();
        let model: Model<f64> = Model::build(&description).unwrap();
        let p = PackedModel::new(&model);
        let s = StateBatch::random(&model, 256, 3);
        let t = &model.topology;
        println!("{spec}: {} bodies, {} dofs", t.bodies(), t.nv());
        let last = t.bodies() - 1;
        let (mut k0, mut k1, mut k2, mut k3) =
            (Kinematics::new(t), PackedKinematics::new(&p), PackedKinematics::new(&p), PackedKinematics::new(&p));
        let mut k4 = Kinematics::new(t);
        let mut k5 = Kinematics::new(t);
        let (mut c0, mut c1) = (CenterOfMass::new(t), PackedCenterOfMass::new(&p));
        let (mut m0, mut m1) = (Momentum::new(t), PackedMomentum::new(&p));
        let (mut e0, mut e1) = (Energy::new(t), PackedEnergy::new(&p));
        let (mut j0, mut j1) = (Jacobian::new(t), PackedJacobian::new(&p));
        let (mut r0, mut r1) = (Rnea::new(t), PackedRnea::new(&p));
        let (mut tau0, mut tau1) = (vec![0.0; t.nv()], vec![0.0; t.nv()]);
        best(
            &mut [
                (
                    "kinematics",
                    Box::new(|k| k0.run(&model, s.q(k), s.v(k), s.a(k)).unwrap()),
                    Box::new(|k| k1.run(&p, s.q(k), s.v(k), s.a(k)).unwrap()),
                ),
                (
                    "velocities",
                    Box::new(|k| k4.run(&model, s.q(k), s.v(k), s.a(k)).unwrap()),
                    Box::new(|k| k2.set_moving(&p, s.q(k), s.v(k)).unwrap()),
                ),
                ("placements", Box::new(|k| k5.run(&model, s.q(k), s.v(k), s.a(k)).unwrap()), Box::new(|k| k3.place(&p, s.q(k)).unwrap())),
                (
                    "center",
                    Box::new(|k| {
                        black_box(c0.run(&model, s.q(k)).unwrap());
                    }),
                    Box::new(|k| {
                        black_box(c1.run(&p, s.q(k)).unwrap());
                    }),
                ),
                (
                    "momentum",
                    Box::new(|k| {
                        black_box(m0.run(&model, s.q(k), s.v(k)).unwrap());
                    }),
                    Box::new(|k| {
                        black_box(m1.run(&p, s.q(k), s.v(k)).unwrap());
                    }),
                ),
                (
                    "energy",
                    Box::new(|k| {
                        black_box(e0.run(&model, s.q(k), s.v(k)).unwrap());
                    }),
                    Box::new(|k| {
                        black_box(e1.run(&p, s.q(k), s.v(k)).unwrap());
                    }),
                ),
                (
                    "jacobian",
                    Box::new(|k| {
                        black_box(j0.run(&model, s.q(k), last).unwrap());
                    }),
                    Box::new(|k| {
                        black_box(j1.run(&p, s.q(k), last).unwrap());
                    }),
                ),
                (
                    "rnea",
                    Box::new(|k| r0.run(&model, s.q(k), s.v(k), s.a(k), None, &mut tau0).unwrap()),
                    Box::new(|k| r1.run(&p, s.q(k), s.v(k), s.a(k), None, &mut tau1).unwrap()),
                ),
            ],
            t.bodies(),
        );
    }
}
