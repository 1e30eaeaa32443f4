//! Figures, drawn once: the page, print and papers show the same drawing. A [`Figure`] is one for papers, with a caption and its data; a
//! [`Plot::drawing`] stands in a section of the page, where a script adds tips, zoom and the way to the rows (`assets/drawing.js`).
//!
//! # Why they are drawn here
//! | way | result |
//! |---|---|
//! | this module | SVG of 4 to 22 kB on the default run, deterministic to the byte, texts stay texts; no dependency, as maud writes the elements |
//! | a script of the page | needs a browser to make a file; what it draws is seen neither without scripts nor in a paper |
//! | plotly | its script alone has 4.65 MB, and its files come from a browser too |
//! | a plotting crate | not tried: a dependency more for axes and lines; what is most of this module, marks for each engine, the legend and captions, would remain |
//!
//! The paper is white in dark mode, too. A figure has a caption that says its finding, and its data as CSV. An engine has one colour and one mark in all of them: [`style`].

mod axis;
mod draw;
mod drawing;
mod heat;
mod marks;
mod paper;
mod plot;
mod style;

pub use axis::Axis;
pub use heat::Heat;
pub use paper::Figure;
pub use plot::{Line, Plot, Point, Rows, Series};
pub use style::{COLOURS, Style, style};
