//! A function of the variables, evaluated for several samples at once.

use featherbench_spatial::Real;

/// Samples that are evaluated together.
pub const LANES: usize = 8;
/// A register of samples.
pub type Lanes = wide::f64x8;

/// Answers of the variables.
pub trait Response: Sync {
    /// What an evaluation works in. Each thread has its own.
    type Scratch: Send;

    /// How many variables there are.
    fn inputs(&self) -> usize;

    /// How many answers there are.
    fn outputs(&self) -> usize;

    /// A new one.
    fn scratch(&self) -> Self::Scratch;

    /// The answers `y` (one per output) at `x` (one per input), lane by lane. A lane without an answer gets NaN.
    fn evaluate(&self, scratch: &mut Self::Scratch, x: &[Lanes], y: &mut [Lanes]);
}

/// The answers at one point.
pub fn at<R: Response>(response: &R, x: &[f64]) -> Vec<f64> {
    let x: Vec<Lanes> = x.iter().map(|x| Lanes::from_f64(*x)).collect();
    let mut y = vec![Lanes::zero(); response.outputs()];
    response.evaluate(&mut response.scratch(), &x, &mut y);
    y.into_iter().map(|y| y.to_array()[0]).collect()
}

/// The answers at many points, point after point; `set` writes a point.
pub(crate) fn at_each<R: Response>(response: &R, points: usize, mut set: impl FnMut(usize, &mut [f64])) -> Vec<f64> {
    let (inputs, outputs) = (response.inputs(), response.outputs());
    let (mut x, mut y, mut one) = (vec![Lanes::zero(); inputs], vec![Lanes::zero(); outputs], vec![0.0; inputs]);
    let (mut scratch, mut all) = (response.scratch(), Vec::with_capacity(points * outputs));
    for first in (0..points).step_by(LANES) {
        for lane in 0..LANES {
            // The last register repeats the last point.
            set((first + lane).min(points - 1), &mut one);
            x.iter_mut().zip(&one).for_each(|(x, one)| x.as_mut_array()[lane] = *one);
        }
        response.evaluate(&mut scratch, &x, &mut y);
        for lane in 0..LANES.min(points - first) {
            all.extend(y.iter().map(|y| y.to_array()[lane]));
        }
    }
    all
}

/// A function of one point as a response.
pub struct Closure<F> {
    inputs: usize,
    outputs: usize,
    function: F,
}

impl<F: Fn(&[f64], &mut [f64]) + Sync> Closure<F> {
    /// A function that writes so many answers of so many variables.
    pub fn new(inputs: usize, outputs: usize, function: F) -> Self {
        Self { inputs, outputs, function }
    }
}

impl<F: Fn(&[f64], &mut [f64]) + Sync> Response for Closure<F> {
    type Scratch = (Vec<f64>, Vec<f64>);

    fn inputs(&self) -> usize {
        self.inputs
    }

    fn outputs(&self) -> usize {
        self.outputs
    }

    fn scratch(&self) -> Self::Scratch {
        (vec![0.0; self.inputs], vec![0.0; self.outputs])
    }

    fn evaluate(&self, (one, answer): &mut Self::Scratch, x: &[Lanes], y: &mut [Lanes]) {
        for lane in 0..LANES {
            one.iter_mut().zip(x).for_each(|(one, x)| *one = x.to_array()[lane]);
            (self.function)(one, answer);
            y.iter_mut().zip(&*answer).for_each(|(y, answer)| y.as_mut_array()[lane] = *answer);
        }
    }
}
