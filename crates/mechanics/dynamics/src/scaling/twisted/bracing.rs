//! The elimination of one body and its joint from the base side: the six steps and the release of `twisted.rs`.
//!
//! Frames: those of the body that is added, at the point where its Φ is wanted. Shapes: 6×6 and 6, the angular part first. Units: SI.
//! Cost: O(1). Nothing here allocates.

use featherbench_spatial::{ArticulatedInertia, CentralInertia, Force, Mat3, Motion, Real, Sym3, Transform, Vec3};
use std::array::from_fn;

/// The elimination of one body and its joint.
pub(super) struct Bracing<T> {
    /// Φ below its diagonal and on it; the angular part first.
    phi: [[T; 6]; 6],
    pub(super) b: [T; 6],
    s: [T; 6],
    pub(super) d: T,
    u: T,
}

impl<T: Real> Bracing<T> {
    /// Before the body is added. `x` is its placement in the body before, whose Φ and b are given.
    #[inline(always)]
    pub(super) fn new(
        flexibility: ArticulatedInertia<T>,
        x: &Transform<T>,
        free: Motion<T>,
        c: Motion<T>,
        subspace: Motion<T>,
        armature: T,
        tau: T,
    ) -> Self {
        // Φ' = X Φ Xᵀ
        let ArticulatedInertia { rotational: l, coupling: h, translational: a } =
            flexibility.translate(-x.translation).rotate(x.rotation.transpose());
        let zero = T::zero();
        let phi = [
            [a.xx, zero, zero, zero, zero, zero],
            [a.xy, a.yy, zero, zero, zero, zero],
            [a.xz, a.yz, a.zz, zero, zero, zero],
            [h.x.x, h.x.y, h.x.z, l.xx, zero, zero],
            [h.y.x, h.y.y, h.y.z, l.xy, l.yy, zero],
            [h.z.x, h.z.y, h.z.z, l.xz, l.yz, l.zz],
        ];
        let b = x.inverse_motion(free) + c;
        Self { phi, b: b.to_array(), s: subspace.to_array(), d: armature, u: tau }
    }

    /// Column i of Φ.
    #[inline(always)]
    fn column(&self, i: usize) -> [T; 6] {
        from_fn(|j| if j < i { self.phi[i][j] } else { self.phi[j][i] })
    }

    /// A rigid body at its centre of mass: `d = m` along the axes, and `L D Lᵀ` of the rotational inertia.
    #[inline(always)]
    pub(super) fn add_body(&mut self, inertia: &CentralInertia<T>, p: Force<T>) {
        for (k, offset) in p.lin.to_array().into_iter().enumerate() {
            self.add_along_axis(3 + k, inertia.mass, offset);
        }
        let i = inertia.rotational;
        // A body without inertia about an axis has none off that axis: zero takes the place of 0/0.
        let inverse = i.xx.reciprocal_or_zero();
        let (l21, l31) = (i.xy * inverse, i.xz * inverse);
        let d2 = (-l21).mul_add(i.xy, i.yy);
        let m32 = (-l21).mul_add(i.xz, i.yz);
        let l32 = m32 * d2.reciprocal_or_zero();
        let d3 = (-l32).mul_add(m32, (-l31).mul_add(i.xz, i.zz));
        let o1 = p.ang.x;
        let o2 = (-l21).mul_add(o1, p.ang.y);
        let o3 = (-l32).mul_add(o2, (-l31).mul_add(o1, p.ang.z));

        self.add_along_axis(2, d3, o3);
        let (y, z) = (self.column(1), self.column(2));
        let column = from_fn(|j| l32.mul_add(z[j], y[j]));
        self.add(column, |x| l32.mul_add(x[2], x[1]), d2, o2, None);
        let (x, y, z) = (self.column(0), self.column(1), self.column(2));
        let column = from_fn(|j| l31.mul_add(z[j], l21.mul_add(y[j], x[j])));
        self.add(column, |x| l31.mul_add(x[2], l21.mul_add(x[1], x[0])), i.xx, o1, None);
    }

