//! Figures for papers: their styles, drawings, data, and their place on the page.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use featherbench_report::Section;
use featherbench_report::figure::{Axis, COLOURS, Figure, Heat, Line, Plot, Point, Series, style};
use featherbench_results::RunInfo;

use crate::written::Written;

fn plot(points: &[(f64, f64)]) -> Plot {
    let points = points.iter().map(|&(x, y)| Point { name: "a, \"b\"".into(), x, y }).collect();
    let series = Series { name: "drake <1>".into(), style: style("drake"), line: Line::Straight, points };
    Plot { title: "Error".into(), x: Axis::log("size, 1"), y: Axis::log("error"), series: vec![series] }
}

/// Every engine of the project looks unlike every other: by colour or by mark.
#[test]
fn engines_differ() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../oracles/engines.toml")).unwrap();
    let heads = text.lines().filter_map(|line| line.strip_prefix('[')?.strip_suffix(']'));
    let mut names: Vec<&str> = heads.filter(|name| !name.contains(['[', '.'])).collect();
    names.push("featherbench");
    assert!(names.len() > 10, "{names:?}");
    let mut seen = BTreeMap::new();
    for name in names {
        let look = style(name);
        assert!(look.colour < COLOURS.len());
        // Engines that only factorise, solve or bend rods share grey; no figure has more of them than marks.
        if let Some(other) = seen.insert(look, name) {
            assert_eq!(look.colour, COLOURS.len() - 1, "{name} looks like {other}");
        }
    }
}

#[test]
fn a_plot_has_a_mark_for_each_point_with_a_place_and_all_points_in_its_data() {
    let figure = plot(&[(1.0, 1e-16), (10.0, 1e-12), (100.0, 0.0)]).figure("error", "It grows.".into()).unwrap();
    // Two points and the sample of the legend; zero has no logarithm.
    assert_eq!(figure.svg.matches("class=\"mark\"").count(), 3, "{}", figure.svg);
    assert!(figure.svg.starts_with("<svg xmlns=") && figure.svg.contains("drake &lt;1&gt;") && !figure.svg.contains("NaN"));
    assert!(figure.svg.contains(">size, 1</text>") && figure.svg.contains(">10⁻¹²</text>"), "axes have titles and powers: {}", figure.svg);
    let lines: Vec<&str> = figure.csv.lines().collect();
    assert_eq!(lines[0], "series,name,\"size, 1\",error");
    assert_eq!(lines[3], "drake <1>,\"a, \"\"b\"\"\",100,0");
    assert_eq!(figure, plot(&[(1.0, 1e-16), (10.0, 1e-12), (100.0, 0.0)]).figure("error", "It grows.".into()).unwrap(), "the same bytes");
    assert_eq!(plot(&[(1.0, 0.0)]).figure("error", String::new()), None, "nothing has a place");
}

#[test]
fn a_heatmap_has_a_number_in_each_cell() {
    let heat = |cells| Heat {
        title: "Ratios".into(),
        unit: "1".into(),
        rows: vec!["drake".into()],
        columns: vec!["id".into(), "fd".into()],
        cells,
    };
    let figure = heat(vec![vec![Some(1.5), None]]).figure("ratios", String::new()).unwrap();
    assert_eq!(figure.svg.matches("class=\"cell\"").count(), 2);
    assert!(figure.svg.contains(">1.50</text>") && figure.svg.contains(">–</text>"), "{}", figure.svg);
    assert_eq!(figure.csv, "row,column,1\ndrake,id,1.5\n");
    assert_eq!(heat(vec![vec![None, None]]).figure("ratios", String::new()), None);
}

#[test]
fn the_page_shows_the_files_and_holds_their_data() {
    let figure: Figure = plot(&[(1.0, 2.0), (3.0, 4.0)]).figure("error", "It grows <fast>.".into()).unwrap();
    let section = Section { figures: vec![figure.clone()], ..Section::new("one", "One", maud::html! { section #one {} }) };
    let written = Written::of(&RunInfo::default(), &[], &[section]);
    let page = written.section("figures");
    assert!(
        page.contains("src=\"figures/error.svg\"") && page.contains("It grows &lt;fast&gt;.") && page.contains("data-figure=\"error\""),
        "{page}"
    );
    assert_eq!((written.text("figures/error.svg"), written.text("figures/error.csv")), (figure.svg, figure.csv.clone()));
    assert_eq!(written.data("figure-data"), serde_json::json!({"error": figure.csv}));
    assert!(!Written::of(&RunInfo::default(), &[], &[]).index.contains("id=\"figures\""), "without a figure there is no section");
}

/// The charts of the page have the same colours on light paper.
#[test]
fn the_page_has_the_same_colours() {
    let style = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/light.css")).unwrap();
    for (index, colour) in COLOURS.iter().enumerate() {
        assert!(style.contains(&format!("--series-{index}: {colour};")), "{index}");
    }
}
