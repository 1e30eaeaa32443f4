//! Rigid-body and articulated-body inertias.

use crate::operators::operators;
use crate::{Force, Lift, Mat3, Motion, Real, Sym3, Transform, Vec3};
use std::ops::{Add, AddAssign};

/// The inertia of a rigid body at a frame's origin: ten numbers (the book, equation 2.63 and section A.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBodyInertia<T> {
    /// Mass, kg.
    pub mass: T,
    /// First moment of mass `m·c`, kg·m.
    pub first_moment: Vec3<T>,
    /// Rotational inertia about the frame's *origin*, kg·m².
    pub rotational: Sym3<T>,
}

impl<T: Real> RigidBodyInertia<T> {
    /// A body of no mass.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn zero() -> Self {
        Self { mass: T::zero(), first_moment: Vec3::zero(), rotational: Sym3::zero() }
    }

    /// From mass, centre of mass and rotational inertia about the centre of mass.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn from_com(mass: T, com: Vec3<T>, about_com: Sym3<T>) -> Self {
        Self { mass, first_moment: com * mass, rotational: about_com + Sym3::point_mass(mass, com) }
    }

    /// The centre of mass; not finite when the mass is zero.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn com(&self) -> Vec3<T> {
        Vec3::new(self.first_moment.x / self.mass, self.first_moment.y / self.mass, self.first_moment.z / self.mass)
    }

    /// `I v`: the momentum of a velocity, the force of an acceleration.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn mul(&self, v: Motion<T>) -> Force<T> {
        let h = self.first_moment;
        // n = Ī ω + h × v,  f = m v − h × ω
        Force::new(h.cross_add(v.lin, self.rotational * v.ang), v.lin.scale_add(self.mass, v.ang.cross(h)))
    }

    /// The same inertia at the parent's origin in parent coordinates, `X* I X⁻¹`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_parent(&self, x: &Transform<T>) -> Self {
        let r = x.translation;
        let h = x.rotation * self.first_moment;
        let moved = r.scale_add(self.mass, h);
        // Ī' = R Ī Rᵀ − r×h× − (h + m r)×r×
        let (a, b) = (h, moved);
        let rotational = self.rotational.rotate(x.rotation) + Sym3::minus_cross_cross(a, r) + Sym3::minus_cross_cross(r, b);
        Self { mass: self.mass, first_moment: moved, rotational }
    }

    /// About the centre of mass, which of a body without mass is the origin.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn central(&self) -> CentralInertia<T> {
        let com = self.first_moment * self.mass.reciprocal_or_zero();
        CentralInertia { mass: self.mass, com, rotational: self.rotational - Sym3::minus_cross_cross(com, self.first_moment) }
    }

    /// As an articulated-body inertia.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_articulated(&self) -> ArticulatedInertia<T> {
        ArticulatedInertia { rotational: self.rotational, coupling: Mat3::skew(self.first_moment), translational: Sym3::scalar(self.mass) }
    }

    /// The parameter inertia in another scalar.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lift<S>(self) -> RigidBodyInertia<S>
    where
        T: Lift<S>,
    {
        RigidBodyInertia { mass: self.mass.lift(), first_moment: self.first_moment.lift(), rotational: self.rotational.lift() }
    }
}

/// The inertia of a rigid body about its centre of mass, in the axes of a frame.
///
/// It keeps digits that an inertia at the origin loses. Far from the origin, that is m·c² and a little. The little may be all that an axis
/// through the centre of mass feels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentralInertia<T> {
    /// Mass, kg.
    pub mass: T,
    /// Centre of mass, m.
    pub com: Vec3<T>,
    /// Rotational inertia about the centre of mass, kg·m².
    pub rotational: Sym3<T>,
}

impl<T: Real> CentralInertia<T> {
    /// A body of no mass.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn zero() -> Self {
        Self { mass: T::zero(), com: Vec3::zero(), rotational: Sym3::zero() }
    }

    /// `I v`: the momentum of a velocity at the frame's origin.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn mul(&self, v: Motion<T>) -> Force<T> {
        // f = m (v + ω × c),  n = I ω + c × f
        let f = v.ang.cross_add(self.com, v.lin) * self.mass;
        Force::new(self.com.cross_add(f, self.rotational * v.ang), f)
    }

    /// The same inertia in the parent's coordinates.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_parent(&self, x: &Transform<T>) -> Self {
        Self { mass: self.mass, com: x.point(self.com), rotational: self.rotational.rotate(x.rotation) }
    }
}

impl<T: Real> AddAssign for CentralInertia<T> {
    /// Joins the bodies. Of two bodies without mass the first keeps its centre.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add_assign(&mut self, other: Self) {
        let mass = self.mass + other.mass;
        let share = other.mass * mass.reciprocal_or_zero();
        let apart = other.com - self.com;
        self.rotational = self.rotational + other.rotational + Sym3::point_mass(share * self.mass, apart);
        self.com = apart.scale_add(share, self.com);
        self.mass = mass;
    }
}

