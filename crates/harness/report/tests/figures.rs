//! Figures for papers: their styles, drawings, data, and their place on the page.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use featherbench_report::Section;
use featherbench_report::choices::{Choices, List};
use featherbench_report::figure::{Axis, COLOURS, Figure, Heat, Line, Plot, Point, Rows, Series, style};
use featherbench_results::RunInfo;

use crate::written::Written;

fn plot(points: &[(f64, f64)]) -> Plot {
    let points = points.iter().map(|&(x, y)| Point::new("a, \"b\"", x, y)).collect();
    Plot::new("Error", Axis::log("size, 1"), Axis::log("error"), vec![Series::new("drake <1>", style("drake"), points)])
}

/// Every engine of the project looks unlike every other: by colour or by mark.
#[test]
fn engines_differ() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../oracles/engines.toml")).unwrap();
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

/// A drawing of the page has with each mark its words, its values and its rows; a figure for papers has none of them.
#[test]
fn marks_on_the_page_have_words_values_and_rows() {
    let rows = |engine: &str| Some(Rows::of("robot-3", "arm", &[("study", "agreement"), ("engine", engine), ("method", "")]));
    let point = |x, y, engine: &str| Point { about: vec!["median <2>".into()], rows: rows(engine), ..Point::new("arm", x, y) };
    let series = vec![Series::new("drake", style("drake"), vec![point(7.0, 1e-15, "drake"), point(8.0, 1e-14, "dart")])];
    let plot = Plot::new("Error", Axis::log("n"), Axis::log("error"), series);
    let text = plot.drawing("error", "").0;
    assert!(text.contains("<title>arm\nmedian &lt;2&gt;</title>") && text.contains("data-value=\"7 1e-15\""), "{text}");
    assert_eq!(text.matches("data-rows=\"robot-3\"").count(), 2);
    // The filters of a series stand once, those of a mark only where they differ.
    assert!(text.contains("<g class=\"series\" data-filter=\"study=agreement\">"), "{text}");
    assert_eq!(["drake", "dart"].map(|engine| text.matches(&format!("data-filter=\"engine={engine}\"")).count()), [1, 1], "{text}");
    let paper = plot.figure("error", String::new()).unwrap().svg;
    assert!(!paper.contains("data-") && !paper.contains("median") && !paper.contains("median <"), "{paper}");
}

/// The place of the mark with these values, of a drawing.
fn place(text: &str, value: &str) -> (f64, f64) {
    let mark = text.split("transform=\"translate(").find(|mark| mark.contains(&format!("data-value=\"{value}\""))).unwrap();
    let (x, y) = mark.split(')').next().unwrap().split_once(' ').unwrap();
    (x.parse().unwrap(), y.parse().unwrap())
}

#[test]
fn zero_stands_hollow_on_the_lower_edge_of_a_logarithmic_axis() {
    let points = [(1.0, 0.0), (2.0, 1e-18), (3.0, 1e-12)].map(|(x, y)| Point::new("arm", x, y)).into();
    let plot = Plot::new("Error", Axis::log("n"), Axis::log("error").down_to(1e-18), vec![Series::new("one", style("drake"), points)]);
    let text = plot.drawing("error", "").0;
    assert_eq!(place(&text, "1 0").1, place(&text, "2 1e-18").1, "{text}");
    assert!(place(&text, "3 1e-12").1 < place(&text, "1 0").1, "upwards is larger");
    assert_eq!(text.matches("fill=\"#ffffff\" stroke=\"#b8518f\"").count(), 1, "the mark of zero alone is hollow: {text}");
    assert!(text.contains(">≤ 10⁻¹⁸</text>"), "{text}");
}

#[test]
fn intervals_fits_levels_and_bands_are_seen_whole() {
    let point = Point { upwards: [Some(1e-3), None], across: [None, Some(1e4)], estimated: true, ..Point::new("arm", 10.0, 1.0) };
    let line = Series { broad: vec![[1.0, 1.0], [1e5, 1e2]], ..Series::new("one", style("drake"), vec![point]) };
    let series = vec![line, Series::level("bound", 1e3)];
    let plot = Plot { bands: vec![[0.5, 2.0]], ..Plot::new("Time", Axis::log("n"), Axis::log("ns"), series) };
    let text = plot.drawing("time", "").0;
    assert_eq!(
        ["class=\"interval\"", "class=\"band\"", "stroke-width=\"6\""].map(|words| text.matches(words).count()),
        [1, 1, 1],
        "{text}"
    );
    // The axes reach from the least end to the largest: over five decades and six.
    for label in [">10⁵</text>", ">10⁻³</text>", ">1000</text>"] {
        assert!(text.contains(label), "{label}: {text}");
    }
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
}

#[test]
fn names_along_an_axis_stand_aslant() {
    let names: Vec<String> = ["a robot with a long name", "arm"].map(str::to_owned).into();
    let points = vec![Point::new("arm", 1.0, 2.0)];
    let series = vec![Series { line: Line::Marks, ..Series::new("one", style("drake"), points) }];
    let text = Plot::new("Ratios", Axis::named("", names), Axis::log("ratio"), series).drawing("ratios", "").0;
    assert!(text.contains("rotate(-38)") && text.contains(">a robot with a long name</text>"), "{text}");
}

#[test]
fn a_plot_without_a_place_says_so() {
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let text = Plot::new(
            "Error",
            Axis::log("n"),
            Axis::log("error"),
            vec![Series::new("one", style("drake"), vec![Point::new("arm", 1.0, value)])],
        );
        assert!(text.drawing("error", "nothing here").0.contains("nothing here"), "{value}");
    }
}

/// The drawings of the opening value are on the page, those of another value in a part; each is shown for its values alone.
#[test]
fn drawings_that_are_not_chosen_are_parts() {
    let lists = vec![List::of("shape", "Shape", ["a", "b", "a"]), List::of("size", "Size", ["1", "2"])];
    assert_eq!(lists[0].options.len(), 2);
    let drawing = |shape: &str, size: &str| (vec![shape.to_owned(), size.to_owned()], maud::html! { p { (shape) (size) } });
    let drawings = vec![drawing("a", "1"), drawing("b", "2"), drawing("a", "2")];
    let opening = vec!["b".to_owned(), "2".to_owned()];
    let (body, parts) = Choices { name: "made", title: "Made", lists, opening, drawings }.made();
    let text = body.0;
    assert!(text.contains("data-lists=\"shape size\"") && text.contains("<option value=\"b\" selected>"), "{text}");
    assert!(text.contains("<p>b2</p>") && !text.contains("<p>a1</p>"), "{text}");
    assert!(text.contains("data-choice=\"a\t1\na\t2\"") && text.contains("href=\"sections/made-1.html\""), "{text}");
    assert_eq!((parts.len(), parts[0].title.as_str()), (1, "Made: a"));
    assert!(
        parts[0].body.0.contains("<div data-choice=\"a\t1\"><p>a1</p></div><div data-choice=\"a\t2\"><p>a2</p></div>"),
        "{}",
        parts[0].body.0
    );
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

/// The drawings of scenes have the same colours on light paper.
#[test]
fn the_page_has_the_same_colours() {
    let style = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/light.css")).unwrap();
    for (index, colour) in COLOURS.iter().enumerate() {
        assert!(style.contains(&format!("--series-{index}: {colour};")), "{index}");
    }
}
