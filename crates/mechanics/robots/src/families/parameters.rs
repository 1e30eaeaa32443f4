//! Reading a family's parameters from words.

use super::BadFamily;
use std::str::FromStr;

/// The largest number of links: a description and its model then take 1.4 GB.
pub(super) const MOST_LINKS: usize = 1_000_000;

/// The key=value pairs given to a family, taken one by one.
pub(super) struct Parameters {
    family: &'static str,
    given: Vec<(String, String)>,
    known: Vec<&'static str>,
}

impl Parameters {
    pub(super) fn new<'a>(family: &'static str, given: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self, BadFamily> {
        let mut parameters = Self { family, given: Vec::new(), known: Vec::new() };
        for (key, value) in given {
            if parameters.given.iter().any(|(earlier, _)| earlier == key) {
                return Err(BadFamily::Repeated { family, key: key.to_owned() });
            }
            parameters.given.push((key.to_owned(), value.to_owned()));
        }
        Ok(parameters)
    }

    /// The value of `key`, or `default`.
    pub(super) fn take<T: FromStr>(&mut self, key: &'static str, default: T, expected: &str) -> Result<T, BadFamily> {
        self.known.push(key);
        let Some(place) = self.given.iter().position(|(name, _)| name == key) else {
            return Ok(default);
        };
        let (_, value) = self.given.swap_remove(place);
        value.parse().map_err(|_| BadFamily::BadValue { family: self.family, key, value, expected: expected.to_owned() })
    }

    /// An error if a given parameter was not taken.
    pub(super) fn finish(self) -> Result<(), BadFamily> {
        match self.given.into_iter().next() {
            None => Ok(()),
            Some((key, _)) => {
                let known = if self.known.is_empty() { "none".to_owned() } else { self.known.join(", ") };
                Err(BadFamily::UnknownParameter { family: self.family, key, known })
            }
        }
    }
}

/// An error unless `good`.
pub(super) fn require<T: ToString>(good: bool, family: &'static str, key: &'static str, value: T, expected: &str) -> Result<(), BadFamily> {
    if good { Ok(()) } else { Err(BadFamily::BadValue { family, key, value: value.to_string(), expected: expected.to_owned() }) }
}

/// Declares an enumeration with its words: `name`, `FromStr`, `Display`, and `WORDS` for messages.
macro_rules! words {
    ($(#[$of:meta])* pub enum $name:ident { $($(#[$variant_of:meta])* $variant:ident => $word:literal),+ $(,)? }) => {
        $(#[$of])*
        pub enum $name {
            $($(#[$variant_of])* $variant),+
        }

        impl $name {
            /// Every value.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];
            /// The words for them, for messages.
            pub(crate) const WORDS: &'static str = concat!("one of:" $(, " ", $word)+);

            /// The word for it.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $word),+
                }
            }
        }

        impl std::str::FromStr for $name {
            type Err = ();
            fn from_str(word: &str) -> Result<Self, ()> {
                Self::ALL.iter().copied().find(|value| value.name() == word).ok_or(())
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}
pub(super) use words;

/// Declares a family by its parameters, each with its default, what it takes and how it is written: `Default`, `read`, and the `Display`
/// that is read back.
macro_rules! parameters {
    ($(#[$of:meta])* pub struct $family:ident {
        $($(#[$key_of:meta])* pub $key:ident: $type:ty = $default:expr, $expected:expr, $format:literal;)+
    }) => {
        $(#[$of])*
        pub struct $family {
            $($(#[$key_of])* pub $key: $type),+
        }

        impl Default for $family {
            fn default() -> Self {
                Self { $($key: $default),+ }
            }
        }

        impl $family {
            pub(super) fn read(given: &mut super::Parameters) -> Result<Self, super::BadFamily> {
                let default = Self::default();
                Ok(Self { $($key: given.take(stringify!($key), default.$key, $expected)?),+ })
            }

            pub(super) fn written(&self) -> String {
                format!(":{self}")
            }
        }

        impl std::fmt::Display for $family {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(&[$(format!(concat!(stringify!($key), "=", $format), self.$key)),+].join(","))
            }
        }
    };
}
pub(super) use parameters;