operators! {
    #[cfg_attr(not(debug_assertions), inline(always))]
    <T: Real> RigidBodyInertia<T>;
    Add: add(self, other: Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first_moment: self.first_moment + other.first_moment,
            rotational: self.rotational + other.rotational,
        }
    }
    ; AddAssign add_assign +
}

/// An articulated-body inertia `[[I, H], [Hᵀ, M]]`: a symmetric 6×6 matrix from motions to forces (the book, section 7.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArticulatedInertia<T> {
    /// I: moment from angular acceleration.
    pub rotational: Sym3<T>,
    /// H: moment from linear acceleration.
    pub coupling: Mat3<T>,
    /// M: force from linear acceleration.
    pub translational: Sym3<T>,
}

impl<T: Real> ArticulatedInertia<T> {
    /// The zero inertia.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn zero() -> Self {
        Self { rotational: Sym3::zero(), coupling: Mat3::zero(), translational: Sym3::zero() }
    }

    /// `Iᴬ m`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn mul(&self, m: Motion<T>) -> Force<T> {
        Force::new(
            self.coupling.mul_vec_add(m.lin, self.rotational * m.ang),
            self.coupling.transpose_mul(m.ang) + self.translational * m.lin,
        )
    }

    /// `Iᴬ − w U Uᵀ`: the apparent inertia when the motion along S is free. `U = Iᴬ S`, w = 1/D, and `scaled` is w U.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn subtract_rank_one(&self, scaled: Force<T>, u: Force<T>) -> Self {
        let (ang, lin) = (-scaled.ang, -scaled.lin);
        let coupling = Mat3::from_rows(
            u.lin.scale_add(ang.x, self.coupling.x),
            u.lin.scale_add(ang.y, self.coupling.y),
            u.lin.scale_add(ang.z, self.coupling.z),
        );
        Self { rotational: self.rotational.add_outer(ang, u.ang), coupling, translational: self.translational.add_outer(lin, u.lin) }
    }

    /// The same inertia at the parent's origin in parent coordinates, `X* Iᴬ X⁻¹`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_parent(&self, x: &Transform<T>) -> Self {
        self.rotate(x.rotation).translate(x.translation)
    }

    /// The same inertia at the same origin, in the axes to which `r` transforms.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn rotate(&self, r: Mat3<T>) -> Self {
        Self {
            rotational: self.rotational.rotate(r),
            coupling: (r * (r * self.coupling).transpose()).transpose(),
            translational: self.translational.rotate(r),
        }
    }

    /// The same inertia in the same axes, at an origin from which its own is displaced by `p`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn translate(&self, p: Vec3<T>) -> Self {
        // M' = M,  H' = H + p× M; column i of p× M is p × (row i of M)
        let (i, a, m) = (self.rotational, self.coupling, self.translational);
        let at = a.transpose();
        let h = Mat3::from_rows(
            p.cross_add(Vec3::new(m.xx, m.xy, m.xz), at.x),
            p.cross_add(Vec3::new(m.xy, m.yy, m.yz), at.y),
            p.cross_add(Vec3::new(m.xz, m.yz, m.zz), at.z),
        )
        .transpose();
        // I' = I − H p× + p× H'ᵀ; row i of −H p× is p × (row i of H), column i of p× H'ᵀ is p × (row i of H')
        let cross_x = |v: Vec3<T>, addend: T| p.y.mul_add(v.z, (-p.z).mul_add(v.y, addend));
        let cross_y = |v: Vec3<T>, addend: T| p.z.mul_add(v.x, (-p.x).mul_add(v.z, addend));
        let cross_z = |v: Vec3<T>, addend: T| p.x.mul_add(v.y, (-p.y).mul_add(v.x, addend));
        let rotational = Sym3 {
            xx: cross_x(h.x, cross_x(a.x, i.xx)),
            xy: cross_x(h.y, cross_y(a.x, i.xy)),
            xz: cross_x(h.z, cross_z(a.x, i.xz)),
            yy: cross_y(h.y, cross_y(a.y, i.yy)),
            yz: cross_y(h.z, cross_z(a.y, i.yz)),
            zz: cross_z(h.z, cross_z(a.z, i.zz)),
        };
        Self { rotational, coupling: h, translational: m }
    }
}

operators! {
    #[cfg_attr(not(debug_assertions), inline(always))]
    <T: Real> ArticulatedInertia<T>;
    Add: add(self, other: Self) -> Self {
        Self {
            rotational: self.rotational + other.rotational,
            coupling: self.coupling + other.coupling,
            translational: self.translational + other.translational,
        }
    }
    ; AddAssign add_assign +
}
