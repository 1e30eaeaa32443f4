//! Prefactors by a second route: chains by transfer from link to link in double-double, their errors extrapolated to n = ∞.
//!
//! A chain's determinant is computed link by link from forces and moments, without any matrix. The error times n^p is extrapolated over
//! doubled n, one power of 1/n after the other.

use crate::beams::{links, sections, tip_under};
use crate::share::one_of;
use crate::wide::{Wide, wide};
use featherbench_continua::Hinges;
use featherbench_continua::known::{
    bessel_zero, cantilever_root, edges_frequency_prefactor, edges_tip_prefactor, elastica, laguerre_zeros, links_frequency_prefactor,
    links_tip_prefactor, sections_tip_prefactor, string_frequency_prefactor,
};
use featherbench_spatial::{Real, larger};

/// A root of f in double-double by the secant rule; the guesses are within 10⁻³ of it and the rule has order 1.6.
fn root(f: impl Fn(Wide) -> Wide, guess: f64) -> Wide {
    let (mut before, mut now) = (wide(guess * (1.0 - 1e-6)), wide(guess));
    let (mut value_before, mut value) = (f(before), f(now));
    for _ in 0..12 {
        let slope = (value - value_before) / (now - before);
        // At the root both values are roundings.
        if (value - value_before).to_f64() == 0.0 {
            break;
        }
        (before, value_before) = (now, value);
        now -= value / slope;
        value = f(now);
    }
    now
}

/// The values at n, 2n, 4n … extrapolated: each power takes its term of the expansion away.
fn extrapolated(mut values: Vec<f64>, powers: &[i32]) -> f64 {
    for power in powers {
        let factor = 2.0_f64.powi(*power);
        values = values.windows(2).map(|pair| (factor * pair[1] - pair[0]) / (factor - 1.0)).collect();
    }
    values[values.len() - 1]
}

/// The determinant of a cantilever of links at ω² = λ, EI = ρA = L = 1. From hinge to hinge with the height w, the angle θ of the link before,
/// the moment M and the shear force V of what is beyond: θ += M/k, V −= λ (l w + l² θ/2), M −= l V + λ (l² w/2 + l³ θ/3), w += l θ. At the
/// end M = V = 0.
fn beam(hinges: Hinges, n: usize, square: Wide) -> Wide {
    let h = wide(1.0) / wide(n as f64);
    let ends = |moment: f64, shear: f64| {
        let (mut w, mut theta, mut m, mut v) = (wide(0.0), wide(0.0), wide(moment), wide(shear));
        for link in 0..n {
            let l = if hinges == Hinges::Middle && link + 1 == n { h * wide(0.5) } else { h };
            // 1/k
            let soft = if hinges == Hinges::StartStiffWall && link == 0 { h * wide(0.5) } else { h };
            theta += m * soft;
            v -= square * (l * w + l * l * theta * wide(0.5));
            m -= l * v + square * l * l * (w * wide(0.5) + l * theta / wide(3.0));
            w += l * theta;
        }
        [m, v]
    };
    let ([a, b], [c, d]) = (ends(1.0, 0.0), ends(0.0, 1.0));
    a * d - b * c
}

#[test]
fn frequency_prefactors_of_links_are_those_of_their_determinants() {
    for k in 0..3 {
        let beta = cantilever_root(k);
        let exact = root(beam_equation, beta);
        for hinges in [Hinges::Start, Hinges::StartStiffWall, Hinges::Middle] {
            let order = if hinges == Hinges::Start { 1 } else { 2 };
            let known = links_frequency_prefactor(hinges, k);
            let scaled = [16_u32, 32, 64, 128, 256].map(|n| {
                let guess = (beta * beta * (1.0 + known / f64::from(n).powi(order))).powi(2);
                let square = root(|square| beam(hinges, n as usize, square), guess);
                let squared = exact * exact * exact * exact;
                // ω/ω_exact − 1 from the ratio of squares r: (r − 1)/(√r + 1)
                let ratio = square / squared;
                ((ratio - wide(1.0)) / (ratio.sqrt() + wide(1.0))).to_f64() * f64::from(n).powi(order)
            });
            let powers: &[i32] = if order == 1 { &[1, 2, 3, 4] } else { &[2, 4, 6, 8] };
            let found = extrapolated(scaled.to_vec(), powers);
            println!("{hinges:?} {k}: {found} {known}");
            // Four terms of the expansion are gone. That of mode 3 is in powers of 7.9/16 at the coarsest.
            assert!((found / known - 1.0).abs() < 1e-6, "{hinges:?} {k}: {found} {known}");
        }
    }
}

