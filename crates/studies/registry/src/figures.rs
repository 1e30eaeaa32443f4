//! The list of figures for papers.

/// Every figure that a run can have, and the rows that it needs. A figure without its rows is absent.
pub const FIGURES: [(&str, &str); 11] = [
    ("error-depth-id", "errors of inverse dynamics against the truth (study accuracy)"),
    ("error-depth-fd", "errors of forward dynamics against the truth (study accuracy)"),
    ("error-size-id", "errors of inverse dynamics against the truth (study accuracy)"),
    ("error-size-fd", "errors of forward dynamics against the truth (study accuracy)"),
    ("error-distribution", "errors against the truth (study accuracy)"),
    ("speed-ratios", "ratios of another engine's times to ours that count (study timing, live)"),
    ("time-size", "times of forward dynamics that count, on robots of two sizes (study timing)"),
    ("peak-share", "times of inverse or forward dynamics that count, and a peak of the machine that does (study timing)"),
    ("work-precision", "times and errors of forward dynamics of one robot (studies timing and accuracy)"),
    ("memory-size", "memory of two sizes of one family (study growth)"),
    ("speed-profile", "times of two engines on one robot that count and are no estimates (study timing, live)"),
];
