//! What saltation matrices do, each at 200 drawn states. That they are the closed forms of `systems` is asked by the study `contact`.

use featherbench_hybrid::systems::{BouncingBall, RimlessWheel, SlantedBox, SlidingSphere, StickSlip};
use featherbench_hybrid::{HybridError, Saltation};
use featherbench_robots::Random;
use nalgebra::{DMatrix, Matrix2};

const DRAWS: usize = 200;

/// The largest difference, relative to the largest entry.
fn difference(found: &DMatrix<f64>, known: &DMatrix<f64>) -> f64 {
    (found - known).amax() / known.amax()
}

#[test]
fn ball() {
    let mut random = Random::named(1, "saltation of a ball");
    for _ in 0..DRAWS {
        let (g, e, v) = (random.uniform(1.0, 20.0), random.uniform(0.0, 1.0), -random.uniform(0.01, 10.0));
        let found = Saltation::new(&BouncingBall, &[g, e], 0, 0, 1, 0.0, &[0.0, v, 2.0]).unwrap();
        let matrix = found.matrix();
        let part = matrix.view((0, 0), (2, 2)).into_owned();
        // The area in phase space shrinks by e².
        assert!((part.determinant() - e * e).abs() <= 1e-12 * part.amax().powi(2));
        // ∂t*/∂y = −1/v; the speed after grows with e by the speed before; the path stops growing by v − and begins by +v⁺.
        assert!((found.time[0] + 1.0 / v).abs() <= 1e-12 / v.abs() && found.time[1] == 0.0);
        assert!((found.parameters()[(1, 1)] + v).abs() <= 1e-12 * v.abs());
    }
}

/// Against the bouncing ball's matrix in the frame of the wall.
#[test]
fn slanted_wall() {
    let mut random = Random::named(3, "saltation at a wall");
    for _ in 0..DRAWS {
        let (g, e, angle, d) = (random.uniform(1.0, 20.0), random.uniform(0.0, 1.0), random.uniform(-3.0, 3.0), random.uniform(-1.0, 1.0));
        let (normal, along) = (-random.uniform(0.1, 5.0), random.uniform(-5.0, 5.0));
        let (sine, cosine) = angle.sin_cos();
        let v = [normal * cosine - along * sine, normal * sine + along * cosine];
        let before = [d * cosine, d * sine, v[0], v[1]];
        let found = Saltation::new(&SlantedBox { walls: 1 }, &[g, e, angle, d], 0, 0, 0, 0.0, &before).unwrap().matrix();
        // In the frame (normal, tangent) the normal pair is a ball under the gravity g sin φ, and the tangent pair passes.
        let turn = DMatrix::from_row_slice(2, 2, &[cosine, sine, -sine, cosine]);
        let mut both = DMatrix::zeros(4, 4);
        both.view_mut((0, 0), (2, 2)).copy_from(&turn);
        both.view_mut((2, 2), (2, 2)).copy_from(&turn);
        let turned = &both * found * both.transpose();
        let mut frame = DMatrix::identity(4, 4);
        (frame[(0, 0)], frame[(2, 2)], frame[(2, 0)]) = (-e, -e, -(1.0 + e) * g * sine / normal);
        assert!(difference(&turned, &frame) <= 1e-12);
    }
}

