//! Laws of contact models that are not the rigid one: what they do where the rigid answer is known.

/// Friction that a body feels along its way over that of the round cone, where the force is not opposed to the slip v but along K⁻¹ v.
///
/// A sweep leaves such a force if it solves both tangential rows at once and shortens the result to μN. K is the tangential block of the
/// inverse mass that the contact sees:
///
/// ```text
/// K = 1/m + Σ (r × e_i)·(r × e_j)/I,    felt = mean over the contacts of v·K⁻¹v / (|v| |K⁻¹v|)
/// ```
///
/// `arms` go from the centre of mass to the contacts, m, with z along the normal; the body has the mass `mass`, kg, and the moment `moment` about all
/// axes, kg m². The answer is of contacts that all have the same share or the same load, and of a body that does not turn.
pub fn block_step_felt(heading: f64, arms: &[[f64; 3]], mass: f64, moment: f64) -> f64 {
    let (sine, cosine) = heading.sin_cos();
    let share = |[x, y, z]: &[f64; 3]| {
        let (xx, yy, xy) = (1.0 / mass + (y * y + z * z) / moment, 1.0 / mass + (x * x + z * z) / moment, -x * y / moment);
        // K⁻¹ v up to a positive factor.
        let (along_x, along_y) = (yy * cosine - xy * sine, xx * sine - xy * cosine);
        (along_x * cosine + along_y * sine) / along_x.hypot(along_y)
    };
    arms.iter().map(share).sum::<f64>() / arms.len() as f64
}

/// A soft contact in MuJoCo's model, as its documentation states it: a spring-damper reference acceleration and a regularisation R.
///
/// ```text
/// a_ref = −b v − k r,   b = 2/(d_max T),   k = 1/(d_max² T² ζ²)
/// R = (1 − d)/d · Â,     Â = inverse mass that the contact sees,   d(r) from d_0 to d_max over the width
/// at rest:    (1 − d)/d Â N = k |r|
/// creeping:   (1 − d)/d Â F = b v · impratio
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftContact {
    /// T, s: `solref[0]`.
    pub time: f64,
    /// ζ: `solref[1]`.
    pub damping: f64,
    /// d_0, d_max, width (m): `solimp[0..3]`; midpoint ½ and power 2.
    pub impedance: [f64; 3],
    /// `impratio`.
    pub ratio: f64,
}

impl Default for SoftContact {
    /// MuJoCo's defaults.
    fn default() -> Self {
        Self { time: 0.02, damping: 1.0, impedance: [0.9, 0.95, 1e-3], ratio: 1.0 }
    }
}

impl SoftContact {
    /// d at a penetration r, m.
    pub fn impedance_at(&self, penetration: f64) -> f64 {
        let [low, high, width] = self.impedance;
        let x = (penetration.abs() / width).min(1.0);
        let share = if x <= 0.5 { 2.0 * x * x } else { 1.0 - 2.0 * (1.0 - x) * (1.0 - x) };
        low + share * (high - low)
    }

    /// The penetration at rest under a normal force N on a contact of inverse mass Â: the root of (1 − d)/d Â N = k r, m.
    pub fn penetration(&self, normal: f64, inverse_mass: f64) -> f64 {
        let k = 1.0 / (self.impedance[1] * self.time * self.damping).powi(2);
        let left = |r: f64| {
            let d = self.impedance_at(r);
            (1.0 - d) / d * inverse_mass * normal - k * r
        };
        // Left falls with r: d rises and k r too.
        let (mut low, mut high) = (0.0, inverse_mass * normal / k);
        for _ in 0..200 {
            let middle = (low + high) / 2.0;
            if left(middle) > 0.0 { low = middle } else { high = middle }
        }
        (low + high) / 2.0
    }

    /// The speed with which a contact creeps that holds a tangential force F under a normal force N, m/s.
    pub fn creep(&self, tangential: f64, normal: f64, inverse_mass: f64) -> f64 {
        let d = self.impedance_at(self.penetration(normal, inverse_mass));
        let b = 2.0 / (self.impedance[1] * self.time);
        (1.0 - d) / d * inverse_mass * tangential / (b * self.ratio)
    }
}
