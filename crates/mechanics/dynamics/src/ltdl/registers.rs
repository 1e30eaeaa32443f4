//! Loads and stores of eight consecutive numbers.

use wide::f64x8;

/// Numbers in a register.
pub(crate) const LANES: usize = 8;

/// The numbers at `at …`.
#[inline(always)]
pub(super) fn load(values: &[f64], at: usize) -> f64x8 {
    f64x8::new(*values[at..].first_chunk().expect("eight numbers"))
}

const TRUE: f64 = f64::from_bits(u64::MAX);

/// True in the first `count` lanes; all are for more.
#[inline(always)]
pub(super) fn first(count: usize) -> f64x8 {
    const MASKS: [[f64; LANES]; LANES + 1] = {
        let mut masks = [[0.0; LANES]; LANES + 1];
        let mut count = 0;
        while count <= LANES {
            let mut lane = 0;
            while lane < count {
                masks[count][lane] = TRUE;
                lane += 1;
            }
            count += 1;
        }
        masks
    };
    f64x8::new(MASKS[count.min(LANES)])
}

/// True in one lane, in none from eight on.
#[inline(always)]
pub(super) fn only(lane: usize) -> f64x8 {
    const MASKS: [[f64; LANES]; LANES + 1] = {
        let mut masks = [[0.0; LANES]; LANES + 1];
        let mut lane = 0;
        while lane < LANES {
            masks[lane][lane] = TRUE;
            lane += 1;
        }
        masks
    };
    f64x8::new(MASKS[lane.min(LANES)])
}

/// Writes the first `count` lanes; what follows them keeps its value.
///
/// Whole registers are written without a mask: a load that follows a masked store waits for the store to end.
#[inline(always)]
pub(super) fn store(values: &mut [f64], at: usize, register: f64x8, count: usize) {
    let numbers = values[at..].first_chunk_mut().expect("eight numbers");
    if count >= LANES {
        *numbers = register.to_array();
    } else {
        *numbers = first(count).select(register, f64x8::new(*numbers)).to_array();
    }
}

/// `y − a x` for a number a.
#[inline(always)]
pub(super) fn subtract(y: f64x8, a: f64, x: f64x8) -> f64x8 {
    f64x8::splat(a).mul_neg_add(x, y)
}
