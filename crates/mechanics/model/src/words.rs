//! Enumerations whose values have words in a description file.

/// Declares an enumeration with `ALL`, its values in this order, and `name`, the word for one.
macro_rules! words {
    ($(#[$of:meta])* pub enum $name:ident { $($(#[$variant_of:meta])* $variant:ident => $word:literal),+ $(,)? }) => {
        $(#[$of])*
        pub enum $name {
            $($(#[$variant_of])* $variant),+
        }

        impl $name {
            /// All values.
            pub const ALL: [Self; [$($word),+].len()] = [$(Self::$variant),+];

            /// The word for it in a description file.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $word),+
                }
            }
        }
    };
}
pub(crate) use words;
