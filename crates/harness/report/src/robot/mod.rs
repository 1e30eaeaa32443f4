//! A robot that one can look at: bodies as the ellipsoids of their inertias, joints as lines, and the kinematic tree.
//!
//! The picture is drawn here as SVG, so that it stands without a script, in print too. `assets/robot.js` turns it under the mouse and by the arrow
//! keys, with the same projection.

mod project;

use std::collections::BTreeSet;

use featherbench_results::{Drawing, DrawnBody};
use maud::{Markup, html};

use crate::numbers::{count, larger, listed, short};
use project::{View, ellipse};

/// Width and height of the picture.
const SIZE: [f64; 2] = [460.0, 360.0];
/// Room around the robot.
const MARGIN: f64 = 26.0;

/// A robot, with the bodies marked that differ. `what` says what they differ in.
pub fn drawn(name: &str, drawing: &Drawing, marked: &BTreeSet<String>, what: &str) -> Markup {
    let Drawing(bodies) = drawing;
    let view = View::of(bodies, SIZE, MARGIN);
    let is_marked = |body: &DrawnBody| marked.contains(&body.name);
    let differing: Vec<String> = bodies.iter().filter(|body| is_marked(body)).map(|body| body.name.clone()).collect();
    let caption = match differing.len() {
        0 => format!("{name}: {}", count(bodies.len(), "body")),
        _ => format!("{name}: {what} in {}", listed(&differing)),
    };
    html! {
        figure.robot data-robot=(data(bodies, &view)) {
            (picture(&caption, bodies, &view, &is_marked))
            figcaption { (caption) " " span.hint { "Drag it, or use the arrow keys. An ellipsoid has the mass and inertia of its body." } }
            details {
                summary { "Kinematic tree" }
                ul.tree {
                    @for (index, body) in bodies.iter().enumerate() {
                        li.marked[is_marked(body)] style={ "padding-left: " (depth(bodies, index)) "rem" } {
                            (body.name) " " small { (short(body.mass)) " kg" @if is_marked(body) { ", " (what) } }
                        }
                    }
                }
            }
        }
    }
}

/// Joints between a body and the world; a parent that does not come before its child ends the count.
fn depth(bodies: &[DrawnBody], index: usize) -> usize {
    let mut depth = 0;
    let mut at = index;
    while let Some(parent) = bodies.get(at).and_then(|body| body.parent).filter(|parent| *parent < at) {
        (at, depth) = (parent, depth + 1);
    }
    depth
}

/// What the script needs: for each body its parent's origin, its own, its centre and half axes.
fn data(bodies: &[DrawnBody], view: &View) -> String {
    let of = |body: &DrawnBody| serde_json::json!([from(bodies, body), body.origin, body.centre, body.axes]);
    serde_json::json!({
        "bodies": bodies.iter().map(of).collect::<Vec<_>>(), "middle": view.middle, "scale": view.scale, "size": SIZE,
        "turn": view.turn, "tilt": view.tilt,
    })
    .to_string()
}

/// Where the line to a body begins.
fn from(bodies: &[DrawnBody], body: &DrawnBody) -> [f64; 3] {
    body.parent.and_then(|parent| bodies.get(parent)).map_or([0.0; 3], |parent| parent.origin)
}

fn picture(title: &str, bodies: &[DrawnBody], view: &View, is_marked: &dyn Fn(&DrawnBody) -> bool) -> Markup {
    let at = |value: f64| format!("{value:.1}");
    // The farthest body first: nearer ones stand before it.
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.sort_by(|&a, &b| view.place(bodies[a].centre)[2].total_cmp(&view.place(bodies[b].centre)[2]));
    html! {
        svg viewBox={ "0 0 " (SIZE[0]) " " (SIZE[1]) } width=(SIZE[0]) height=(SIZE[1]) role="img" tabindex="0" aria-label=(title) {
            g.bodies {
                @for &index in &order {
                    @let body = &bodies[index];
                    @let [rx, ry, angle] = ellipse(body.axes.map(|axis| view.turned(axis)), view.scale);
                    @let centre = view.place(body.centre);
                    ellipse.marked[is_marked(body)] data-body=(index) rx=(at(larger(rx, 1.5))) ry=(at(larger(ry, 1.5)))
                        transform={ "translate(" (at(centre[0])) " " (at(centre[1])) ") rotate(" (at(angle)) ")" } {
                        title { (body.name) ", " (short(body.mass)) " kg" }
                    }
                }
            }
            g.links {
                @for (index, body) in bodies.iter().enumerate() {
                    @let (start, end) = (view.place(from(bodies, body)), view.place(body.origin));
                    line data-body=(index) x1=(at(start[0])) y1=(at(start[1])) x2=(at(end[0])) y2=(at(end[1])) {}
                    circle data-body=(index) r="2.5" cx=(at(end[0])) cy=(at(end[1])) {}
                }
            }
            g.names {
                @for (index, body) in bodies.iter().enumerate().filter(|(_, body)| is_marked(body)) {
                    @let centre = view.place(body.centre);
                    text data-body=(index) x=(at(centre[0] + 6.0)) y=(at(centre[1] - 6.0)) { (body.name) }
                }
            }
        }
    }
}
