//! Implementations of operators, without the lines that are alike in each.

/// Implements operators, such as `Add: add(self, other: Self) -> Self { … }`, and after a semicolon those that assign, such as
/// `AddAssign add_assign +`.
macro_rules! operators {
    (
        #[$inline:meta]
        <$t:ident: $bound:ident> $type:ty;
        $($trait:path: $method:ident($self:ident $(, $other:ident: $right:ty)?) -> $output:ty $body:block)*
        $(; $($assign:ident $name:ident $sign:tt),+)?
    ) => {
        $(
            impl<$t: $bound> $trait for $type {
                type Output = $output;
                #[$inline]
                fn $method($self $(, $other: $right)?) -> $output $body
            }
        )*
        $($(
            impl<$t: $bound> $assign for $type {
                #[$inline]
                fn $name(&mut self, other: Self) {
                    *self = *self $sign other;
                }
            }
        )+)?
    };
}
pub(crate) use operators;
