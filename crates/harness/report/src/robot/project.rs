//! The projection of a drawing: orthographic, z upwards, turned about z and then tilted towards the reader.

use featherbench_results::DrawnBody;

use crate::numbers::{larger, smaller};

/// From where a robot is seen, and how large.
pub(super) struct View {
    /// The point in the middle of the picture, in m.
    pub(super) middle: [f64; 3],
    /// Pixels to a metre.
    pub(super) scale: f64,
    /// The turn about z, rad.
    pub(super) turn: f64,
    /// The tilt about the horizontal axis of the picture, rad.
    pub(super) tilt: f64,
    size: [f64; 2],
}

impl View {
    /// A view in which all of a robot is seen from every side: a sphere about it fits.
    pub(super) fn of(bodies: &[DrawnBody], size: [f64; 2], margin: f64) -> Self {
        let points = || bodies.iter().flat_map(|body| [body.origin, body.centre]).chain([[0.0; 3]]);
        let middle: [f64; 3] = std::array::from_fn(|k| {
            let range = points().map(|point| point[k]).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [smaller(a, x), larger(b, x)]);
            (range[0] + range[1]) / 2.0
        });
        let length = |x: [f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let reach = |body: &DrawnBody| body.axes.iter().map(|axis| length(*axis)).fold(0.0, larger);
        let off = |point: [f64; 3]| length(std::array::from_fn(|k| point[k] - middle[k]));
        let ends = bodies.iter().map(|body| larger(off(body.origin), off(body.centre) + reach(body)));
        let radius = ends.fold(off([0.0; 3]), larger);
        let half = smaller(size[0], size[1]) / 2.0 - margin;
        let scale = if radius > 0.0 && radius.is_finite() { half / radius } else { half };
        Self { middle, scale, turn: -0.6, tilt: 0.4, size }
    }

    /// A direction in the picture's axes: right, down, towards the reader.
    pub(super) fn turned(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let ((s, c), (st, ct)) = (self.turn.sin_cos(), self.tilt.sin_cos());
        let (right, back) = (c * x - s * y, s * x + c * y);
        [right, -ct * z - st * back, st * z - ct * back]
    }

    /// The place of a point, in pixels, and how near it is.
    pub(super) fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let [right, down, near] = self.turned(std::array::from_fn(|k| point[k] - self.middle[k]));
        [self.size[0] / 2.0 + self.scale * right, self.size[1] / 2.0 + self.scale * down, near]
    }
}

/// The outline of an ellipsoid with these half axes in the picture's axes: its half axes in pixels, and the angle of the first in degrees.
///
/// A sphere becomes the ellipsoid by the matrix A of its half axes. Its projection P A maps the unit sphere to an ellipse whose half axes are the
/// singular values of P A: the square roots of the eigenvalues of P A Aᵀ Pᵀ, which is 2 × 2.
pub(super) fn ellipse(axes: [[f64; 3]; 3], scale: f64) -> [f64; 3] {
    let sum = |i: usize, j: usize| axes.iter().map(|axis| axis[i] * axis[j]).sum::<f64>();
    let (xx, xy, yy) = (sum(0, 0), sum(0, 1), sum(1, 1));
    let (mean, half) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
    let root = |square: f64| larger(square, 0.0).sqrt() * scale;
    [root(mean + half), root(mean - half), 0.5 * (2.0 * xy).atan2(xx - yy).to_degrees()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_of_spheres_and_rods() {
        let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let [a, b, _] = ellipse([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]], 10.0);
        assert!(close(a, 20.0) && close(b, 20.0), "a sphere is a circle from every side");
        let [a, b, angle] = ellipse([[1.0, 1.0, 0.0], [0.0; 3], [0.0, 0.0, 7.0]], 1.0);
        assert!(close(a, 2.0_f64.sqrt()) && close(b, 0.0) && close(angle, 45.0), "a rod across the diagonal; its depth is not seen");
    }

    #[test]
    fn a_turn_keeps_lengths_and_all_is_inside() {
        let body = |x: f64| DrawnBody {
            name: "b".into(),
            parent: None,
            mass: 1.0,
            origin: [x, 0.0, 1.0],
            centre: [x, 0.5, 2.0],
            axes: [[0.3, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]],
        };
        let bodies = [body(0.0), body(3.0)];
        let view = View::of(&bodies, [460.0, 360.0], 26.0);
        for vector in [[1.0, 2.0, 3.0], [0.0, 0.0, 1.0], [-1.0, 0.5, 0.0]] {
            let length = |x: [f64; 3]| x.iter().map(|x| x * x).sum::<f64>();
            assert!((length(view.turned(vector)) - length(vector)).abs() < 1e-12, "{vector:?}: three roundings of numbers below 14");
        }
        for body in &bodies {
            let [x, y, _] = view.place(body.centre);
            assert!((26.0..434.0).contains(&x) && (26.0..334.0).contains(&y), "{x} {y}");
        }
        assert!(view.place([0.0, 0.0, 1.0])[1] < view.place([0.0, 0.0, 0.0])[1], "z is upwards");
    }
}
