//! The identities of spatial algebra, on random vectors and placements.

use featherbench_spatial::{ArticulatedInertia, CentralInertia, Force, Mat3, Motion, Quaternion, RigidBodyInertia, Sym3, Transform, Vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Every identity below adds some dozens of products of numbers up to a few tens: 1e-12 is some hundred roundings of the largest.
const TOLERANCE: f64 = 1e-12;

fn number() -> impl Strategy<Value = f64> {
    -2.0..2.0
}

fn vec3() -> impl Strategy<Value = Vec3<f64>> {
    [number(), number(), number()].prop_map(Vec3::from_array)
}

fn motion() -> impl Strategy<Value = Motion<f64>> {
    (vec3(), vec3()).prop_map(|(ang, lin)| Motion::new(ang, lin))
}

fn force() -> impl Strategy<Value = Force<f64>> {
    (vec3(), vec3()).prop_map(|(ang, lin)| Force::new(ang, lin))
}

fn placement() -> impl Strategy<Value = Transform<f64>> {
    let turn =
        [number(), number(), number(), number()].prop_filter("a quaternion has a length", |q| q.iter().map(|x| x * x).sum::<f64>() > 0.1);
    (turn, vec3()).prop_map(|(q, p)| Transform::new(Quaternion::from_array(q).to_rotation(), p))
}

fn inertia() -> impl Strategy<Value = RigidBodyInertia<f64>> {
    let diagonal = [1.0..2.0, 1.0..2.0, 1.0..2.0];
    (0.1..3.0, vec3(), diagonal, placement()).prop_map(|(mass, com, [a, b, c], x)| {
        RigidBodyInertia::from_com(mass, com, Sym3::from_array([a, 0.0, 0.0, b, 0.0, c]).rotate(x.rotation))
    })
}

fn close(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= TOLERANCE)
}

