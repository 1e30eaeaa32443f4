//! Known answers of rods: what a discretisation is compared with.
//!
//! | function | what | how |
//! |---|---|---|
//! | [`cantilever_root`] | β of cos β cosh β = −1; ω = β² √(EI/ρA)/L² | Newton |
//! | [`elastica`] | the cantilever with a dead transverse force at its tip | quadrature of the closed first integral |
//! | [`bessel_zero`] | j_{0k}; the hanging string has ω = j_{0k}/2 √(g/L) | series and Newton in double-double |
//! | [`laguerre_zeros`] | roots of L_n; n masses on a hanging string of links ℓ have ω² = (g/ℓ) times them | Newton in double-double |
//! | [`tip_ratio`] | tip deflection of discrete cantilevers over the exact one, small loads | closed form |
//! | [`exact_modes_tip_ratio`] | the same with the first r exact modes | closed form |
//! | [`lumped_axial`] | frequencies of a clamped bar of masses and springs | closed form |
//! | [`links_frequency_prefactor`] | errors of frequencies of links | what links do to the boundary |
//! | [`sections_frequency_prefactor`], [`hermite_frequency_prefactor`] | errors of frequencies | the best approximation |
//! | [`string_frequency_prefactor`] | errors of ω² of a hanging chain of uniform rods | the best approximation |
//! | [`edges_frequency_prefactor`], [`edges_tip_prefactor`] | the same two of nodes with masses | first-order change of energies |
//! | [`links_tip_prefactor`], [`sections_tip_prefactor`] | errors of the elastica's tip | first-order change of the energy |

use crate::Hinges;
use crate::quadrature::composite;
use featherbench_spatial::DoubleDouble;
use nalgebra::{DMatrix, SymmetricEigen};
use std::f64::consts::{FRAC_PI_2, PI};

pub use crate::basis::cantilever_root;

/// The tip of an elastica: the rod's shape under a force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastica {
    /// The tip's deflection along the force, over L.
    pub deflection: f64,
    /// The tip's distance from the wall along the unloaded rod, over L.
    pub reach: f64,
    /// The tip's angle, rad.
    pub angle: f64,
}

/// The cantilever with a dead force P across its unloaded axis at the tip: α = P L²/EI > 0.
///
/// From EI θ'' = −P cos θ, with k² = (1 + sin θ_L)/2 and sin θ = 2 k² sin² φ − 1: `√α = ∫ dφ/√(1 − k² sin² φ)` from sin φ₁ = 1/(k √2) to
/// π/2. The same integral of sin θ is √α δ/L. The reach is x/L = √(2 sin θ_L/α). Bisection finds θ_L. The integrals are Gauss sums of 16
/// parts with 16 points. NaN for α that is not positive.
pub fn elastica(alpha: f64) -> Elastica {
    solved(alpha).0
}

/// The elastica, and ∫ cos² θ over its length, over L.
fn solved(alpha: f64) -> (Elastica, f64) {
    if !(alpha > 0.0 && alpha.is_finite()) {
        return (Elastica { deflection: f64::NAN, reach: f64::NAN, angle: f64::NAN }, f64::NAN);
    }
    let rule = composite(16, 16);
    let integrals = |angle: f64| {
        let square = 0.5 * (1.0 + angle.sin());
        let first = (0.5 / square).sqrt().min(1.0).asin();
        let width = FRAC_PI_2 - first;
        let sum = |term: &dyn Fn(f64) -> f64| {
            let part = |(x, w): &(f64, f64)| {
                let sine = (first + width * x).sin().powi(2) * square;
                w * width * term(2.0 * sine - 1.0) / (1.0 - sine).sqrt()
            };
            rule.iter().map(part).sum::<f64>()
        };
        (sum(&|_| 1.0), sum(&|sin_theta| sin_theta), sum(&|sin_theta| 1.0 - sin_theta * sin_theta))
    };
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    // 60 halvings leave an interval of two neighbouring numbers.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if integrals(middle).0 < alpha.sqrt() { low = middle } else { high = middle }
    }
    let (length, deflection, squares) = integrals(low);
    (Elastica { deflection: deflection / length, reach: (2.0 * low.sin() / alpha).sqrt(), angle: low }, squares / length)
}

/// The prefactor c of the tip's deflection of an elastica of `n` rigid links: deflection/exact − 1 → c/n^p, p = 1 for [`Hinges::Start`] and 2
/// else.
///
/// Let Π(α) be the least energy, EI = L = 1. Then dΠ/dα = −δ. Links have Π + h^p Π₁ + …, and Π₁ is the change of the energy at the elastica
/// itself, as Π is stationary there. So c = −(dΠ₁/dα)/δ. Springs have ½ ∫ θ'² − h²/24 ∫ θ''² with θ'' = −α cos θ. The load's work is that of
/// a sum over links, by Euler and Maclaurin, with θ'(0) = α times the reach:
///
/// | hinges | Π₁ |
/// |---|---|
/// | start | −α sin θ_L/2 |
/// | start, 2EI/h at the clamp | −α² ∫ cos² θ/24 − α θ'(0)/24 |
/// | middle | −α² ∫ cos² θ/24 + α θ'(0)/12 |
///
/// NaN for α that is not positive.
pub fn links_tip_prefactor(hinges: Hinges, alpha: f64) -> f64 {
    tip_prefactor(alpha, |alpha, elastica, squares| match hinges {
        Hinges::Start => -0.5 * alpha * elastica.angle.sin(),
        Hinges::StartStiffWall => -alpha * alpha * (squares + elastica.reach) / 24.0,
        Hinges::Middle => alpha * alpha * (2.0 * elastica.reach - squares) / 24.0,
    })
}

