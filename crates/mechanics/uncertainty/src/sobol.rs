//! Sobol' points with Owen's scrambling: point k of any seed, without those before it.
//!
//! Source: I. M. Sobol', 1967 (the sequence); P. Bratley and B. L. Fox, *ACM TOMS* 14, 1988 (the recurrence of the direction numbers); A. B. Owen,
//! 1995 (nested uniform scrambling: each bit is flipped or not by a random function of all bits before it).
//!
//! The primitive polynomials are found by search, in rising degree. The first direction numbers of a dimension are free (odd numbers
//! m_i < 2^i). Some candidates are drawn from a fixed seed. The one is taken whose planes with the dimensions before it are most evenly
//! filled, by the quality parameter t of each plane. So no table is needed. Published tables have better numbers in high dimensions.
//! No crate was fit: those with a permissive licence stop at 2¹⁶ points of single precision, or have no scrambling.

use crate::Error;
use featherbench_robots::Random;

/// The most dimensions: the primitive polynomials up to degree 9, and the radical inverse.
const DIMENSIONS: usize = 96;
/// Bits of the sequence; more random bits follow.
const BITS: usize = 32;
/// Candidates for the first numbers of a dimension.
const CANDIDATES: usize = 16;
/// Planes with so many dimensions before are looked at, with up to 2^DEEP points.
const BEFORE: usize = 12;
const DEEP: usize = 9;

/// The direction numbers of each dimension, and the seeds of their scrambles.
#[derive(Clone, Debug)]
pub struct Sobol {
    directions: Vec<[u32; BITS]>,
    keys: Vec<u64>,
}

impl Sobol {
    /// The sequence of a seed.
    ///
    /// # Errors
    /// [`Error::TooManyDimensions`].
    pub fn new(dimensions: usize, seed: u64) -> Result<Self, Error> {
        Ok(Self { directions: directions(dimensions)?, keys: Vec::new() }.with_seed(seed))
    }

    /// The same sequence with another scrambling.
    #[must_use]
    pub fn with_seed(&self, seed: u64) -> Self {
        let mut random = Random::named(seed, "Owen scrambling");
        Self { directions: self.directions.clone(), keys: self.directions.iter().map(|_| random.bits64()).collect() }
    }

    /// Point `index` (below 2³²), in (0, 1) with 53 bits.
    pub fn point(&self, index: u64, unit: &mut [f64]) {
        for ((unit, directions), key) in unit.iter_mut().zip(&self.directions).zip(&self.keys) {
            let (mut bits, mut rest, mut k) = (0_u32, index, 0);
            while rest != 0 {
                // A bit of the index that is set adds its direction, modulo two.
                bits ^= directions[k % BITS] & 0_u32.wrapping_sub((rest & 1) as u32);
                rest >>= 1;
                k += 1;
            }
            *unit = (scrambled(bits, *key) as f64 + 0.5) * (0.5 * f64::EPSILON);
        }
    }

    /// Point `index` before scrambling, as an integer of 32 bits per dimension.
    pub fn plain(&self, index: u64) -> Vec<u32> {
        let bits = |directions: &[u32; BITS]| (0..BITS).filter(|k| index >> k & 1 == 1).fold(0, |bits, k| bits ^ directions[k]);
        self.directions.iter().map(bits).collect()
    }
}

/// 53 bits: the 32 of the sequence, each flipped by a function of those before it, and 21 more.
fn scrambled(bits: u32, key: u64) -> u64 {
    let mut result = 0_u64;
    let mut level = 0;
    // Six levels of the tree of bits share one random word: its 63 bits 1 … 63 are the flips of the 63 nodes.
    while level < BITS {
        let word = mixed(key ^ (u64::from(bits) >> (BITS - level)) ^ ((level as u64 + 1) << 40));
        let mut node = 1_u64;
        for k in level..(level + 6).min(BITS) {
            let bit = u64::from(bits >> (BITS - 1 - k) & 1);
            result = result << 1 | (bit ^ (word >> node & 1));
            node = node << 1 | bit;
        }
        level += 6;
    }
    result << 21 | mixed(key ^ u64::from(bits) ^ (63 << 40)) >> 43
}

