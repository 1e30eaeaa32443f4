//! The axis along which a family of robots varies, from a robot's name: its depth, the mass at its tip, the offset of its base.

/// The horizontal axis of an accuracy plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axis {
    /// Joints from the base to the farthest leaf.
    Depth,
    /// The tip's mass over its usual mass.
    Tip,
    /// Distance of the base from the world's origin.
    Offset,
}

/// Suffixes of names, with a number.
const SUFFIXES: [(&str, Axis); 3] = [("-tip", Axis::Tip), ("-hand", Axis::Tip), ("-offset", Axis::Offset)];

impl Axis {
    /// All of them, in the order of the page.
    pub const ALL: [Self; 3] = [Self::Depth, Self::Tip, Self::Offset];

    /// The word in the page's data.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Tip => "tip",
            Self::Offset => "offset",
        }
    }

    /// The entry in the list of choices.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Tip => "tip mass ratio",
            Self::Offset => "base offset",
        }
    }

    /// The place from which errors can grow. A tip lighter than usual costs no digits, and a fit through both sides would be wrong.
    pub const fn fit_from(self) -> f64 {
        match self {
            Self::Tip => 1.0,
            Self::Depth | Self::Offset => 0.0,
        }
    }
}

/// The place of a robot: the axis, the family that varies along it, and its coordinate. `None` for a robot without such a family.
///
/// `rand3d-20-tip1e6` is in the family `rand3d-20` at a tip of 10⁶, `planar-small-50` in `planar-small` at its depth, provided that 50 is its
/// depth or its number of degrees of freedom.
pub fn place(name: &str, nv: Option<u64>, depth: Option<u64>) -> Option<(Axis, &str, f64)> {
    for (suffix, axis) in SUFFIXES {
        if let Some((family, number)) = name.rsplit_once(suffix)
            && let Ok(number) = number.parse::<f64>()
            && number.is_finite()
            && number > 0.0
        {
            return Some((axis, family, number));
        }
    }
    let (family, number) = name.rsplit_once(['-', '_'])?;
    let number: u64 = number.parse().ok()?;
    let depth = depth.filter(|&depth| depth > 0)?;
    (Some(number) == nv || number == depth).then_some((Axis::Depth, family, depth as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_what_is_varied() {
        let at = |name| place(name, Some(20), Some(20));
        assert_eq!(at("rand3d-20"), Some((Axis::Depth, "rand3d", 20.0)));
        assert_eq!(at("chain_2d_20"), Some((Axis::Depth, "chain_2d", 20.0)));
        assert_eq!(at("rand3d-20-tip1e-6"), Some((Axis::Tip, "rand3d-20", 1e-6)));
        assert_eq!(at("humanoid-hand1000"), Some((Axis::Tip, "humanoid", 1000.0)));
        assert_eq!(at("rand3d-20-offset1e4"), Some((Axis::Offset, "rand3d-20", 1e4)));
        for other in ["panda", "rand3d-20-fast", "ur5", "joints-30", "hand", "x-tip", "x-tip-5", "x-tipnan", "x-offsetinf", "g1_with_hands"]
        {
            assert_eq!(at(other), None, "{other}");
        }
        assert_eq!(place("star-30", Some(30), Some(1)), Some((Axis::Depth, "star", 1.0)));
        assert_eq!(place("star-30", None, None), None);
    }
}