/// The same with sections of constant curvature, p = 2: θ is piecewise linear, and the best of them has the energy Π + h²/24 ∫ θ''².
pub fn sections_tip_prefactor(alpha: f64) -> f64 {
    tip_prefactor(alpha, |alpha, _, squares| alpha * alpha * squares / 24.0)
}

/// The same with a flex of edges, p = 2: nodes with masses, and hinges of the energy EI (2 tan(φ/2))²/2l, as in discrete elastic rods;
/// 2EI/h at the clamp. It is that of [`Hinges::StartStiffWall`] with h²/12 ∫ θ'⁴ more, where θ'² = 2α (sin θ_L − sin θ).
///
/// At α = 10 both parts nearly cancel: −0.069 of 0.553 and −0.622. There the term of n⁻³ is larger up to some hundred edges.
pub fn edges_tip_prefactor(alpha: f64) -> f64 {
    tip_prefactor(alpha, |alpha, elastica, squares| {
        let sine = elastica.angle.sin();
        let fourth = 4.0 * (sine * sine - 2.0 * sine * elastica.deflection + 1.0 - squares);
        alpha * alpha * (fourth / 12.0 - (squares + elastica.reach) / 24.0)
    })
}

/// −(dΠ₁/dα)/δ by central differences of Π₁(α, elastica, ∫ cos² θ) with two steps, extrapolated: an error of 10⁻¹¹, roundings of ε/10⁻³.
fn tip_prefactor(alpha: f64, energy: impl Fn(f64, Elastica, f64) -> f64) -> f64 {
    let at = |alpha: f64| {
        let (elastica, squares) = solved(alpha);
        energy(alpha, elastica, squares)
    };
    let slope = |step: f64| (at(alpha * (1.0 + step)) - at(alpha * (1.0 - step))) / (2.0 * step * alpha);
    -(4.0 * slope(1e-3) - slope(2e-3)) / (3.0 * elastica(alpha).deflection)
}

fn wide(x: f64) -> DoubleDouble {
    DoubleDouble::from(x)
}

/// Root number `k`, from 0, of the Bessel function J₀; for k up to 12, beyond which the series loses its digits (the error grows like e^{2k
/// π}/10³²).
pub fn bessel_zero(k: usize) -> f64 {
    bessel(k).0
}

/// Root number `k` of J₀, and J₀' = −J₁ there.
fn bessel(k: usize) -> (f64, f64) {
    let guess = (k as f64 + 0.75) * PI;
    let (mut x, mut at) = (wide(guess + 1.0 / (8.0 * guess)), wide(0.0));
    for _ in 0..6 {
        // J₀ = Σ (−x²/4)^m / m!²,  J₀' = −J₁ = Σ 2m/x (…)
        let (quarter, mut term, mut value, mut slope) = (x * x * wide(-0.25), wide(1.0), wide(1.0), wide(0.0));
        for m in 1..=(20 + 8 * k.max(2)) {
            let m = m as f64;
            term = term * quarter / wide(m * m);
            value += term;
            slope += term * wide(2.0 * m) / x;
        }
        x -= value / slope;
        at = slope;
    }
    (x.to_f64(), at.to_f64())
}

/// The prefactor of the error of ω² of mode `k`, from 0, of a hanging chain of uniform rods: ω²/ω²_exact − 1 → this/n².
///
/// Rods have the energies of a string that is piecewise linear, which is Galerkin's method. So the error is that of the best approximation:
/// h²/12 ∫ g s w''² for ∫ w² = 1, s the distance from the free end and w = J₀(j √s)/J₁(j). With λ = j²/4 = ω², the equation s w'' = −w' − λ w, and
/// ∫ J₁²/x = (1 − J₀² − J₁²)/2, it is λ/24J₁² − λ/12 − 1/24.
pub fn string_frequency_prefactor(k: usize) -> f64 {
    let (root, slope) = bessel(k);
    let square = 0.25 * root * root;
    (square / (slope * slope) - 2.0 * square - 1.0) / 24.0
}

