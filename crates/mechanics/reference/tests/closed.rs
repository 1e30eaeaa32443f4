//! Closed forms against published values, against their own equations of motion, and against the multi-precision dynamics.

use crate::support;

use featherbench_model::JointType;
use featherbench_reference::closed::{DoublePendulum, Elliptic, FreeTop, HeavyTop, Pendulum};
use featherbench_reference::{Error, Mp, Precision, Robot};
use support::{body, close, distance, under_gravity};

const P: Precision = Precision::STANDARD;

fn number(x: f64) -> Mp {
    P.number(x).unwrap()
}

fn parse(text: &str) -> Mp {
    P.parse(text).unwrap()
}

/// dx/dt by a central difference whose own error is below 1e-55.
fn rate(f: impl Fn(&Mp) -> Vec<Mp>, t: &Mp) -> Vec<Mp> {
    let step = parse("1e-30");
    let (after, before) = (f(&(t + &step)), f(&(t - &step)));
    after.iter().zip(&before).map(|(after, before)| (after - before) / step.twice()).collect()
}

/// The largest difference of two lists.
fn gap(x: &[Mp], y: &[Mp]) -> Mp {
    x.iter().zip(y).fold(Mp::zero(), |gap, (x, y)| gap.max((x - y).abs()))
}

/// Known values, the addition theorem and the derivative test sn, cn and dn; Legendre's relation would not.
#[test]
fn elliptic_functions() {
    // K(k = sin 45°) = Γ(1/4)²/(4√π), lemniscate.
    let half = Elliptic::new(&number(0.5)).unwrap();
    let lemniscate = parse("1.854074677301371918433850347195260046217598823521766905585928045056021776838119978357271861650371897");
    close("K(1/2)", &distance(&[half.quarter_period()], &[lemniscate]), 1e-98);
    for m in [0.0, 1e-20, 0.1, 0.5, 0.9, 1.0 - 1e-12] {
        let functions = Elliptic::new(&number(m)).unwrap();
        for u in [0.0, 0.3, -1.7, 25.0] {
            let u = number(u);
            let (sn, cn, dn) = functions.functions(&u);
            let derivative = rate(|u| vec![functions.functions(u).0, functions.amplitude(u)], &u);
            close(&format!("sn' = cn dn, m = {m}"), &distance(&derivative, &[&cn * &dn, dn.clone()]), 1e-55);
            // sn(u + K) = cn/dn
            let (shifted, _, _) = functions.functions(&(&u + functions.quarter_period()));
            close(&format!("sn(u + K), m = {m}"), &(shifted - cn / dn).abs(), 1e-105);
            let (sin, _) = functions.amplitude(&u).sin_cos();
            assert_eq!(sin, sn);
        }
    }
    for m in [1.0, 1.5, -0.1] {
        assert!(matches!(Elliptic::new(&number(m)), Err(Error::Domain { .. })), "{m}");
    }
}

#[test]
fn pendulum() {
    // Natural frequency √(m g l / J) = √(2·8·0.5/0.5) = 4 of a 2 kg point 0.5 m below its axis.
    let bob = body(None, 2.0, [0.0, 0.0, -0.5], [0.0; 6], JointType::Revolute { axis: [0.0, 1.0, 0.0] }, [0.0; 3]);
    let robot = Robot::new(&under_gravity(8.0, vec![bob]), P).unwrap();
    let natural = number(4.0);
    for bottom in [0.01, 3.0, 7.99, 8.01, 30.0] {
        let motion = Pendulum::passing(&natural, &number(bottom)).unwrap();
        for t in [0.0, 0.4, 1.9] {
            let t = number(t);
            let (angle, speed) = motion.at(&t);
            let derivative = rate(|t| [motion.at(t).0, motion.at(t).1].to_vec(), &t);
            let right = [speed.clone(), motion.acceleration(&angle)];
            // sin(θ/2) = k sn loses digits at the turning points.
            close(&format!("equation of motion, {bottom} rad/s at the bottom"), &distance(&derivative, &right), 1e-50);
            let energy = &speed * &speed - (&natural * &natural * angle.sin_cos().1).twice();
            close("energy", &(energy - (number(bottom) * number(bottom) - number(32.0))).abs(), 1e-125);
            let expected = motion.acceleration(&angle);
            let fall = robot.at(&[angle], &[speed]).unwrap().forward_dynamics(&[Mp::zero()]).unwrap();
            close("forward dynamics", &(&fall[0] - expected).abs(), 1e-125);
        }
        let (period, t) = (motion.period(), number(0.3));
        let ((before, _), (after, _)) = (motion.at(&t), motion.at(&(&t + &period)));
        let turned = if bottom > 8.0 { P.pi().twice() } else { Mp::zero() };
        close("period", &(after - before - turned).abs(), 1e-115);
    }
    // Released horizontally: 4 K(sin 45°)/ω₀.
    let horizontal = Pendulum::swinging(&natural, &P.pi().half()).unwrap();
    close("horizontal", &distance(&[horizontal.period()], &[Elliptic::new(&number(0.5)).unwrap().quarter_period()]), 1e-120);
    assert!(Pendulum::passing(&natural, &number(8.0)).is_err(), "comes to rest upright");
    assert!(Pendulum::passing(&natural, &number(-1.0)).is_err());
}

