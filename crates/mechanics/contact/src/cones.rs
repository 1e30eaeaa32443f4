//! The self-dual cone K = {x: ‖x_t‖ ≤ x_n} of one, two or three dimensions: projection, and the maps whose zeros obey the contact laws.
//!
//! A Coulomb contact with coefficients D = diag(μ) has this cone in the axes λ̃_t = D⁻¹ λ_t, c̃_t = D c_t: products λᵀc stay.

/// A block of a 3×3 matrix; unused rows and columns are zero.
pub(crate) type Block = [[f64; 3]; 3];

/// The value of a map of (x, c), and its derivatives with respect to x and c.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Linearized {
    pub value: [f64; 3],
    pub by_impulse: Block,
    pub by_velocity: Block,
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Projects a point onto K.
pub(crate) fn project(x: &mut [f64]) {
    let (normal, tangent) = (x[0], norm(&x[1..]));
    if tangent <= normal {
        return;
    }
    if tangent <= -normal {
        x.fill(0.0);
        return;
    }
    let half = 0.5 * (normal + tangent);
    x[0] = half;
    x[1..].iter_mut().for_each(|t| *t *= half / tangent);
}

/// The derivative of the projection onto K (an element of the generalised one where it has kinks).
fn projection_derivative(x: &[f64]) -> Block {
    let mut block = [[0.0; 3]; 3];
    let (normal, tangent) = (x[0], norm(&x[1..]));
    if tangent <= normal {
        (0..x.len()).for_each(|k| block[k][k] = 1.0);
    } else if tangent > -normal {
        let ratio = normal / tangent;
        block[0][0] = 0.5;
        for k in 1..x.len() {
            let w = x[k] / tangent;
            block[0][k] = 0.5 * w;
            block[k][0] = 0.5 * w;
            for l in 1..x.len() {
                let identity = if k == l { 1.0 + ratio } else { 0.0 };
                block[k][l] = 0.5 * (identity - ratio * w * x[l] / tangent);
            }
        }
    }
    block
}

/// ‖x − P_K(x − c − ‖c_t‖ e_n)‖∞: zero exactly where Coulomb's and Signorini's laws hold.
pub(crate) fn natural(x: &[f64], c: &[f64]) -> f64 {
    let mut moved = [0.0; 3];
    let moved = &mut moved[..x.len()];
    for (k, m) in moved.iter_mut().enumerate() {
        *m = x[k] - c[k];
    }
    moved[0] -= norm(&c[1..]);
    project(moved);
    x.iter().zip(moved).map(|(x, p)| (x - *p).abs()).fold(0.0, featherbench_spatial::larger)
}

/// x − P_K(x − c): zero exactly where K ∋ x ⊥ c ∈ K, the law of the convex relaxation.
pub(crate) fn convex_map(x: &[f64], c: &[f64], step: f64) -> Linearized {
    let mut map = Linearized::default();
    let size = x.len();
    let moved: Vec<f64> = x.iter().zip(c).map(|(x, c)| x - step * c).collect();
    let derivative = projection_derivative(&moved);
    let mut projected = moved;
    project(&mut projected);
    for k in 0..size {
        map.value[k] = x[k] - projected[k];
        for (l, entry) in derivative[k].iter().enumerate().take(size) {
            let identity = if k == l { 1.0 } else { 0.0 };
            map.by_impulse[k][l] = identity - entry;
            map.by_velocity[k][l] = step * entry;
        }
    }
    map
}

