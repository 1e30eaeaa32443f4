//! Dense output of a step: the polynomial of degree 5 through the states and the rates at its beginning, middle and end.
//!
//! With s = (t − t₀)/h, Newton's form on the nodes 0, 0, ½, ½, 1, 1. Its error is s²(s − ½)²(s − 1)² h⁶ x⁽⁶⁾/720, at most 3.3·10⁻⁶ h⁶
//! |x⁽⁶⁾|.

use featherbench_spatial::Real;

/// The polynomial of one step.
pub(crate) struct Dense<T> {
    /// The divided differences of each state.
    coefficients: Vec<[T; 6]>,
    pub(crate) start: T,
    pub(crate) length: T,
}

const NODES: [f64; 5] = [0.0, 0.0, 0.5, 0.5, 1.0];

impl<T: Real> Dense<T> {
    /// The polynomial through (state, rate) at the beginning, the middle and the end.
    pub(crate) fn new(start: T, length: T, points: [(&[T], &[T]); 3]) -> Self {
        let two = T::from_f64(2.0);
        let of = |k: usize| {
            let x = points.map(|(state, _)| state[k]);
            let v = points.map(|(_, rate)| length * rate[k]);
            let (first, second) = ((x[1] - x[0]) * two, (x[2] - x[1]) * two);
            // Second differences [0,0,½], [0,½,½], [½,½,1], [½,1,1]; the distances of their ends are ½.
            let a = [(first - v[0]) * two, (v[1] - first) * two, (second - v[1]) * two, (v[2] - second) * two];
            // Third: [0,0,½,½], [0,½,½,1], [½,½,1,1].
            let b = [(a[1] - a[0]) * two, a[2] - a[1], (a[3] - a[2]) * two];
            let c = [b[1] - b[0], b[2] - b[1]];
            [x[0], v[0], a[0], b[0], c[0], c[1] - c[0]]
        };
        Self { coefficients: (0..points[0].0.len()).map(of).collect(), start, length }
    }

    /// Time, state and dx/dt at a fraction s of the step.
    pub(crate) fn at(&self, s: f64) -> (T, Vec<T>, Vec<T>) {
        let (mut state, mut rate) = (Vec::new(), Vec::new());
        for coefficients in &self.coefficients {
            let (mut value, mut slope) = (coefficients[5], T::zero());
            for (coefficient, node) in coefficients[..5].iter().zip(NODES).rev() {
                let distance = T::from_f64(s - node);
                slope = slope.mul_add(distance, value);
                value = value.mul_add(distance, *coefficient);
            }
            state.push(value);
            rate.push(slope / self.length);
        }
        (self.length.mul_add(T::from_f64(s), self.start), state, rate)
    }
}
