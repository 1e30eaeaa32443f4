//! Andrews' squeezer: bodies and loops against the equations of the literature, by two integrators.

use crate::common::assert_within;
use featherbench_constrained::library::Squeezer;
use featherbench_constrained::stabilise::{Projection, Simulation, Stabilisation};
use featherbench_constrained::{Constrained, Kkt, Rows};
use featherbench_dynamics::integrate::{DormandPrince, Tolerance};
use featherbench_model::{Axis, JointKind, Topology};
use featherbench_spatial::largest;
use featherbench_spatial::{Dual, Real};
use nalgebra::{DMatrix, DVector};

/// The positions of point E by four ways, less each other: the six constraints of the literature, in q = β, Θ, γ, δ, Φ, ε, Ω.
fn closure<T: Real>(s: &Squeezer, q: &[T; 7]) -> [T; 6] {
    let n = T::from_f64;
    let turn = |angle: T| angle.sin_cos();
    let [beta, theta, gamma, delta, phi, epsilon, omega] = *q;
    let ((sb, cb), (sbt, cbt)) = (turn(beta), turn(beta + theta));
    let by_k2 = [n(s.k1[0]) * cb - n(s.k2[0]) * cbt, n(s.k1[0]) * sb - n(s.k2[0]) * sbt];
    let (sg, cg) = turn(gamma);
    let by_k3 = [n(s.b[0]) + n(s.k3[0]) * sg, n(s.b[1]) - n(s.k3[0]) * cg];
    let ((sd, cd), (spd, cpd)) = (turn(delta), turn(phi + delta));
    let by_k4 = [n(s.a[0]) + n(s.k4[0]) * spd + n(s.k5[0]) * cd, n(s.a[1]) - n(s.k4[0]) * cpd + n(s.k5[0]) * sd];
    let ((se, ce), (soe, coe)) = (turn(epsilon), turn(omega + epsilon));
    let by_k6 = [n(s.a[0]) + n(s.k6[0]) * coe + n(s.k7[0]) * se, n(s.a[1]) + n(s.k6[0]) * soe - n(s.k7[0]) * ce];
    let less = |other: [T; 2]| [by_k2[0] - other[0], by_k2[1] - other[1]];
    let [[a, b], [c, d], [e, f]] = [less(by_k3), less(by_k4), less(by_k6)];
    [a, b, c, d, e, f]
}

/// v̇ by the mass matrix and forces of the literature, with J and J̇v of `closure` by dual numbers.
fn literature(s: &Squeezer, q: &[f64], v: &[f64]) -> Vec<f64> {
    let [m1, m2, m3, m4, m5, m6, m7] = s.mass;
    let [i1, i2, i3, i4, i5, i6, i7] = s.inertia;
    let ([rr, ra], [_, da], [_, sa, sb, sc, sd]) = (s.k1, s.k2, s.k3);
    let ([e, ea], [zt, ta, tb], [zf, fa], [u, ua, ub]) = (s.k4, s.k5, s.k6, s.k7);
    let [_, theta, gamma, _, phi, _, omega] = [0, 1, 2, 3, 4, 5, 6].map(|k| q[k]);
    let (he, hf) = (e - ea, zf - fa);
    let mut m = DMatrix::zeros(7, 7);
    m[(0, 0)] = m1 * ra * ra + m2 * (rr * rr - 2.0 * da * rr * theta.cos() + da * da) + i1 + i2;
    m[(0, 1)] = m2 * (da * da - da * rr * theta.cos()) + i2;
    m[(1, 1)] = m2 * da * da + i2;
    m[(2, 2)] = m3 * (sa * sa + sb * sb) + i3;
    m[(3, 3)] = m4 * (zt * zt + 2.0 * zt * he * phi.sin() + he * he) + m5 * (ta * ta + tb * tb) + i4 + i5;
    m[(3, 4)] = m4 * (he * he + zt * he * phi.sin()) + i4;
    m[(4, 4)] = m4 * he * he + i4;
    m[(5, 5)] = m6 * (hf * hf - 2.0 * u * hf * omega.sin() + u * u) + m7 * (ua * ua + ub * ub) + i6 + i7;
    m[(5, 6)] = m6 * (hf * hf - u * hf * omega.sin()) + i6;
    m[(6, 6)] = m6 * hf * hf + i6;
    let [vb, vt, _, vd, vp, ve, vo] = [0, 1, 2, 3, 4, 5, 6].map(|k| v[k]);
    let (xd, yd) = (sd * gamma.cos() + sc * gamma.sin() + s.b[0], sd * gamma.sin() - sc * gamma.cos() + s.b[1]);
    let length = ((xd - s.c[0]).powi(2) + (yd - s.c[1]).powi(2)).sqrt();
    let force = -s.stiffness * (length - s.spring) / length;
    let (fx, fy) = (force * (xd - s.c[0]), force * (yd - s.c[1]));
    let mut f = DVector::zeros(13);
    f[0] = s.torque - m2 * da * rr * vt * (vt + 2.0 * vb) * theta.sin();
    f[1] = m2 * da * rr * vb * vb * theta.sin();
    f[2] = fx * (sc * gamma.cos() - sd * gamma.sin()) + fy * (sd * gamma.cos() + sc * gamma.sin());
    f[3] = -m4 * zt * he * vp * (vp + 2.0 * vd) * phi.cos();
    f[4] = m4 * zt * he * vd * vd * phi.cos();
    f[5] = m6 * u * hf * vo * (vo + 2.0 * ve) * omega.cos();
    f[6] = -m6 * u * hf * ve * ve * omega.cos();
    let mut kkt = DMatrix::zeros(13, 13);
    for i in 0..7 {
        for j in i..7 {
            (kkt[(i, j)], kkt[(j, i)]) = (m[(i, j)], m[(i, j)]);
        }
        let moving: [Dual<f64>; 7] = std::array::from_fn(|k| Dual::new(q[k], if k == i { 1.0 } else { 0.0 }));
        for (row, g) in closure(s, &moving).into_iter().enumerate() {
            (kkt[(7 + row, i)], kkt[(i, 7 + row)]) = (g.derivative, g.derivative);
        }
    }
    // Along q + t v: the second derivative.
    let moving: [Dual<Dual<f64>>; 7] = std::array::from_fn(|k| Dual::new(Dual::new(q[k], v[k]), Dual::new(v[k], 0.0)));
    closure(s, &moving).into_iter().enumerate().for_each(|(row, g)| f[7 + row] = -g.derivative.derivative);
    let x = kkt.full_piv_lu().solve(&f).expect("not singular");
    x.rows(0, 7).iter().copied().collect()
}

