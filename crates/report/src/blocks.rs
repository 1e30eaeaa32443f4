//! Building blocks of sections.

use maud::{Markup, html};

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
