//! A file with other inertials. Its comments, its formatting and all else stay.

use super::Parsed;
use super::angles::angles;
use super::links::FileInertial;
use crate::text::Lines;
use featherbench_model::Placement;
use featherbench_spatial::{Mat3, Sym3};
use roxmltree::Node;

/// An inertial that was written in the place of another one, or of none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mended {
    /// The link.
    pub link: String,
    /// The line of what was there: of its inertial, or of the link without one.
    pub line: usize,
    /// The element as it is now, on one line.
    pub element: String,
}

/// The second moments of a body are at least this part of their sum: an engine that tests an inertia with rounding must not refuse it again.
const LEAST: f64 = 1e-9;

impl Parsed<'_> {
    /// The text with these inertials, by link. Links that the file does not have are passed over.
    pub fn with_inertials(&self, changes: &[(String, FileInertial)]) -> (String, Vec<Mended>) {
        let lines = Lines::new(self.text);
        let links = self.document.root_element().children().filter(|node| node.has_tag_name("link"));
        let (mut text, mut mended, mut at) = (String::new(), Vec::new(), 0);
        for link in links {
            let Some(name) = link.attribute("name") else { continue };
            let Some((_, inertial)) = changes.iter().find(|(changed, _)| changed == name) else { continue };
            let old = link.children().find(|node| node.has_tag_name("inertial"));
            let start = old.map_or(link.range().start, |node| node.range().start);
            mended.push(Mended { link: name.to_owned(), line: lines.line(start), element: element(inertial, "") });
            let indent = self.indent(start);
            match old {
                Some(node) => {
                    text.push_str(&self.text[at..node.range().start]);
                    text.push_str(&element(inertial, &indent));
                    at = node.range().end;
                }
                None => at = self.opened(link, inertial, &indent, &mut text, at),
            }
        }
        text.push_str(&self.text[at..]);
        (text, mended)
    }

    /// Writes an inertial at the beginning of a link without one; the place in the old text that comes next.
    fn opened(&self, link: Node, inertial: &FileInertial, indent: &str, text: &mut String, at: usize) -> usize {
        let inner = format!("{indent}  ");
        let element = element(inertial, &inner);
        let range = link.range();
        match link.first_child() {
            Some(child) => {
                text.push_str(&self.text[at..child.range().start]);
                text.push_str(&format!("\n{inner}{element}"));
                child.range().start
            }
            None => {
                let whole = &self.text[range.clone()];
                let head = whole.find("/>").or(whole.find("></")).unwrap_or(whole.len());
                text.push_str(&self.text[at..range.start + head]);
                text.push_str(&format!(">\n{inner}{element}\n{indent}</link>"));
                range.end
            }
        }
    }

    /// The blanks before a place in its line.
    fn indent(&self, place: usize) -> String {
        let line = self.text[..place].rfind('\n').map_or(0, |newline| newline + 1);
        self.text[line..place].chars().take_while(|c| c.is_whitespace()).collect()
    }
}

/// The element, of four lines whose first has no blanks; of one line without an indent.
fn element(inertial: &FileInertial, indent: &str) -> String {
    let numbers = |list: &[f64]| list.iter().map(|x| format!("{:?}", x + 0.0)).collect::<Vec<_>>().join(" ");
    let [xx, xy, xz, yy, yz, zz] = inertial.inertia;
    let parts = [
        format!("<origin xyz=\"{}\" rpy=\"{}\"/>", numbers(&inertial.com), numbers(&angles(&inertial.rotation))),
        format!("<mass value=\"{:?}\"/>", inertial.mass),
        format!("<inertia ixx=\"{xx:?}\" ixy=\"{xy:?}\" ixz=\"{xz:?}\" iyy=\"{yy:?}\" iyz=\"{yz:?}\" izz=\"{zz:?}\"/>"),
    ];
    if indent.is_empty() {
        return format!("<inertial>{}</inertial>", parts.concat());
    }
    format!("<inertial>\n{indent}  {}\n{indent}</inertial>", parts.join(&format!("\n{indent}  ")))
}