/// A random function of 64 bits (the finaliser of SplitMix64: Steele, Lea & Flood, 2014).
fn mixed(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

fn directions(dimensions: usize) -> Result<Vec<[u32; BITS]>, Error> {
    if dimensions > DIMENSIONS {
        return Err(Error::TooManyDimensions { found: dimensions, limit: DIMENSIONS });
    }
    // The first dimension is the radical inverse.
    let mut all = vec![std::array::from_fn(|k| 1_u32 << (BITS - 1 - k))];
    let polynomials = (1..).flat_map(primitive);
    for (place, (degree, polynomial)) in polynomials.take(dimensions.saturating_sub(1)).enumerate() {
        let mut random = Random::new(0, place as u64);
        let mut best: Option<(usize, [u32; BITS])> = None;
        for _ in 0..if degree < 2 { 1 } else { CANDIDATES } {
            let candidate = grown(degree, polynomial, &mut random);
            let uneven = all.iter().rev().take(BEFORE).map(|other| unevenness(other, &candidate)).sum();
            if best.as_ref().is_none_or(|(known, _)| uneven < *known) {
                best = Some((uneven, candidate));
            }
        }
        all.extend(best.map(|(_, candidate)| candidate));
    }
    all.truncate(dimensions);
    Ok(all)
}

/// Drawn first numbers m_i, odd and below 2^i, and what the recurrence of the polynomial makes of them. Bit k of `polynomial` is the coefficient
/// of xᵏ.
fn grown(degree: usize, polynomial: u32, random: &mut Random) -> [u32; BITS] {
    let mut v = [0_u32; BITS];
    for i in 0..BITS {
        v[i] = if i < degree {
            ((random.bits32() >> (31 - i)) | 1) << (BITS - 1 - i)
        } else {
            let inner = (1..degree).filter(|k| polynomial >> (degree - k) & 1 == 1);
            inner.fold(v[i - degree] ^ (v[i - degree] >> degree), |sum, k| sum ^ v[i - k])
        };
    }
    v
}

/// The primitive polynomials of a degree over the field of two elements: those modulo which x has the order 2^degree − 1.
fn primitive(degree: usize) -> impl Iterator<Item = (usize, u32)> {
    let order = (1_u32 << degree) - 1;
    let candidates = (0..1_u32 << (degree - 1)).map(move |middle| 1 << degree | middle << 1 | 1);
    candidates
        .filter(move |polynomial| {
            let (mut power, mut count) = (1_u32, 0);
            loop {
                power <<= 1;
                if power >> degree & 1 == 1 {
                    power ^= polynomial;
                }
                count += 1;
                if power == 1 || count > order {
                    return count == order;
                }
            }
        })
        .map(move |polynomial| (degree, polynomial))
}

/// Σ t over the planes of 2¹, …, 2^DEEP points. Of 2^m points, t = m − k, where k is the largest number such that the first a rows of one matrix
/// and the first k − a of the other are independent for every a.
fn unevenness(first: &[u32; BITS], second: &[u32; BITS]) -> usize {
    (1..=DEEP)
        .map(|m| {
            let row = |v: &[u32; BITS], r: usize| (0..m).fold(0_u32, |row, c| row | (v[c] >> (BITS - 1 - r) & 1) << c);
            let full = |k: usize| {
                (0..=k).all(|a| {
                    let rows = (0..a).map(|r| row(first, r)).chain((0..k - a).map(|r| row(second, r)));
                    independent(rows)
                })
            };
            m - (1..=m).take_while(|k| full(*k)).last().unwrap_or(0)
        })
        .sum()
}

/// Whether rows of bits are independent modulo two.
fn independent(rows: impl Iterator<Item = u32>) -> bool {
    let mut basis = [0_u32; BITS];
    for mut row in rows {
        while row != 0 {
            let lead = row.ilog2() as usize;
            if basis[lead] == 0 {
                basis[lead] = row;
                break;
            }
            row ^= basis[lead];
        }
        if row == 0 {
            return false;
        }
    }
    true
}
