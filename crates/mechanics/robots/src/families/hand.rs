//! A floating hand designed for this project, about 1.1 kg: a free palm with six dofs, a thumb and four fingers of four.

use super::parts::{GRAVITY, Part, X, Y, Z, free_box, limb};
use featherbench_model::Description;

/// The 26-dof hand; z along the fingers, x out of the palm, y towards the thumb.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Hand;

/// The long fingers: name, place across the palm (m), scale of their lengths.
const FINGERS: [(&str, f64, f64); 4] =
    [("index_", 0.033, 1.0), ("middle_", 0.011, 1.08), ("ring_", -0.011, 1.02), ("little_", -0.033, 0.85)];

impl Hand {
    pub(super) fn describe(&self) -> Description {
        let mut bodies = vec![free_box("palm", 0.5, [0.002, 0.0, 0.045], [0.03, 0.09, 0.10])];
        limb(&mut bodies, 0, "thumb_", 1.0, &thumb());
        for (name, across, scale) in FINGERS {
            limb(&mut bodies, 0, name, 1.0, &finger(across, scale));
        }
        Description { name: "hand".to_owned(), gravity: GRAVITY, bodies, ..Description::default() }
    }
}

#[rustfmt::skip] // a table
fn thumb() -> [Part; 4] {
    [
        Part { name: "base", axis: Z, at: [0.012, 0.040, 0.020], mass: 0.030, com: [0.004, 0.004, 0.004], size: [0.022, 0.022, 0.022], range: (-0.3, 1.4), effort: 0.8 },
        Part { name: "proximal", axis: X, at: [0.006, 0.006, 0.006], mass: 0.045, com: [0.0, 0.010, 0.018], size: [0.018, 0.020, 0.048], range: (-1.0, 0.3), effort: 0.8 },
        Part { name: "middle", axis: Y, at: [0.0, 0.018, 0.040], mass: 0.025, com: [0.0, 0.002, 0.014], size: [0.016, 0.016, 0.034], range: (-0.2, 1.2), effort: 0.6 },
        Part { name: "distal", axis: Y, at: [0.0, 0.002, 0.030], mass: 0.018, com: [0.001, 0.0, 0.011], size: [0.014, 0.016, 0.026], range: (-0.2, 1.4), effort: 0.4 },
    ]
}

#[rustfmt::skip] // a table
fn finger(across: f64, scale: f64) -> [Part; 4] {
    [
        Part { name: "knuckle", axis: X, at: [0.0, across, 0.095 * scale], mass: 0.020, com: [0.0, 0.0, 0.004], size: [0.018, 0.018, 0.016], range: (-0.35, 0.35), effort: 0.7 },
        Part { name: "proximal", axis: Y, at: [0.0, 0.0, 0.010], mass: 0.045 * scale, com: [0.001, 0.0, 0.022 * scale], size: [0.017, 0.017, 0.045 * scale], range: (-0.3, 1.6), effort: 0.7 },
        Part { name: "middle", axis: Y, at: [0.0, 0.0, 0.048 * scale], mass: 0.028 * scale, com: [0.001, 0.0, 0.014 * scale], size: [0.015, 0.015, 0.028 * scale], range: (0.0, 1.8), effort: 0.5 },
        Part { name: "distal", axis: Y, at: [0.0, 0.0, 0.030 * scale], mass: 0.017 * scale, com: [0.001, 0.0, 0.010 * scale], size: [0.013, 0.013, 0.022 * scale], range: (0.0, 1.3), effort: 0.3 },
    ]
}
