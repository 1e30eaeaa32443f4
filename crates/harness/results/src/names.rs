//! The columns with a closed set of words.

use serde::{Deserialize, Serialize};

/// Declares an enum whose variants are written as fixed lower-case words.
macro_rules! words {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident = $word:literal),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        pub enum $name {
            $($(#[$variant_doc])* #[serde(rename = $word)] $variant),+
        }

        impl $name {
            /// Every value, in the order of declaration.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// Their words, in the same order.
            pub const WORDS: &'static [&'static str] = &[$($word),+];

            /// The word in files.
            pub const fn as_str(self) -> &'static str {
                match self {
                    $(Self::$variant => $word),+
                }
            }

            /// The value of a word, if there is one.
            pub fn parse(word: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|value| value.as_str() == word)
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.as_str())
            }
        }
    };
}
pub(crate) use words;

words! {
    /// Whether another run must give the same row.
    Kind {
        /// The same bits on every run, shard and thread count.
        Exact = "exact",
        /// Measured on a machine: a time, a count of instructions.
        Measured = "measured",
    }
}

words! {
    /// The relation between `value` and `bound` with which the row passes.
    Relation {
        /// value ≤ bound.
        Le = "le",
        /// value ≥ bound.
        Ge = "ge",
        /// value = bound, exactly.
        Eq = "eq",
        /// |value| ≤ bound, for values that have a sign.
        Within = "within",
    }
}

words! {
    /// The judgement of a row.
    Verdict {
        /// The value and its bound have the relation.
        Pass = "pass",
        /// They do not.
        Fail = "fail",
        /// A value without a bound: it is not judged.
        Info = "info",
        /// No value, which was known before: the engine does not offer it.
        Skip = "skip",
        /// A value is missing, or it was not a finite number.
        Error = "error",
        /// The value fails its bound for a known cause.
        Deviation = "deviation",
    }
}