/// The roots of the Laguerre polynomial L_n, increasing.
///
/// The guesses are eigenvalues of the Jacobi matrix, with 2i + 1 on the diagonal and i beside it. Newton's steps are in double-double.
pub fn laguerre_zeros(n: usize) -> Vec<f64> {
    let jacobi = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => (2 * i + 1) as f64,
        1 => i.max(j) as f64,
        _ => 0.0,
    });
    let mut roots: Vec<f64> = SymmetricEigen::new(jacobi).eigenvalues.iter().copied().collect();
    roots.sort_by(f64::total_cmp);
    for root in &mut roots {
        let mut x = wide(*root);
        for _ in 0..3 {
            // (k + 1) L_{k+1} = (2k + 1 − x) L_k − k L_{k−1};  x L_n' = n (L_n − L_{n−1})
            let (mut before, mut value) = (wide(0.0), wide(1.0));
            for k in 0..n {
                let k = k as f64;
                (before, value) = (value, ((wide(2.0 * k + 1.0) - x) * value - wide(k) * before) / wide(k + 1.0));
            }
            x = x - value * x / (wide(n as f64) * (value - before));
        }
        *root = x.to_f64();
    }
    roots
}

/// The small deflection under a tip force of a cantilever of `n` rigid links over the exact one, P L³/3EI.
///
/// With constant-strain sections it is that of [`Hinges::Middle`]: both are the midpoint rule of ∫ M²/EI.
pub fn tip_ratio(hinges: Hinges, n: usize) -> f64 {
    let n = n as f64;
    match hinges {
        Hinges::Start => 1.0 + 1.5 / n + 0.5 / (n * n),
        Hinges::StartStiffWall => 1.0 + 0.5 / (n * n),
        Hinges::Middle => 1.0 - 0.25 / (n * n),
    }
}

/// The small deflection under a tip force by the first `r` exact modes over the exact one: 12 Σ 1/β⁴, since φ(1)² = 4.
pub fn exact_modes_tip_ratio(r: usize) -> f64 {
    (0..r).map(|k| 12.0 / cantilever_root(k).powi(4)).sum()
}

/// Frequency number `k`, from 0, of a clamped bar of `n` elements of mass ρAh, half of it at each end, with springs EA/h; c = √(E/ρ).
///
/// ω = (2c/h) sin((2k + 1) π/4n); the exact one is (2k + 1) π c/2L.
pub fn lumped_axial(n: usize, k: usize, speed: f64, length: f64) -> f64 {
    let n = n as f64;
    2.0 * speed * n / length * ((2 * k + 1) as f64 * PI / (4.0 * n)).sin()
}

/// Of mode `k`, from 0: σ β of the cantilever, σ = (cosh β + cos β)/(sinh β + sin β).
fn sigma_beta(k: usize) -> f64 {
    let beta = cantilever_root(k);
    beta * (beta.cosh() + beta.cos()) / (beta.sinh() + beta.sin())
}

/// The prefactor c of the frequency error of mode `k`, from 0, of rigid links: ω/ω_exact − 1 → c/n^p, p = 1 for [`Hinges::Start`] and 2 else.
///
/// Inside the rod, links have M and K with the same factor 1 + h²/6 ∂², which cancels. At the clamp they have y(0) = −h²/8 w'' and
/// y'(0) = −h²/24 w''' (middle), y'(0) = h/2 w'' (start) or −h²/6 w''' (2EI/h). Green's identity gives δλ = w'''(0) y(0) − w''(0) y'(0), where
/// w''(0) w'''(0) = −4σβ⁵ for ∫ w² = 1. So c = σβ/6, −1 and −σβ/3.
pub fn links_frequency_prefactor(hinges: Hinges, k: usize) -> f64 {
    match hinges {
        Hinges::Start => -1.0,
        Hinges::StartStiffWall => -sigma_beta(k) / 3.0,
        Hinges::Middle => sigma_beta(k) / 6.0,
    }
}

/// The prefactor of the frequency error of mode `k`, from 0, with sections of constant curvature: ω/ω_exact − 1 → this/n².
///
/// Galerkin's error is that of the best approximation: of w'' by constants it is h²/12 ∫ w'''², and ∫ w'''² = β⁴ ∫ w'² for a cantilever,
/// with ∫ w'² = σβ (2 + σβ) and ∫ w''² = β⁴. Half of it is the error of ω: σβ (2 + σβ)/24.
pub fn sections_frequency_prefactor(k: usize) -> f64 {
    let x = sigma_beta(k);
    x * (2.0 + x) / 24.0
}

/// The same with cubic Hermite splines: ω/ω_exact − 1 → this/n⁴. The best approximation of w'' by linear functions leaves h⁴/720 ∫ w⁗², and
/// ∫ w⁗² = β⁴ ∫ w''²: β⁴/1440.
pub fn hermite_frequency_prefactor(k: usize) -> f64 {
    cantilever_root(k).powi(4) / 1440.0
}

/// The same with a flex of edges, of nodes with masses, and 2EI/h at the clamp: ω/ω_exact − 1 → this/n².
///
/// On the exact mode w with ∫ w² = 1 the elastic energy is h²/12 ∫ w'''² less, where ∫ w'''² = β⁴ σβ (2 + σβ). Twice the kinetic energy is
/// h²/6 w(1) w'(1) = h²/6·4σβ more. So c = −σβ (6 + σβ)/12.
pub fn edges_frequency_prefactor(k: usize) -> f64 {
    let x = sigma_beta(k);
    -x * (6.0 + x) / 12.0
}
