//! The picture of a robot: it stands without a script, and marks the bodies that differ.

use featherbench_report::robot::drawn;
use featherbench_results::{Drawing, DrawnBody};
use std::collections::BTreeSet;

fn body(name: &str, parent: Option<usize>, z: f64) -> DrawnBody {
    let axes = [[0.3, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.1]];
    DrawnBody { name: name.into(), parent, mass: 1.5, origin: [0.0, 0.0, z], centre: [0.0, 0.1, z], axes }
}

#[test]
fn the_body_that_differs_is_marked_in_picture_and_tree() {
    let robot = Drawing(vec![body("base", None, 0.0), body("arm <1>", Some(0), 1.0), body("hand", Some(1), 2.0)]);
    let marked = BTreeSet::from(["arm <1>".to_owned()]);
    let page = drawn("crane", &robot, &marked, "the physics differs").into_string();
    assert_eq!((page.matches("<ellipse").count(), page.matches("<line").count()), (3, 3), "{page}");
    for words in [
        "crane: the physics differs in arm &lt;1&gt;",
        "<ellipse class=\"marked\" data-body=\"1\"",
        "<li class=\"marked\" style=\"padding-left: 1rem\"",
    ] {
        assert!(page.contains(words), "{words}: {page}");
    }
    assert_eq!(page.matches("class=\"marked\"").count(), 2, "{page}");
    assert_eq!(page.matches("<text").count(), 1, "only bodies that differ are named in the picture");
    assert!(!page.contains("NaN") && !page.contains("inf"), "{page}");
    // The script reads the same numbers.
    let data = page.split("data-robot=\"").nth(1).unwrap().split('"').next().unwrap().replace("&quot;", "\"");
    let data: serde_json::Value = serde_json::from_str(&data).unwrap();
    assert_eq!(data["bodies"][2][0], serde_json::json!([0.0, 0.0, 1.0]), "a line begins at the parent's origin");
    let page = drawn("crane", &robot, &BTreeSet::new(), "the physics differs").into_string();
    assert!(page.contains("crane: 3 bodies") && !page.contains("class=\"marked\""), "{page}");
}

#[test]
fn odd_drawings_are_drawn() {
    // A body without extent at the origin, and a parent that is not before its child.
    let flat = DrawnBody { axes: [[0.0; 3]; 3], origin: [0.0; 3], centre: [0.0; 3], ..body("point", Some(7), 0.0) };
    let page = drawn("dot", &Drawing(vec![flat]), &BTreeSet::new(), "").into_string();
    assert!(page.contains("dot: 1 body") && !page.contains("NaN") && !page.contains("inf"), "{page}");
    assert!(drawn("none", &Drawing(Vec::new()), &BTreeSet::new(), "").into_string().contains("none: 0 bodies"));
}