/// The 2R arm: accelerations with uniform rods and with masses at the tips, and the same from the bodies. For the tips −20.6120091041 is
/// often quoted, which is wrong.
#[test]
fn double_pendulum() {
    let parameters = || ([2.0, 1.0].map(number), [1.0, 0.5].map(number), parse("9.81"));
    let (q, v, tau) = ([parse("0.3"), parse("-0.5")], [parse("0.7"), parse("0.4")], [number(1.0), number(-0.5)]);
    let (mass, length, gravity) = parameters();
    let rods = DoublePendulum::uniform(mass, length, gravity);
    let (mass, length, gravity) = parameters();
    let tips = DoublePendulum::tips(mass, length, gravity);
    for (name, arm, expected) in [("rods", &rods, ["8.8127960477", "-43.1567473102"]), ("tips", &tips, ["5.5110867986", "-20.6120093841"])]
    {
        let acceleration = arm.acceleration(&q, &v, &tau);
        close(name, &distance(&acceleration, &expected.map(parse)), 2.5e-12);
    }
    let turn = JointType::Revolute { axis: [0.0, 1.0, 0.0] };
    let one = body(None, 2.0, [0.0, 0.0, 0.375], [0.0, 0.0, 0.0, 0.125, 0.0, 0.0], turn, [0.0; 3]);
    let two = body(Some(0), 1.0, [0.0, 0.0, 0.25], [0.0, 0.0, 0.0, 0.0625, 0.0, 0.0], turn, [0.0, 0.0, 1.0]);
    let robot = Robot::new(&under_gravity(9.8125, vec![one, two]), P).unwrap();
    let arm = DoublePendulum {
        mass: [2.0, 1.0].map(number),
        length: number(1.0),
        reach: [0.375, 0.25].map(number),
        inertia: [0.125, 0.0625].map(number),
        gravity: number(9.8125),
    };
    let bodies = robot.at(&q, &v).unwrap().forward_dynamics(&tau).unwrap();
    close("bodies", &distance(&bodies, &arm.acceleration(&q, &v, &tau)), 1e-125);
}

