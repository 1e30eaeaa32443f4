//! One colour and one mark for each engine, the same in every figure and on every page.

/// Colours that differ for every kind of colour vision: those of Okabe and Ito, the weak ones darkened for white paper.
pub const COLOURS: [&str; 8] = ["#0072b2", "#d55e00", "#009e73", "#b8518f", "#b98500", "#3fa3dd", "#6b4fa3", "#5f6b76"];

/// Engines with a colour of their own, in the order of the colours. Others share the last one and differ by their marks.
const NAMED: [&str; 7] = ["featherbench", "pinocchio", "mujoco", "drake", "dart", "rapier", "dynibo"];
/// The number of marks.
const MARKS: usize = 8;

/// The mark of what is no answer of an engine: a short level line.
pub(super) const TICK: usize = MARKS;
/// The ink of texts, and of what belongs to no engine.
const INK: &str = "#17212b";

/// The colour of an index.
pub(super) fn ink(colour: usize) -> &'static str {
    COLOURS.get(colour).copied().unwrap_or(INK)
}

/// How an engine looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Style {
    /// Its index in [`COLOURS`].
    pub colour: usize,
    /// The index of its mark.
    pub mark: usize,
    /// Whether its marks are hollow and its lines dashed: a build of an engine beside the engine itself.
    pub hollow: bool,
}

/// The style of an engine. `pinocchio-clang` is a build of `pinocchio`: it has its colour, and a hollow mark of its own.
///
/// ```
/// use featherbench_report::figure::style;
///
/// assert_eq!(style("pinocchio").colour, style("pinocchio-clang").colour);
/// assert_ne!(style("pinocchio"), style("pinocchio-clang"));
/// ```
pub fn style(engine: &str) -> Style {
    let (base, build) = engine.split_once('-').map_or((engine, None), |(base, build)| (base, Some(build)));
    // Depends on the name alone: so a mark stays the same whoever else takes part.
    let number = |name: &str| name.bytes().fold(0_usize, |sum, byte| (sum * 31 + usize::from(byte)) % 9973);
    let colour = NAMED.iter().position(|&name| name == base);
    let mark = colour.unwrap_or_else(|| number(base) % MARKS);
    let shift = build.map_or(0, |build| 1 + number(build) % (MARKS - 1));
    Style { colour: colour.unwrap_or(COLOURS.len() - 1), mark: (mark + shift) % MARKS, hollow: build.is_some() }
}

impl Style {
    /// Bounds, gates and levels, which belong to no engine.
    pub const NEUTRAL: Self = Self { colour: COLOURS.len(), mark: TICK, hollow: false };

    /// One of a list of series that are no engines: a colour and a mark for each.
    pub const fn nth(index: usize) -> Self {
        Self { colour: index % COLOURS.len(), mark: index % MARKS, hollow: false }
    }

    /// The same colour with a mark that is so many further on: another method of an engine.
    pub const fn method(self, index: usize) -> Self {
        Self { mark: (self.mark + index) % MARKS, ..self }
    }

    /// Another colour.
    pub const fn coloured(self, index: usize) -> Self {
        Self { colour: index % COLOURS.len(), ..self }
    }
}