/// A dense 6×6 matrix, column by column, of a linear map on motions.
fn columns(map: impl Fn(Motion<f64>) -> Force<f64>) -> Vec<[f64; 6]> {
    (0..6)
        .map(|k| {
            let mut unit = [0.0; 6];
            unit[k] = 1.0;
            map(Motion::from_array(unit)).to_array()
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn rotations_are_orthonormal_and_right_handed(x in placement(), u in vec3()) {
        let r = x.rotation;
        prop_assert!(close(&(r * r.transpose()).to_array(), &Mat3::identity().to_array()));
        prop_assert!((r.x.cross(r.y).dot(r.z) - 1.0).abs() <= TOLERANCE);
        let length = u.norm();
        prop_assume!(length > 0.1);
        let (sin, cos) = 0.7_f64.sin_cos();
        let axis = u * (1.0 / length);
        let turn = Transform::axis_rotation(axis, sin, cos);
        prop_assert!(close(&(turn * turn.transpose()).to_array(), &Mat3::identity().to_array()));
        prop_assert!(close(&(turn * axis).to_array(), &axis.to_array()), "the axis stays");
        let half = 0.35_f64;
        let quaternion = Quaternion { v: axis * half.sin(), w: half.cos() };
        prop_assert!(close(&quaternion.to_rotation().to_array(), &turn.to_array()));
    }

    #[test]
    fn a_turn_about_an_axis_of_the_frame_is_exact(angle in -10.0..10.0_f64, sign in prop::sample::select(vec![-1.0, 1.0])) {
        let (s, c) = angle.sin_cos();
        let s_u = sign * s;
        let of = |axis: [f64; 3]| Transform::axis_rotation(Vec3::from_array(axis.map(|x| x * sign)), s, c).to_array();
        prop_assert_eq!(of([1.0, 0.0, 0.0]), [1.0, 0.0, 0.0, 0.0, c, -s_u, 0.0, s_u, c]);
        prop_assert_eq!(of([0.0, 1.0, 0.0]), [c, 0.0, s_u, 0.0, 1.0, 0.0, -s_u, 0.0, c]);
        prop_assert_eq!(of([0.0, 0.0, 1.0]), [c, -s_u, 0.0, s_u, c, 0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn power_does_not_depend_on_the_frame(x in placement(), m in motion(), f in force()) {
        prop_assert!((x.motion(m).dot(x.force(f)) - m.dot(f)).abs() <= 10.0 * TOLERANCE, "sums of products of shifted vectors, ten times larger");
    }

    #[test]
    fn inverse_transforms_undo(x in placement(), m in motion(), f in force(), p in vec3()) {
        prop_assert!(close(&x.inverse_motion(x.motion(m)).to_array(), &m.to_array()));
        prop_assert!(close(&x.inverse_force(x.force(f)).to_array(), &f.to_array()));
        prop_assert!(close(&x.inverse().motion(m).to_array(), &x.inverse_motion(m).to_array()));
        prop_assert!(close(&x.inverse().force(f).to_array(), &x.inverse_force(f).to_array()));
        prop_assert!(close(&x.inverse().point(x.point(p)).to_array(), &p.to_array()));
    }

    #[test]
    fn composition_acts_one_after_the_other(x in placement(), y in placement(), m in motion(), f in force()) {
        prop_assert!(close(&x.compose(&y).motion(m).to_array(), &x.motion(y.motion(m)).to_array()));
        prop_assert!(close(&x.compose(&y).force(f).to_array(), &x.force(y.force(f)).to_array()));
    }

    #[test]
    fn products_of_motion_and_force_are_dual(v in motion(), m in motion(), f in force()) {
        prop_assert!((v.cross_motion(m).dot(f) + m.dot(v.cross_force(f))).abs() <= 10.0 * TOLERANCE, "(v×)ᵀ = −v×*");
        prop_assert!(close(&v.cross_motion(v).to_array(), &[0.0; 6]));
    }

    #[test]
    fn inertias_move_by_congruence(x in placement(), i in inertia(), m in motion()) {
        let direct = i.to_parent(&x).mul(m);
        let around = x.force(i.mul(x.inverse_motion(m)));
        // Inertias shifted by two metres twice: products of four numbers around two.
        prop_assert!(direct.to_array().iter().zip(around.to_array()).all(|(a, b)| (a - b).abs() <= 50.0 * TOLERANCE));
        let articulated = i.to_articulated();
        prop_assert!(close(&articulated.mul(m).to_array(), &i.mul(m).to_array()));
        let moved = articulated.to_parent(&x).mul(m);
        prop_assert!(moved.to_array().iter().zip(around.to_array()).all(|(a, b)| (a - b).abs() <= 50.0 * TOLERANCE));
    }

    #[test]
    fn an_inertia_about_the_centre_of_mass_is_the_same_inertia(x in placement(), i in inertia(), j in inertia(), m in motion()) {
        let near = |a: Force<f64>, b: Force<f64>| a.to_array().iter().zip(b.to_array()).all(|(a, b)| (a - b).abs() <= 50.0 * TOLERANCE);
        prop_assert!(near(i.central().mul(m), i.mul(m)), "products of four numbers around two");
        prop_assert!(near(i.central().to_parent(&x).mul(m), i.to_parent(&x).mul(m)));
        let mut both = i.central();
        both += j.central();
        prop_assert!(near(both.mul(m), (i + j).mul(m)));
        // A body without mass changes nothing, on either side.
        let mut same = both;
        same += CentralInertia::zero().to_parent(&x);
        prop_assert_eq!(same, both);
        let mut first = RigidBodyInertia::zero().central();
        first += both;
        prop_assert!(near(first.mul(m), both.mul(m)));
    }

    #[test]
    fn articulated_inertias_stay_symmetric_and_lose_the_free_direction(x in placement(), i in inertia(), s in motion()) {
        let a = i.to_parent(&x).to_articulated();
        let u = a.mul(s);
        let d = s.dot(u);
        prop_assume!(d > 0.1);
        let rest = a.subtract_rank_one(u * (1.0 / d), u);
        let scale = u.to_array().iter().map(|x| x.abs()).fold(1.0, |most, x| if x > most || x.is_nan() { x } else { most });
        prop_assert!(rest.mul(s).to_array().iter().all(|f| f.abs() <= 100.0 * TOLERANCE * scale), "Iᵃ S = 0");
        let general: ArticulatedInertia<f64> = rest.to_parent(&x);
        let matrix = columns(|m| general.mul(m));
        for (r, row) in matrix.iter().enumerate() {
            for (c, entry) in row.iter().enumerate() {
                prop_assert!((entry - matrix[c][r]).abs() <= 1e3 * TOLERANCE * scale, "symmetric, entries up to a few hundred");
            }
        }
    }

    #[test]
    fn kinetic_energy_is_that_of_the_centre_of_mass(mass in 0.1..3.0_f64, com in vec3(), v in motion()) {
        let about_com = Sym3::from_array([1.0, 0.1, -0.2, 1.5, 0.3, 2.0]);
        let i = RigidBodyInertia::from_com(mass, com, about_com);
        let at_com = v.lin + v.ang.cross(com);
        let expected = mass * at_com.dot(at_com) + v.ang.dot(about_com * v.ang);
        prop_assert!((v.dot(i.mul(v)) - expected).abs() <= 100.0 * TOLERANCE);
        prop_assert!(close(&i.com().to_array(), &com.to_array()));
    }

    #[test]
    fn small_symmetric_systems_are_solved(i in inertia(), b in vec3()) {
        let s = i.rotational;
        let factors = s.factor();
        prop_assert!(factors.pivots.to_array().iter().all(|&pivot| pivot > 0.0));
        prop_assert!(close(&(s * factors.solve(b)).to_array(), &b.to_array()), "κ below a hundred");
    }

    /// Any symmetric matrix, of any size and as nearly diagonal as numbers can be.
    #[test]
    fn principal_axes_give_the_matrix_back(m in [number(), number(), number(), number(), number(), number()], small in -20..1, scale in -100..100) {
        let off = 10_f64.powi(small);
        let [xx, xy, xz, yy, yz, zz] = m;
        let size = 10_f64.powi(scale);
        let s = Sym3::from_array([xx, off * xy, off * xz, yy, off * yz, zz].map(|x| size * x));
        let (moments, axes) = s.principal();
        let [a, b, c] = moments;
        let back = Sym3::from_array([a, 0.0, 0.0, b, 0.0, c]).rotate(axes).to_array();
        let largest = s.to_array().into_iter().map(f64::abs).fold(0.0, featherbench_spatial::larger);
        // Each of some ten rotations rounds every entry by an ulp of the largest.
        prop_assert!(s.to_array().iter().zip(back).all(|(x, y)| (x - y).abs() <= 64.0 * f64::EPSILON * largest), "{s:?} {back:?}");
        let identity = (axes.transpose() * axes).to_array();
        prop_assert!(identity.iter().zip(Mat3::<f64>::identity().to_array()).all(|(x, y)| (x - y).abs() <= 64.0 * f64::EPSILON));
        prop_assert!(axes.x.dot(axes.y.cross(axes.z)) > 0.0, "a rotation");
    }

    #[test]
    fn quaternions_turn_at_the_rate_of_the_body(q in [number(), number(), number(), number()], omega in vec3()) {
        let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        prop_assume!(length > 0.3);
        let q = Quaternion::from_array(q.map(|x| x / length));
        let rate = q.derivative(omega);
        // Ṙ = R ω×, by a central difference whose error is of the order h².
        let h = 1e-5;
        let at = |t: f64| Quaternion { v: q.v + rate.v * t, w: q.w + rate.w * t }.to_rotation().to_array();
        let expected = (q.to_rotation() * Mat3::skew(omega)).to_array();
        let difference: Vec<f64> = at(h).iter().zip(at(-h)).map(|(a, b)| (a - b) / (2.0 * h)).collect();
        prop_assert!(difference.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-8), "h² and rounding/h are both below 1e-9");
    }
}
