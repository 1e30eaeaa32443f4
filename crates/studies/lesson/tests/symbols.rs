//! Expressions against dual numbers, and equations of motion against kernels and closed forms.

use featherbench_lesson::arm::{ARGUMENTS, Arm, Links, Symbolic};
use featherbench_lesson::{Algebra, AlgebraError, Equations, Language};
use featherbench_robots::Random;
use featherbench_spatial::{DoubleDouble, Dual, Real};

/// A drawn expression in x and y, of sums, products, quotients, sines and cosines; divisors stay away from zero.
fn drawn(a: &mut Algebra, random: &mut Random) -> featherbench_lesson::Expression {
    let mut all = vec![a.symbol("x"), a.symbol("y"), a.number(0.5), a.number(1.0)];
    for _ in 0..25 {
        let (one, two) = (all[random.below(all.len())], all[random.below(all.len())]);
        let next = match random.below(6) {
            0 => a.add(one, two),
            1 => a.sub(one, two),
            2 => {
                let (sine, cosine) = (a.sin(one), a.cos(two));
                a.mul(sine, cosine)
            }
            3 => {
                let (cosine, three) = (a.cos(two), a.number(3.0));
                let divisor = a.add(cosine, three);
                a.div(one, divisor)
            }
            4 => a.sin(one),
            _ => a.negative(one),
        };
        all.push(next);
    }
    let tail = all.split_off(all.len() - 4);
    a.sum(&tail)
}

#[test]
fn derivatives_are_those_of_duals() {
    let mut moved = 0;
    for draw in 0..200 {
        let mut random = Random::new(1, draw);
        let mut a = Algebra::default();
        let f = drawn(&mut a, &mut random);
        let x = a.symbol("x");
        let slope = a.derivative(f, x);
        let curvature = a.derivative(slope, x);
        let point = [random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)];
        let found = a.evaluate(&[slope, curvature], &["x", "y"], &point).unwrap();
        let inner = Dual::new(point[0], 1.0);
        let twice = [Dual::new(inner, Dual::constant(1.0)), Dual::constant(Dual::constant(point[1]))];
        let known = a.evaluate(&[f], &["x", "y"], &twice).unwrap()[0].derivative;
        let scale = 1.0 + known.value.abs() + known.derivative.abs();
        assert!((found[0] - known.value).abs() < 1e-12 * scale, "{draw}: {} {}", found[0], known.value);
        assert!((found[1] - known.derivative).abs() < 1e-11 * scale, "{draw}: {} {}", found[1], known.derivative);
        moved += usize::from(found[0] != 0.0 && found[1] != 0.0);
    }
    assert!(moved > 150, "{moved} expressions depend on x");
}

/// M and h by symbols, by hand and by our kernels.
#[test]
fn the_arm_is_that_of_the_kernels() {
    for links in Links::ALL {
        let symbolic = Symbolic::of(links).unwrap();
        let mass = &symbolic.equations.mass;
        let wanted = [mass[0][0], mass[0][1], mass[1][0], mass[1][1], symbolic.equations.bias[0], symbolic.equations.bias[1]];
        for draw in 0..20 {
            let mut random = Random::new(3, draw);
            let arm = Arm { q: [random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)], ..Arm::default().with(links) };
            let found = symbolic.algebra.evaluate(&wanted, &ARGUMENTS, &arm.arguments([0.0; 2])).unwrap();
            let ([m11, m12, m22], h) = arm.closed_form(arm.masses.map(DoubleDouble::from_f64));
            for (found, known) in found.iter().zip([m11, m12, m12, m22, h[0], h[1]]) {
                // A few roundings of terms up to 40.
                assert!((found - known.to_f64()).abs() < 2e-14, "{links:?}: {found} {}", known.to_f64());
            }
            let Some(model) = arm.model().unwrap() else {
                assert_eq!(links, Links::Lesson);
                continue;
            };
            let (kernel, bias) = (
                featherbench_dynamics::mass_matrix(&model, &arm.q).unwrap(),
                featherbench_dynamics::bias_force(&model, &arm.q, &arm.v).unwrap(),
            );
            assert!((kernel.get(0, 0) - found[0]).abs() < 2e-14 && (kernel.get(1, 0) - found[1]).abs() < 2e-14);
            assert!((bias[0] - found[4]).abs() < 2e-14 * 40.0 && (bias[1] - found[5]).abs() < 2e-14 * 40.0);
        }
    }
}

/// A cart with a pendulum: equations that no kernel of the arm knows, by hand.
#[test]
fn a_cart_with_a_pendulum() {
    let mut a = Algebra::default();
    let [x, angle, speed, rate, cart, bob, l, g, f] = ["x", "p", "dx", "dp", "mc", "mb", "l", "g", "f"].map(|name| a.symbol(name));
    let (sine_free, half, two) = (a.cos(angle), a.number(0.5), a.number(2.0));
    let both = a.add(cart, bob);
    let terms = [a.product(&[both, speed, speed]), a.product(&[bob, l, l, rate, rate]), a.product(&[two, bob, l, speed, rate, sine_free])];
    let twice = a.sum(&terms);
    let (kinetic, potential) = (a.mul(half, twice), a.product(&[bob, g, l, sine_free]));
    let lagrangian = a.sub(kinetic, potential);
    let equations = Equations::of(&mut a, lagrangian, &[x, angle], &[speed, rate]).unwrap();
    let nothing = a.number(0.0);
    let found = equations.accelerations(&mut a, &[f, nothing]).unwrap();
    let names = ["p", "dx", "dp", "mc", "mb", "l", "g", "f"];
    let values = [0.4_f64, 0.9, -1.3, 2.0, 0.5, 0.8, 9.81, 1.7];
    let [p, _, dp, mc, mb, l, g, f] = values;
    let acceleration = (f + mb * l * dp * dp * p.sin() - mb * g * p.sin() * p.cos()) / (mc + mb * p.sin().powi(2));
    let known = [acceleration, (g * p.sin() - acceleration * p.cos()) / l];
    for (found, known) in a.evaluate(&found, &names, &values).unwrap().iter().zip(known) {
        assert!((found - known).abs() < 1e-13, "{found} {known}");
    }
}

#[test]
fn bad_input_is_named() {
    let mut a = Algebra::default();
    let (x, y) = (a.symbol("x"), a.symbol("y"));
    let sum = a.add(x, y);
    assert_eq!(a.evaluate(&[sum], &["x"], &[1.0]), Err(AlgebraError::Unbound { symbol: "y".into() }));
    assert_eq!(a.evaluate(&[sum], &["x"], &[1.0, 2.0]), Err(AlgebraError::Count { names: 1, values: 2 }));
    assert_eq!(a.source(Language::C, "f", &[sum], &["x"]), Err(AlgebraError::Unbound { symbol: "y".into() }));
    assert_eq!(a.source(Language::C, "f g", &[sum], &["x", "y"]), Err(AlgebraError::Name { name: "f g".into() }));
    let shape = Equations::of(&mut a, sum, &[x], &[]).err();
    assert_eq!(shape, Some(AlgebraError::Shape { what: "rates", found: 0, due: 1 }));
}