/// cos β cosh β + 1 over cosh β, in double-double: e^{−β} by its series.
fn beam_equation(beta: Wide) -> Wide {
    let small = beta * wide(-1.0 / 64.0);
    let mut e = (1..30).rev().fold(wide(1.0), |sum, i| wide(1.0) + small * sum / wide(f64::from(i)));
    (0..6).for_each(|_| e = e * e);
    let (_, cos) = beta.sin_cos();
    cos + e * wide(2.0) / (wide(1.0) + e * e)
}

/// What is left at the top of a hanging chain of uniform rods, from the free end up. Here ω² = λ, g = L = 1 and the total mass is 1. The
/// deflection of a rod's lower end is u. The horizontal force and the weight below it are H and W. Its angle θ is by its moments.
fn string(n: usize, square: Wide) -> Wide {
    let l = wide(1.0) / wide(n as f64);
    let (mut u, mut force, mut weight) = (wide(1.0), wide(0.0), wide(0.0));
    for _ in 0..n {
        let theta = (force + square * l * u * wide(0.5)) / (weight + l * wide(0.5) + square * l * l / wide(6.0));
        force += square * (l * u - l * l * theta * wide(0.5));
        u -= l * theta;
        weight += l;
    }
    u
}

/// The same of a flex of edges: massless edges, masses at the nodes, half of one at the end. w and θ at a node, and M, V of what is beyond it.
fn edges(n: usize, square: Wide) -> Wide {
    let h = wide(1.0) / wide(n as f64);
    let ends = |moment: f64, shear: f64| {
        let (mut w, mut theta, mut m, mut v) = (wide(0.0), wide(0.0), wide(moment), wide(shear));
        for node in 0..n {
            theta += m * if node == 0 { h * wide(0.5) } else { h };
            w += h * theta;
            // V is constant along an edge; the moment of the loads beyond falls by l V.
            m -= h * v;
            v -= square * h * w * wide(if node + 1 == n { 0.5 } else { 1.0 });
        }
        [m, v]
    };
    let ([a, b], [c, d]) = (ends(1.0, 0.0), ends(0.0, 1.0));
    a * d - b * c
}

#[test]
fn frequency_prefactors_of_edges_are_those_of_their_determinant() {
    for k in 0..3 {
        let beta = cantilever_root(k);
        let (exact, known) = (root(beam_equation, beta), edges_frequency_prefactor(k));
        let scaled = [32_u32, 64, 128, 256].map(|n| {
            let squares = f64::from(n).powi(2);
            let square = root(|square| edges(n as usize, square), (beta * beta * (1.0 + known / squares)).powi(2));
            let ratio = square / (exact * exact * exact * exact);
            ((ratio - wide(1.0)) / (ratio.sqrt() + wide(1.0))).to_f64() * squares
        });
        let found = extrapolated(scaled.to_vec(), &[2, 4, 6]);
        assert!((found / known - 1.0).abs() < 1e-6, "{k}: {found} {known}");
    }
}

/// The tip's deflection of a flex of edges in equilibrium, from its energy Σ 2 tan²(φ/2)/l − α Σ h sin θ by Newton's method with load steps.
/// The tangent has three diagonals, and two of them are equal: it is eliminated from the tip to the wall.
fn edges_tip(n: usize, alpha: f64) -> f64 {
    let h = 1.0 / n as f64;
    let mut theta = vec![0.0_f64; n];
    for load in (1..=20).map(|step| alpha * f64::from(step) / 20.0) {
        for _ in 0..30 {
            let mut force: Vec<f64> = theta.iter().map(|angle| load * h * angle.cos()).collect();
            let mut diagonal: Vec<f64> = theta.iter().map(|angle| load * h * angle.sin()).collect();
            let mut beside = vec![0.0; n];
            for i in 0..n {
                let (stiffness, before) = if i == 0 { (2.0 / h, 0.0) } else { (1.0 / h, theta[i - 1]) };
                let half = (0.5 * (theta[i] - before)).tan();
                // d/dφ 2 tan²(φ/2) = 2 tan(φ/2) (1 + tan²(φ/2)), and once more.
                let secant = 1.0 + half * half;
                let (moment, slope) = (stiffness * 2.0 * half * secant, stiffness * secant * (1.0 + 3.0 * half * half));
                force[i] -= moment;
                diagonal[i] += slope;
                if i > 0 {
                    force[i - 1] += moment;
                    diagonal[i - 1] += slope;
                    beside[i] = -slope;
                }
            }
            for i in (1..n).rev() {
                let factor = beside[i] / diagonal[i];
                diagonal[i - 1] -= factor * beside[i];
                force[i - 1] -= factor * force[i];
            }
            let (mut step, mut largest) = (0.0, 0.0_f64);
            for i in 0..n {
                step = (force[i] - beside[i] * step) / diagonal[i];
                theta[i] += step;
                largest = larger(largest, step.abs());
            }
            if largest < 1e-14 {
                break;
            }
        }
    }
    theta.iter().map(|angle| h * angle.sin()).sum()
}