    /// A body with an articulated-body inertia: `d` and `l` of its `L D Lᵀ`.
    pub(super) fn add_articulated(&mut self, inertia: &ArticulatedInertia<T>, p: Force<T>) {
        let unit = |k: usize| Motion::from_array(from_fn(|i| if i == k { T::one() } else { T::zero() }));
        let mut rest: [[T; 6]; 6] = from_fn(|k| inertia.mul(unit(k)).to_array());
        let mut offset = p.to_array();
        for k in 0..6 {
            let (d, o) = (rest[k][k], offset[k]);
            let inverse = d.reciprocal_or_zero();
            let l: [T; 6] = from_fn(|i| {
                if i < k {
                    T::zero()
                } else if i == k {
                    T::one()
                } else {
                    rest[i][k] * inverse
                }
            });
            let row = rest[k];
            for i in k + 1..6 {
                for (entry, above) in rest[i].iter_mut().zip(&row).skip(k + 1) {
                    *entry = (-l[i]).mul_add(*above, *entry);
                }
                offset[i] = (-l[i]).mul_add(o, offset[i]);
            }
            let dot = |x: &[T; 6]| x.iter().zip(&l).fold(T::zero(), |sum, (x, l)| x.mul_add(*l, sum));
            let column = from_fn(|i| dot(&from_fn(|j| self.phi[i.max(j)][i.min(j)])));
            self.add(column, dot, d, o, None);
        }
    }

    /// One step of the elimination, for `l = e_i`. There what is left of row i is known without a difference: w Φ_i.
    #[inline(always)]
    fn add_along_axis(&mut self, i: usize, d: T, o: T) {
        let column = self.column(i);
        let w = self.add(column, |x| x[i], d, o, Some(i));
        for (j, entry) in column.into_iter().enumerate() {
            self.phi[i.max(j)][i.min(j)] = entry * w;
        }
    }

    /// One step of the elimination. `column` is Φl, and `along` is lᵀ. Row and column `but` of Φ are left to the caller. Returns w.
    #[inline(always)]
    fn add(&mut self, column: [T; 6], along: impl Fn(&[T; 6]) -> T, d: T, o: T, but: Option<usize>) -> T {
        let w = T::one() / along(&column).mul_add(d, T::one());
        let (weight, s_l) = (w * d, along(&self.s));
        let force = weight.mul_add(along(&self.b), w * o);
        let carried = weight * s_l;
        self.d = carried.mul_add(s_l, self.d);
        self.u = (-s_l).mul_add(force, self.u);
        for i in 0..6 {
            self.b[i] = (-force).mul_add(column[i], self.b[i]);
            self.s[i] = (-carried).mul_add(column[i], self.s[i]);
            if but == Some(i) {
                continue;
            }
            let scaled = -(weight * column[i]);
            for j in (0..=i).filter(|j| but != Some(*j)) {
                self.phi[i][j] = scaled.mul_add(column[j], self.phi[i][j]);
            }
        }
        w
    }

    /// Releases the joint: `Φ += s D⁻¹ sᵀ`, `b += s D⁻¹ u`. Returns s D⁻¹ and D⁻¹ u.
    #[inline(always)]
    pub(super) fn release(&mut self) -> (Motion<T>, T) {
        let inverse = T::one() / self.d;
        let (scaled, rate) = (self.s.map(|s| s * inverse), self.u * inverse);
        for (i, scaled) in scaled.into_iter().enumerate() {
            self.b[i] = rate.mul_add(self.s[i], self.b[i]);
            for j in 0..=i {
                self.phi[i][j] = scaled.mul_add(self.s[j], self.phi[i][j]);
            }
        }
        (Motion::from_array(scaled), rate)
    }

    /// Φ as it moves between frames.
    #[inline(always)]
    pub(super) fn flexibility(&self) -> ArticulatedInertia<T> {
        let phi = &self.phi;
        let sym = |k: usize| Sym3 {
            xx: phi[k][k],
            xy: phi[k + 1][k],
            xz: phi[k + 2][k],
            yy: phi[k + 1][k + 1],
            yz: phi[k + 2][k + 1],
            zz: phi[k + 2][k + 2],
        };
        let row = |i: usize| Vec3::new(phi[i][0], phi[i][1], phi[i][2]);
        let coupling = Mat3::from_rows(row(3), row(4), row(5));
        ArticulatedInertia { rotational: sym(3), coupling, translational: sym(0) }
    }
}
