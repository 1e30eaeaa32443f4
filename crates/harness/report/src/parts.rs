//! What the first page leaves out at first, so that it is small.
//!
//! Each piece is a script beside the page, which is run when the piece is wanted. It is a page of its own, too: for readers without
//! scripts, for print and for links.

use maud::{Markup, html};

use crate::section::{Part, Section};

/// The folder of the pages of sections and parts.
pub const FOLDER: &str = "sections";

/// The most nodes of a section that stands on the first page from the start. Two dozen sections of this size are half of the 3 000 nodes that
/// the page may have.
const SMALL: usize = 60;

/// Elements in markup: every opening tag makes one node.
pub fn nodes(markup: &str) -> usize {
    markup.as_bytes().windows(2).filter(|pair| pair[0] == b'<' && pair[1].is_ascii_alphabetic()).count()
}

/// A piece with its name and title.
pub struct Piece<'a> {
    /// Its name: that of its files, and the anchor of a section.
    pub name: &'a str,
    /// The title of its page.
    pub title: &'a str,
    /// What it holds.
    pub body: &'a Markup,
}

/// Every piece that the first page leaves out.
pub fn of<'a>(sections: &[&'a Section]) -> Vec<Piece<'a>> {
    let part = |part: &'a Part| Piece { name: &part.name, title: &part.title, body: &part.body };
    let whole =
        |section: &&'a Section| is_large(section).then_some(Piece { name: section.anchor, title: section.name, body: &section.body });
    sections.iter().flat_map(|section| whole(section).into_iter().chain(section.parts.iter().map(part))).collect()
}

/// What the first page has of a section: all of it, or its name until the window is near it.
pub fn on_first_page(section: &Section) -> Markup {
    html! {
        @if !is_large(section) { (section.body) } @else {
            section id=(section.anchor) data-part=(section.anchor) {
                h2 { (section.name) }
                p.note { a href={ (FOLDER) "/" (section.anchor) ".html" } { (section.name) " on a page of its own" } }
            }
        }
    }
}

fn is_large(section: &Section) -> bool {
    section.anchor != FIRST && nodes(&section.body.0) > SMALL
}

/// The section that opens the page.
const FIRST: &str = "verdict";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opening_tags_are_counted() {
        assert_eq!(nodes("<!DOCTYPE html><html><p>1 < 2</p><br></html>"), 3);
    }

    #[test]
    fn a_large_section_is_named_and_linked() {
        let section = |rows: usize| Section::new("mine", "Mine", html! { section #mine { @for _ in 0..rows { p { "row" } } } });
        let (small, large) = (section(3), section(SMALL + 1));
        assert!(on_first_page(&small).0.contains("row") && of(&[&small]).is_empty());
        let shown = on_first_page(&large).0;
        assert!(!shown.contains("row") && shown.contains("href=\"sections/mine.html\"") && shown.contains("id=\"mine\""), "{shown}");
        assert!(of(&[&large])[0].body.0.contains("row"));
    }
}