#[test]
fn prefactors_of_strings_are_those_of_their_chains() {
    for k in 0..3 {
        let exact = 0.25 * bessel_zero(k).powi(2);
        let known = string_frequency_prefactor(k);
        let scaled = [64_u32, 128, 256, 512, 1024].map(|n| {
            let squares = f64::from(n).powi(2);
            let square = root(|square| string(n as usize, square), exact * (1.0 + known / squares)).to_f64();
            (square / exact - 1.0) * squares
        });
        let found = extrapolated(scaled.to_vec(), &[1, 2]);
        println!("{k}: {scaled:?} {found} {known}");
        assert!((found / known - 1.0).abs() < 1e-4, "{k}: {found} {known}");
        // End masses: n zeros of L_n, −1/2n.
        let masses = [16_u32, 32, 64, 128].map(|n| (f64::from(n) * laguerre_zeros(n as usize)[k] / exact - 1.0) * f64::from(n));
        let found = extrapolated(masses.to_vec(), &[1, 2, 3]);
        assert!((found / -0.5 - 1.0).abs() < 1e-4, "{k}: {found}");
    }
}

#[test]
fn tip_prefactors_are_those_of_equilibria() {
    for alpha in [0.1, 1.0, 10.0].into_iter().step_by(one_of(2)) {
        let exact = elastica(alpha).deflection;
        let found = |known: f64, order: i32, tip: &dyn Fn(usize) -> f64| {
            let scaled = [16, 32, 64].map(|n| (tip(n) / exact - 1.0) * (n as f64).powi(order));
            let found = extrapolated(scaled.to_vec(), if order == 1 { &[1, 2] } else { &[2, 4] });
            println!("α = {alpha}: {found} {known}");
            assert!((found / known - 1.0).abs() < 1e-3, "{alpha}: {found} {known}");
        };
        for hinges in [Hinges::Start, Hinges::StartStiffWall, Hinges::Middle] {
            let order = if hinges == Hinges::Start { 1 } else { 2 };
            found(links_tip_prefactor(hinges, alpha), order, &|n| tip_under(&links(n, hinges), alpha)[1]);
        }
        found(sections_tip_prefactor(alpha), 2, &|n| tip_under(&sections(n), alpha)[1]);
    }
    for alpha in [0.1, 1.0, 10.0] {
        let (exact, known) = (elastica(alpha).deflection, edges_tip_prefactor(alpha));
        let scaled = [64, 128, 256].map(|n| (edges_tip(n, alpha) / exact - 1.0) * (n * n) as f64);
        let found = extrapolated(scaled.to_vec(), &[1, 2]);
        // Beside the larger of the two parts that it is a difference of.
        assert!((found - known).abs() < 1e-3, "{alpha}: {found} {known}");
    }
    // Small loads have the closed law of the quadrature.
    for (hinges, known) in [(Hinges::Start, 1.5), (Hinges::StartStiffWall, 0.5), (Hinges::Middle, -0.25)] {
        assert!((links_tip_prefactor(hinges, 1e-3) / known - 1.0).abs() < 1e-5, "{hinges:?}");
    }
    assert!((sections_tip_prefactor(1e-3) / -0.25 - 1.0).abs() < 1e-5);
    assert!(links_tip_prefactor(Hinges::Start, f64::NAN).is_nan() && sections_tip_prefactor(-1.0).is_nan());
}
