//! φ, J and J̇v of every law agree: by dual numbers, which differentiate the residual itself.

use crate::common::{EVERY_JOINT, assert_within, every_law, model, slack};
use featherbench_constrained::{Constraint, Constraints, Law, LoopMotion, Rows};
use featherbench_model::integrate;
use featherbench_robots::StateBatch;
use featherbench_spatial::{Dual, largest};

/// Sums of some hundred products of numbers up to ten, each rounded: 100·10²·ε, and a hundred times that for powers of coordinates.
const ROUNDING: f64 = 1e-11;

/// φ̇ = J v and d(J v)/dt = J̇v along q ⊕ ε v, for every law on every joint. The duals differentiate φ through another formula than J's:
/// that of placements alone.
#[test]
fn residual_jacobian_and_bias_agree_on_every_joint() {
    let mut draws = 0;
    for spec in EVERY_JOINT {
        let model = model(spec);
        let states = StateBatch::random(&model, 20, 3);
        for k in 0..states.count() {
            let constraints = every_law(&model, k as u64);
            let mut rows = Rows::new(&constraints);
            let (q, v) = (states.q(k), states.v(k));
            rows.run(&model, &constraints, q, v).unwrap();
            let constant = |x: &[f64]| x.iter().map(|x| Dual::constant(*x)).collect::<Vec<_>>();
            let step: Vec<_> = v.iter().map(|v| Dual::new(0.0, *v)).collect();
            let moving = integrate(&model.topology, &constant(q), &step).unwrap();
            let mut moved = Rows::<Dual<f64>>::new(&constraints);
            moved.run(&model, &constraints, &moving, &constant(v)).unwrap();
            let mut rate = vec![0.0; constraints.rows()];
            rows.multiply(v, &mut rate).unwrap();
            let mut rate_of_rate = vec![Dual::constant(0.0); constraints.rows()];
            moved.multiply(&constant(v), &mut rate_of_rate).unwrap();
            for (row, (residual, bias)) in moved.residuals().zip(rows.biases()).enumerate() {
                let what = format!("{spec} {k} {} row {row}", constraints.name_of_row(row));
                let scale = (1.0 + rate[row].abs() + bias.abs()) * slack(&constraints, &rows);
                assert_within(&format!("J v, {what}"), (rate[row] - residual.derivative).abs() / scale, ROUNDING);
                assert_within(&format!("bias, {what}"), (bias - rate_of_rate[row].derivative).abs() / scale, ROUNDING);
                draws += 1;
            }
        }
    }
    assert!(draws > 800, "{draws}");
}

/// A loop joint leaves free what it says: frames that differ by its motion have no residual, and no other motion is free.
#[test]
fn loop_joints_leave_their_motion_free() {
    use featherbench_constrained::Attachment;
    use featherbench_model::{JointKind, Model, Topology};
    let model: Model<f64> = {
        let description = featherbench_robots::Family::parse("joints:kind=free,base=fixed,shape=single").unwrap().generate().unwrap();
        Model::build(&description).unwrap()
    };
    assert_eq!(model.topology, Topology::new(&[(None, JointKind::Free)]).unwrap());
    // Motion [linear; angular] along the frame's axes.
    let cases: [(LoopMotion, &[usize]); 6] = [
        (LoopMotion::Fixed, &[]),
        (LoopMotion::Revolute, &[5]),
        (LoopMotion::Prismatic, &[2]),
        (LoopMotion::Cylindrical, &[2, 5]),
        (LoopMotion::Spherical, &[3, 4, 5]),
        (LoopMotion::Planar, &[0, 1, 5]),
    ];
    let body = Attachment::point(0, [0.0; 3]);
    let home = featherbench_model::neutral::<f64>(&model.topology);
    // Where the body is at home, so that the residual is zero there.
    let place = model.joint_transform(0, &home);
    let world = Attachment { body: None, placement: place };
    for (motion, free) in cases {
        assert_eq!(motion.freedom(), free.len());
        let law = Law::Joint { first: world, second: body, motion };
        let constraints = Constraints::new(&model.topology, vec![Constraint { name: "joint".into(), law }]).unwrap();
        let mut rows = Rows::new(&constraints);
        for dof in 0..6 {
            let mut step = [0.0; 6];
            // Far from home: half a turn and more is no matter for a hinge.
            step[dof] = 2.0;
            rows.run(&model, &constraints, &integrate(&model.topology, &home, &step).unwrap(), &[0.0; 6]).unwrap();
            let largest = largest(rows.residuals());
            if free.contains(&dof) {
                assert_within(motion.name(), largest, 4.0 * f64::EPSILON);
            } else {
                assert!(largest > 0.9, "{motion:?} dof {dof}: {largest}");
            }
        }
    }
}