impl FileInertial {
    /// The nearest inertia that some distribution of the same mass about the same centre has, and its distance over the size of this one,
    /// both in Frobenius' norm. `None` if this one is such an inertia, or the mass is not positive.
    ///
    /// The second moments S = ½ tr(I) 1 − I must not be negative (Wensing, Kim & Slotine, *Linear matrix inequalities for physically
    /// consistent inertial parameter identification*, 2018). In the pseudo-inertia with mass and centre given S is the only part that is free,
    /// and the nearest S cuts its negative principal values off.
    pub fn nearest_consistent(&self) -> Option<(Self, f64)> {
        let [xx, xy, xz, yy, yz, zz] = self.inertia;
        let half = 0.5 * (xx + yy + zz);
        let (moments, axes) = Sym3::from_array([half - xx, -xy, -xz, half - yy, -yz, half - zz]).principal();
        let sum: f64 = moments.iter().map(|x| x.max(0.0)).sum();
        // Six digits of a file may leave this much below zero of an inertia that was right.
        if self.mass <= 0.0 || !sum.is_finite() || moments.iter().all(|&x| x >= -1e-6 * sum) {
            return None;
        }
        let cut = moments.map(|x| x.max(LEAST * sum));
        let total: f64 = cut.iter().sum();
        let [a, b, c] = cut.map(|x| total - x);
        let inertia = Sym3::from_array([a, 0.0, 0.0, b, 0.0, c]).rotate(axes).to_array();
        let norm = |m: [f64; 6]| (m[0] * m[0] + m[3] * m[3] + m[5] * m[5] + 2.0 * (m[1] * m[1] + m[2] * m[2] + m[4] * m[4])).sqrt();
        let distance = norm(std::array::from_fn(|k| inertia[k] - self.inertia[k])) / norm(self.inertia);
        Some((Self { inertia, ..*self }, distance))
    }

    /// The same inertia written in the axes of the link.
    pub fn in_axes_of_link(&self) -> Self {
        let inertia = Sym3::from_array(self.inertia).rotate(Mat3::from_array(self.rotation)).to_array();
        Self { inertia, rotation: Placement::default().rotation, ..*self }
    }

    /// The same inertia written in its principal axes.
    pub fn in_principal_axes(&self) -> Self {
        let ([a, b, c], axes) = Sym3::from_array(self.inertia).principal();
        let rotation = (Mat3::from_array(self.rotation) * axes).to_array();
        Self { inertia: [a, 0.0, 0.0, b, 0.0, c], rotation, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "<?xml version='1.0'?>\n<!-- kept -->\n<robot name=\"r\">\n  <link name=\"a\"/>\n  <link name=\"b\">\n    <inertial>\n      \
                        <mass value=\"2\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"2\" iyz=\"0\" izz=\"9\"/>\n    </inertial>\n    <!-- too -->\n  \
                        </link>\n  <link name=\"c\">\n    <visual/>\n  </link>\n</robot>\n";

    #[test]
    fn inertials_are_replaced_and_the_rest_stays() {
        let parsed = Parsed::of(FILE.as_bytes(), "r.urdf").unwrap();
        let links = parsed.links(1000.0);
        let (nearest, distance) = links[1].inertial.unwrap().nearest_consistent().unwrap();
        // ½ tr − I has (5, 4, −3); without −3 the moments are (4, 5, 9).
        assert!((distance - (18.0_f64 / 86.0).sqrt()).abs() < 1e-8, "{distance}");
        assert!(nearest.inertia.iter().zip([4.0, 0.0, 0.0, 5.0, 0.0, 9.0]).all(|(x, y)| (x - y).abs() < 1e-7), "{nearest:?}");
        let zero = FileInertial { mass: 0.0, com: [0.0; 3], rotation: Placement::default().rotation, inertia: [0.0; 6] };
        let changes = [("b".to_owned(), nearest), ("a".to_owned(), zero), ("c".to_owned(), zero), ("nowhere".to_owned(), zero)];
        let (text, mended) = parsed.with_inertials(&changes);
        assert_eq!(mended.iter().map(|one| (one.link.as_str(), one.line)).collect::<Vec<_>>(), [("a", 4), ("b", 6), ("c", 11)]);
        assert!(text.contains("<!-- kept -->") && text.contains("<!-- too -->") && text.contains("<visual/>"), "{text}");
        let again = Parsed::of(text.as_bytes(), "r.urdf").unwrap();
        let inertials: Vec<_> = again.links(1000.0).into_iter().map(|link| link.inertial.unwrap()).collect();
        assert_eq!(inertials, [zero, nearest, zero], "{text}");
        assert_eq!(again.with_inertials(&[]).0, text);
    }

    #[test]
    fn an_inertia_that_is_right_stays() {
        let right =
            FileInertial { mass: 1.0, com: [0.0; 3], rotation: Placement::default().rotation, inertia: [1.0, 0.0, 0.0, 1.0, 0.0, 2.0] };
        assert_eq!(right.nearest_consistent(), None);
        let turned = right.in_principal_axes().in_axes_of_link();
        assert!(turned.inertia.iter().zip(right.inertia).all(|(x, y)| (x - y).abs() < 1e-15));
    }
}
