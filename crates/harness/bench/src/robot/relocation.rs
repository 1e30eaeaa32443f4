//! Changes the heap, so that later allocations get other addresses (memory layout randomization).

use featherbench_robots::Random;
use std::hint::black_box;

/// The blocks: how many are allocated, of which about half remain, and the smallest and largest size in bytes.
/// Small blocks use up recently freed memory, which an allocator would return again. Large ones, from a cache line to some pages, shift
/// what follows. Still larger ones would get new pages each time.
const BLOCKS: [(usize, f64, f64); 2] = [(1024, 16.0, 1024.0), (64, 1024.0, 65536.0)];

/// Blocks of random sizes between holes of random sizes. Allocations while it exists fill the holes and the memory after it. So the
/// positions of their parts, relative to each other and to the pages, change with every draw.
#[derive(Debug)]
pub struct Relocation(#[expect(dead_code, reason = "what counts is that they take room")] Vec<Vec<u8>>);

impl Relocation {
    /// Draws blocks and holes.
    pub fn new(random: &mut Random) -> Self {
        let mut blocks = Vec::new();
        for (count, least, largest) in BLOCKS {
            blocks.extend((0..count).map(|_| black_box(vec![0_u8; (least * (largest / least).powf(random.unit())) as usize])));
        }
        Self(blocks.into_iter().filter(|_| random.below(2) == 0).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_follows_lies_elsewhere_each_time() {
        let mut random = Random::new(1, 1);
        let places = (0..20).map(|_| {
            let _relocate = Relocation::new(&mut random);
            let (small, large) = (black_box(vec![0_u8; 100]), black_box(vec![0_u8; 20_000]));
            (small.as_ptr().addr() % 4096, large.as_ptr().addr() % 4096)
        });
        let (mut small, mut large): (Vec<_>, Vec<_>) = places.unzip();
        for places in [&mut small, &mut large] {
            places.sort_unstable();
            places.dedup();
            // Of twenty addresses among 256 (every 16 bytes of a page) one or two would coincide by chance.
            assert!(places.len() > 10, "{places:?}");
        }
    }
}