/// The loops are closed at the start, and v̇ there is that of the literature; also where it moves.
#[test]
fn the_bodies_are_those_of_the_literature() {
    let squeezer = Squeezer::default();
    let mechanism = squeezer.mechanism().unwrap();
    let q = Squeezer::start();
    let mut rows = Rows::new(&mechanism.constraints);
    rows.run(&mechanism.model, &mechanism.constraints, &q, &[0.0; 7]).unwrap();
    // Lengths of 0.1 m, rounded.
    assert_within("closure", largest(rows.residuals()), 1e-16);
    assert_within("closure of the literature", largest(closure(&squeezer, &q)), 1e-16);
    let mut dynamics = Constrained::new(&mechanism.model, &mechanism.constraints).unwrap();
    for rate in [0.0, 100.0] {
        // A velocity that keeps the loops closed.
        let mut v = [rate, -0.3 * rate, 0.0, 0.0, 0.0, 0.0, 0.0];
        Projection::default().velocity(&mechanism.model, &mechanism.constraints, &q, &mut v).unwrap();
        let mut tau = [0.0; 7];
        squeezer.add_forces(&q, &mut tau);
        let found = dynamics.run(&q, &v, &tau, &Kkt::default()).unwrap();
        assert_eq!(found.rank, Some(6));
        let due = literature(&squeezer, &q, &v);
        let scale = largest(due.iter().copied());
        assert!(scale > 1e3);
        if rate == 0.0 {
            // The consistent β̈ and Θ̈ at the start that the test set prints.
            for (a, witness) in found.acceleration.iter().zip([14_222.443_919_954_114, -10_666.832_939_965_585]) {
                assert_within("v̇ of the test set", (a - witness).abs() / scale, 1e-11);
            }
        }
        for (a, due) in found.acceleration.iter().zip(due) {
            assert_within("v̇", (a - due).abs() / scale, 1e-11);
        }
    }
}

/// t = 0.03 s: ours by Runge and Kutta with projection; the literature's equations by Dormand and Prince. The values of the test set for
/// IVP solvers are a witness of both.
#[test]
fn two_integrators_and_the_witness_agree() {
    let squeezer = Squeezer::default();
    let mechanism = squeezer.mechanism().unwrap();
    let forces = |_: f64, q: &[f64], _: &[f64], tau: &mut [f64]| squeezer.add_forces(q, tau);
    let simulation = Simulation {
        model: &mechanism.model,
        constraints: &mechanism.constraints,
        forces: &forces,
        method: &Kkt::default(),
        stabilisation: Stabilisation::Projection(Projection::default()),
    };
    let [coarse, ours] =
        [(1e-5, 3000), (5e-6, 6000)].map(|(step, steps)| simulation.run(&Squeezer::start(), &[0.0; 7], step, steps).unwrap());

    let flat = Topology::new(&[(None, JointKind::Revolute(Axis::Z)); 7]).unwrap();
    let mut theirs = |_: f64, q: &[f64], v: &[f64], a: &mut [f64]| {
        a.copy_from_slice(&literature(&squeezer, q, v));
        Ok(())
    };
    let (mut q, mut v) = (Squeezer::start(), [0.0; 7]);
    let tolerance = Tolerance { absolute: 1e-12, relative: 1e-12, ..Tolerance::default() };
    DormandPrince::new(&flat).run(&mut theirs, [0.0, 0.03], &mut q, &mut v, &tolerance, |_, _, _| ()).unwrap();

    let witness = [
        15.810_771_196_299_04,
        -15.756_371_059_842_98,
        0.040_822_240_130_731_01,
        0.524_409_965_880_530_4,
        -0.534_730_116_322_694_8,
        1.048_080_741_042_263,
        0.534_730_116_322_694_8,
    ];
    for k in 0..7 {
        // β and Θ turn by 16 rad, and an error of a velocity stays: 2e-11 is seen, at a tolerance of 10⁻¹² per step.
        assert_within("two integrators", (ours.q[k] - q[k]).abs(), 1e-9);
        // Both of ours differ from the witness by the same 1.2e-9 in β: that is the accuracy of the witness.
        assert_within("witness", (ours.q[k] - witness[k]).abs(), 1e-8);
    }
    // Ours tend to theirs with the order of the method, 2⁴ = 16, and not to the witness. (Steps twice as long have a ratio of 20: higher
    // orders count there.)
    let ratio = (coarse.q[0] - q[0]) / (ours.q[0] - q[0]);
    assert!((12.0..20.0).contains(&ratio), "{ratio}");
    assert_within("loops", ours.position_drift(), 1e-12);
}