#[test]
fn free_top() {
    let moments = [0.75, 1.0, 1.5];
    let inertia = [moments[0], 0.0, 0.0, moments[1], 0.0, moments[2]];
    let free = body(None, 3.0, [0.0; 3], inertia, JointType::Free, [0.0; 3]);
    let robot = Robot::new(&under_gravity(0.0, vec![free]), P).unwrap();
    let attitude = [0.0, 0.0, 0.0, 0.5, -0.5, 0.1, 0.7].map(number);
    // Around the third axis, around the first, both ways; steadily about either.
    for (first, third) in [(0.5, 2.0), (2.0, 0.5), (-2.0, 0.5), (0.3, -1.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.4)] {
        let top = FreeTop::new(moments.map(number), &number(first), &number(third)).unwrap();
        for t in [0.0, 0.7, 11.0] {
            let t = number(t);
            let omega = top.at(&t);
            let mut v = vec![Mp::zero(); 6];
            v[3..].clone_from_slice(&omega);
            let euler = robot.at(&attitude, &v).unwrap().forward_dynamics(&vec![Mp::zero(); 6]).unwrap();
            let derivative = rate(|t| top.at(t).to_vec(), &t);
            close(&format!("Euler's equations from ({first}, 0, {third})"), &gap(&derivative, &euler[3..]), 1e-50);
            let momentum: Vec<Mp> = omega.iter().zip(moments).map(|(omega, moment)| omega * number(moment)).collect();
            let energy: Mp = momentum.iter().zip(&omega).map(|(momentum, omega)| momentum * omega).sum();
            close("energy", &distance(&[energy.half()], &[top.energy()]), 1e-120);
            close("momentum", &distance(&[momentum.iter().map(|x| x * x).sum()], &[top.squared_momentum()]), 1e-120);
            close("period", &distance(&top.at(&(&t + top.period())), &omega), 1e-115);
        }
    }
    // I₁(I₂ − I₁)ω₁² = I₃(I₃ − I₂)ω₃²: the separatrix. And moments that are not in ascending order.
    assert!(FreeTop::new([1.0, 2.0, 3.0].map(number), &number(3.0).sqrt(), &number(1.0)).is_ok());
    assert!(FreeTop::new([1.0, 2.0, 4.0].map(number), &number(8.0).sqrt(), &number(1.0)).is_ok_and(|top| top.at(&Mp::zero())[1].is_zero()));
    assert!(FreeTop::new([2.0, 1.0, 3.0].map(number), &number(1.0), &number(1.0)).is_err());
    assert!(FreeTop::new(moments.map(number), &Mp::zero(), &Mp::zero()).is_err());
}

#[test]
fn heavy_top() {
    // 2 kg half a metre above the fixed point; A = 0.25 + 2·0.25 = 0.75, C = 0.5, mgl = 8.
    let heavy = body(None, 2.0, [0.0, 0.0, 0.5], [0.25, 0.0, 0.0, 0.25, 0.0, 0.5], JointType::Spherical, [0.0; 3]);
    let robot = Robot::new(&under_gravity(8.0, vec![heavy]), P).unwrap();
    let top = HeavyTop { transverse: number(0.75), axial: number(0.5), weight: number(8.0) };
    for (tilt, along_axis) in [(0.4, 30.0), (1.2, -20.0), (2.5, 3.0)] {
        let (tilt, along_axis) = (number(tilt), number(along_axis));
        let [slow, fast] = top.steady(&tilt, &along_axis).unwrap();
        assert!(slow.precession.abs() < fast.precession.abs());
        for steady in [slow, fast] {
            let balance = &top.transverse * tilt.sin_cos().1 * &steady.precession * &steady.precession
                - &top.axial * &along_axis * &steady.precession
                + &top.weight;
            close("quadratic equation", &(balance / &top.weight).abs(), 1e-125);
            for spun in [0.0, 2.0] {
                let spun = number(spun);
                let (omega, acceleration) = steady.body_rates(&spun);
                // R_x(θ) R_z(ψ): the precession angle may be zero.
                let ((a, b), (c, d)) = (tilt.half().sin_cos(), spun.half().sin_cos());
                let quaternion = [&a * &d, -(&a * &c), &b * &c, &b * &d];
                let fall = robot.at(&quaternion, &omega).unwrap().forward_dynamics(&vec![Mp::zero(); 3]).unwrap();
                close("forward dynamics", &gap(&fall, &acceleration), 1e-120);
                let motion = robot.at(&quaternion, &omega).unwrap();
                let kept = top.conserved(&tilt, &Mp::zero(), &steady.precession, &steady.spin);
                close("energy", &distance(&[motion.kinetic_energy() + motion.potential_energy()], &[kept.energy]), 1e-120);
                close("axial momentum", &distance(&[&omega[2] * &top.axial], &[kept.axial]), 1e-120);
            }
        }
    }
    assert!(top.steady(&number(0.4), &number(1.0)).is_err(), "too slow to stand");
    // An upright top precesses at any speed of spin. With nutation its momenta are those of L = T − V.
    let kept = top.conserved(&number(0.5), &number(2.0), &number(3.0), &number(4.0));
    let (sin, cos) = number(0.5).sin_cos();
    let along_axis = number(4.0) + number(3.0) * &cos;
    let vertical = number(0.75) * number(3.0) * &sin * &sin + number(0.5) * &along_axis * &cos;
    close("vertical momentum", &distance(&[kept.vertical], &[vertical]), 1e-125);
}
