//! Double-double and compensated numbers against multi-precision ones, in units of u² = 2⁻¹⁰⁶.

mod arithmetic;
mod compensated;
mod multi_precision;
mod registers;
mod sine_cosine;