/// The function of Alart and Curnier (1991): zero exactly where Coulomb's and Signorini's laws hold.
///
/// Normal: x_n − max(0, x_n − r c_n). Tangential: x_t − P(x_t − r c_t), P onto the disk of the radius max(0, x_n − r c_n).
pub(crate) fn coulomb_map(x: &[f64], c: &[f64], [normal_step, tangent_step]: [f64; 2]) -> Linearized {
    let mut map = Linearized::default();
    let pushed = x[0] - normal_step * c[0];
    let closed = pushed > 0.0;
    let radius = if closed { pushed } else { 0.0 };
    if closed {
        map.value[0] = normal_step * c[0];
        map.by_velocity[0][0] = normal_step;
    } else {
        map.value[0] = x[0];
        map.by_impulse[0][0] = 1.0;
    }
    let moved: Vec<f64> = x[1..].iter().zip(&c[1..]).map(|(x, c)| x - tangent_step * c).collect();
    let length = norm(&moved);
    for k in 1..x.len() {
        if length <= radius {
            map.value[k] = tangent_step * c[k];
            map.by_velocity[k][k] = tangent_step;
            continue;
        }
        let w = moved[k - 1] / length;
        map.value[k] = x[k] - radius * w;
        if closed {
            map.by_impulse[k][0] = -w;
            map.by_velocity[k][0] = normal_step * w;
        }
        for l in 1..x.len() {
            let identity = if k == l { 1.0 } else { 0.0 };
            let turned = radius / length * (identity - w * moved[l - 1] / length);
            map.by_impulse[k][l] = identity - turned;
            map.by_velocity[k][l] = tangent_step * turned;
        }
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_robots::Random;

    /// The derivatives of both maps against central differences, at points where the maps are smooth.
    #[test]
    fn derivatives_are_those_of_differences() {
        let mut random = Random::named(3, "maps");
        let mut cases = 0;
        for _ in 0..300 {
            let size = 1 + random.below(3);
            let draw = |random: &mut Random| -> Vec<f64> { (0..size).map(|_| random.uniform(-1.0, 1.0)).collect() };
            let (x, c) = (draw(&mut random), draw(&mut random));
            for map in [|x: &[f64], c: &[f64]| coulomb_map(x, c, [0.7, 0.6]), |x: &[f64], c: &[f64]| convex_map(x, c, 0.7)] {
                let here = map(&x, &c);
                let step = 1e-6;
                for l in 0..size {
                    let moved =
                        |v: &[f64], by: f64| -> Vec<f64> { v.iter().enumerate().map(|(k, v)| if k == l { v + by } else { *v }).collect() };
                    let by_x = (map(&moved(&x, step), &c), map(&moved(&x, -step), &c));
                    let by_c = (map(&x, &moved(&c, step)), map(&x, &moved(&c, -step)));
                    for k in 0..size {
                        let difference = |(up, down): (Linearized, Linearized)| (up.value[k] - down.value[k]) / (2.0 * step);
                        // Central differences: truncation 1e-12 times third derivatives, rounding 1e-10. A kink within 1e-6 is rarer than 1e-4.
                        assert!((difference(by_x) - here.by_impulse[k][l]).abs() < 1e-7, "{x:?} {c:?} {k} {l}");
                        assert!((difference(by_c) - here.by_velocity[k][l]).abs() < 1e-7, "{x:?} {c:?} {k} {l}");
                        cases += 1;
                    }
                }
            }
        }
        assert!(cases > 1000);
    }

    /// x = P(x) + P(x) of the polar: Moreau's decomposition, with orthogonal parts.
    #[test]
    fn projection_decomposes() {
        let mut random = Random::named(4, "projection");
        for _ in 0..300 {
            let x: Vec<f64> = (0..3).map(|_| random.uniform(-1.0, 1.0)).collect();
            let (mut inside, mut polar) = (x.clone(), x.iter().map(|x| -x).collect::<Vec<_>>());
            project(&mut inside);
            project(&mut polar);
            let product: f64 = inside.iter().zip(&polar).map(|(a, b)| a * b).sum();
            // A few roundings of numbers of size 1.
            assert!(product.abs() < 1e-15);
            assert!(x.iter().zip(inside.iter().zip(&polar)).all(|(x, (a, b))| (x - (a - b)).abs() < 1e-15));
        }
    }
}
