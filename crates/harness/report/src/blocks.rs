//! Building blocks of sections.

use maud::{Markup, html};

use crate::overview::Overview;

/// An engine's name, which leads to its page.
pub fn engine(overview: &Overview, name: &str) -> Markup {
    linked(overview.engine(name).map(|index| overview.pages.engines[index].as_str()), name)
}

/// A robot's name, which leads to its page.
pub fn robot(overview: &Overview, name: &str) -> Markup {
    linked(overview.robot(name).map(|index| overview.pages.robots[index].as_str()), name)
}

/// A study's name, which leads to its page.
pub fn study(overview: &Overview, name: &str) -> Markup {
    linked(overview.study(name).map(|index| overview.pages.studies[index].as_str()), name)
}

/// Names in a sentence: `a`, `a and b`, `a, b and c`.
pub fn sentence(names: &[Markup]) -> Markup {
    html! {
        @for (place, name) in names.iter().enumerate() {
            @if place > 0 { (if place + 1 < names.len() { ", " } else { " and " }) }
            (name)
        }
    }
}

fn linked(page: Option<&str>, name: &str) -> Markup {
    html! { @match page { Some(page) => a href=(page) { (name) }, None => (name) } }
}

/// A button that opens rows: those of a chunk whose columns have the given values. A filter without a value is left out.
pub fn opener(chunk: &str, filters: &[(&str, &str)], text: &str) -> Markup {
    let filters: serde_json::Map<String, serde_json::Value> =
        filters.iter().filter(|(_, value)| !value.is_empty()).map(|&(column, value)| (column.to_owned(), value.into())).collect();
    html! {
        button.open type="button" data-chunk=(chunk) data-filter=(serde_json::Value::from(filters)) { (text) }
    }
}

/// An entry of a legend (`ul.legend`): a patch of the class with its sign, and the meaning.
pub fn swatch(class: &str, sign: &str, meaning: &str) -> Markup {
    html! { li { span.swatch.(class) aria-hidden="true" { (sign) } (meaning) } }
}
