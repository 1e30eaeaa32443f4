//! A histogram of fixed bins: the density, and quantiles from it.

use featherbench_spatial::{larger, smaller};

/// Bins between the bounds.
pub const BINS: usize = 1024;

/// Counts of samples in equal bins.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// The lower bound of the first bin.
    pub low: f64,
    /// The upper bound of the last one.
    pub high: f64,
    /// Samples in each bin.
    pub counts: Vec<u64>,
    /// Samples below and above the bounds.
    pub outside: [u64; 2],
    /// The smallest and the largest sample; NaN if one is.
    pub extremes: [f64; 2],
}

impl Histogram {
    /// An empty one. Equal bounds x are widened by half of |x|, at least by one half.
    pub fn new(low: f64, high: f64) -> Self {
        let half = 0.5 * larger(1.0, low.abs());
        let (low, high) = if high > low { (low, high) } else { (low - half, low + half) };
        Self { low, high, counts: vec![0; BINS], outside: [0; 2], extremes: [f64::INFINITY, f64::NEG_INFINITY] }
    }

    /// The width of a bin.
    pub fn width(&self) -> f64 {
        (self.high - self.low) / BINS as f64
    }

    /// Counts samples.
    pub fn count(&mut self, values: &[f64]) {
        let scale = BINS as f64 / (self.high - self.low);
        for y in values {
            self.extremes = [smaller(self.extremes[0], *y), larger(self.extremes[1], *y)];
            let place = (y - self.low) * scale;
            if place < 0.0 {
                self.outside[0] += 1;
            } else if place < BINS as f64 {
                self.counts[place as usize] += 1;
            } else {
                self.outside[1] += 1;
            }
        }
    }

    /// Adds the counts of another with the same bins.
    pub fn add(&mut self, other: &Self) {
        self.counts.iter_mut().zip(&other.counts).for_each(|(count, more)| *count += more);
        self.outside.iter_mut().zip(other.outside).for_each(|(count, more)| *count += more);
        self.extremes = [smaller(self.extremes[0], other.extremes[0]), larger(self.extremes[1], other.extremes[1])];
    }

    /// How many samples there are.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum::<u64>() + self.outside[0] + self.outside[1]
    }

    /// The value that a part p of the samples is below, never beyond a sample; `None` where it is outside the bounds.
    pub fn quantile(&self, p: f64) -> Option<f64> {
        let due = p * self.total() as f64;
        let mut below = self.outside[0] as f64;
        if due < below {
            return None;
        }
        for (bin, &count) in self.counts.iter().enumerate() {
            if count > 0 && due <= below + count as f64 {
                let within = self.low + self.width() * (bin as f64 + self.place(bin, due - below));
                return Some(smaller(larger(within, self.extremes[0]), self.extremes[1]));
            }
            below += count as f64;
        }
        None
    }

    /// The part of the samples below a value; `None` outside the bounds.
    pub fn below(&self, value: f64) -> Option<f64> {
        let place = (value - self.low) / self.width();
        let bin = place.floor();
        if !(bin >= 0.0 && bin < BINS as f64) {
            return None;
        }
        let before = self.outside[0] + self.counts[..bin as usize].iter().sum::<u64>();
        Some((before as f64 + self.within(bin as usize, place - bin)) / self.total() as f64)
    }

    /// The samples of a bin below its part x: the cubic through the counts at four ends of bins, whose error is of the fourth order in the width.
    fn within(&self, bin: usize, x: f64) -> f64 {
        let count = |k: Option<usize>| k.and_then(|k| self.counts.get(k)).map_or(0.0, |count| *count as f64);
        let [before, own, after] = [count(bin.checked_sub(1)), count(Some(bin)), count(Some(bin + 1))];
        // Newton's form on the ends 0, 1, −1, 2.
        own * x + 0.5 * (own - before) * x * (x - 1.0) + (after - 2.0 * own + before) * x * (x - 1.0) * (x + 1.0) / 6.0
    }

    /// Where in a bin so many of its samples are below. There is one such place at least, as the cubic is 0 and the count at its ends.
    fn place(&self, bin: usize, due: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        while high - low > f64::EPSILON {
            let middle = 0.5 * (low + high);
            if self.within(bin, middle) < due { low = middle } else { high = middle }
        }
        high
    }

    /// The density in the middle of each of so many groups of bins: (value, density).
    pub fn density(&self, groups: usize) -> Vec<(f64, f64)> {
        let size = BINS.div_ceil(groups.max(1));
        let total = self.total() as f64;
        let group = |(k, counts): (usize, &[u64])| {
            let width = self.width() * counts.len() as f64;
            let begin = self.low + self.width() * (k * size) as f64;
            (begin + 0.5 * width, counts.iter().sum::<u64>() as f64 / total / width)
        };
        self.counts.chunks(size).enumerate().map(group).collect()
    }
}
