//! Changes where data are: other addresses of later allocations, and of the stack (memory layout randomization).

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

/// Places of the stack within a cache line: it is aligned to 16 bytes, and vectors of 32 or 64 may cross a line.
pub const STACK_PLACES: usize = 4;
/// Steps of the stack that [`on_stack_at`] knows. They span a page.
const STEPS: usize = 256;

/// Runs something with the stack `step` times 16 bytes lower than for the step 0; steps repeat after a page.
///
/// Where the stack is within a cache line is decided when a process starts. It changed times by a fifth.
pub fn on_stack_at(step: usize, run: &mut dyn FnMut()) {
    /// So many frames, each with room for some bytes.
    #[inline(never)]
    fn frames<const BYTES: usize>(count: usize, run: &mut dyn FnMut()) {
        let mut room = [0_u8; BYTES];
        black_box(&mut room);
        if count == 0 {
            run()
        } else {
            frames::<BYTES>(count - 1, run)
        }
        black_box(&mut room);
    }
    // A frame of the second kind is 16 bytes larger, whatever else is in it.
    let larger = step % STEPS;
    frames::<16>(STEPS - larger, &mut || frames::<32>(larger, run));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_the_stack_are_16_bytes() {
        let place = |step| {
            let mut place = 0;
            on_stack_at(step, &mut || {
                let here = 0_u8;
                place = std::ptr::from_ref(black_box(&here)).addr();
            });
            place
        };
        for step in 1..=STEPS {
            assert_eq!(place(0).wrapping_sub(place(step)), 16 * (step % STEPS), "step {step}");
        }
    }

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