/// Entry into the sliding mode: rank 1, the relative velocity is forgotten. Exit with equal fields: the identity.
#[test]
fn filippov() {
    let mut random = Random::named(4, "saltation of stick and slip");
    for _ in 0..DRAWS {
        let (m, k, u) = (random.uniform(0.2, 5.0), random.uniform(1.0, 100.0), random.uniform(0.05, 2.0));
        let moving = random.uniform(0.1, 5.0);
        let fixed = moving + random.uniform(0.1, 5.0);
        let position = random.uniform(-fixed, 0.9 * moving) / k;
        let theta = [m, k, u, fixed, moving];
        let entry = Saltation::new(&StickSlip, &theta, 1, 0, 0, 0.0, &[position, u]).unwrap();
        assert!((entry.matrix() - DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 0.0])).amax() <= 1e-12);
        // The velocity after is the belt's.
        assert!((entry.parameters()[(1, 2)] - 1.0).abs() <= 1e-12);
        // With F = S the field of slipping is that of sticking where it begins.
        let equal = [m, k, u, moving, moving];
        let exit = Saltation::new(&StickSlip, &equal, 0, 0, 1, 0.0, &[moving / k, u]).unwrap();
        // The fields differ by the rounding of (F − k(F/k))/m.
        assert!((exit.matrix() - DMatrix::identity(2, 2)).amax() <= 1e-12 && exit.parameters().amax() <= 1e-12);
        // With F < S the mass is accelerated at once: Ξ = 1 + (f₊ − f₋)∇g/ġ with ∇g = (k, 0), ġ = ku.
        let exit = Saltation::new(&StickSlip, &theta, 0, 0, 1, 0.0, &[fixed / k, u]).unwrap().matrix();
        let known = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, (moving - fixed) / (m * u), 1.0]);
        assert!(difference(&exit, &known) <= 1e-12);
    }
}

/// From sliding to rolling: v − ρω is forgotten, v + (2/5)ρω is kept.
#[test]
fn sphere() {
    let mut random = Random::named(5, "saltation of a sphere");
    for _ in 0..DRAWS {
        let (mu, g, radius, v) = (random.uniform(0.1, 1.0), random.uniform(1.0, 20.0), random.uniform(0.1, 2.0), random.uniform(0.1, 5.0));
        let found = Saltation::new(&SlidingSphere, &[mu, g, radius], 0, 0, 1, 0.0, &[0.0, v, v / radius]).unwrap().matrix();
        // The projector on v = ρω along the change that friction makes.
        let known =
            DMatrix::from_row_slice(3, 3, &[1.0, 0.0, 0.0, 0.0, 5.0 / 7.0, 2.0 * radius / 7.0, 0.0, 5.0 / (7.0 * radius), 2.0 / 7.0]);
        assert!(difference(&found, &known) <= 1e-12, "{found}");
    }
}

/// Ξ f₋ = f₊ for every event without explicit time: the flow after is the image of the flow before.
#[test]
fn wheel_and_the_flow() {
    let mut random = Random::named(6, "saltation of a wheel");
    for _ in 0..DRAWS {
        let theta = [random.uniform(3.0, 30.0), random.uniform(0.0, 0.3), random.uniform(0.1, 0.7)];
        let rate = random.uniform(0.5, 5.0);
        let angle = theta[1] + theta[2];
        let found = Saltation::new(&RimlessWheel, &theta, 0, 0, 0, 0.0, &[angle, rate]).unwrap().matrix();
        let field = |angle: f64, rate: f64| nalgebra::Vector2::new(rate, theta[0] * angle.sin());
        let factor = (2.0 * theta[2]).cos();
        let matrix = Matrix2::from_iterator(found.iter().copied());
        let error = matrix * field(angle, rate) - field(angle - 2.0 * theta[2], factor * rate);
        assert!(error.amax() <= 1e-12 * (1.0 + theta[0] + rate));
        // In closed form: ∇g = (1, 0), ġ = ω.
        let gain = theta[0] * ((angle - 2.0 * theta[2]).sin() - factor * angle.sin()) / rate;
        let known = DMatrix::from_row_slice(2, 2, &[factor, 0.0, gain, factor]);
        assert!(difference(&found, &known) <= 1e-12);
    }
}

/// Near grazing Ξ grows as 1/v⁻ without a bound, and at v⁻ = 0 it does not exist.
#[test]
fn nothing_is_clipped() {
    for v in [-1e-3, -1e-9, -1e-200] {
        let found = Saltation::new(&BouncingBall, &[9.81, 0.8], 0, 0, 1, 0.0, &[0.0, v, 0.0]).unwrap().matrix();
        assert!((found[(1, 0)] / (-1.8 * 9.81 / v) - 1.0).abs() <= 1e-12);
    }
    let error = Saltation::new(&BouncingBall, &[9.81, 0.8], 0, 0, 1, 0.5, &[0.0, 0.0, 0.0]).unwrap_err();
    assert_eq!(error, HybridError::Tangent { mode: 0, guard: 0, time: 0.5, rate: 0.0 });
}
