//! Parameters: a type of their study, and JSON in cells and rows.

use featherbench_results::{Row, canonical_json};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::json;

/// Parameters as a row has them. A number that is not finite is null.
pub fn text(params: &impl Serialize) -> String {
    canonical_json(&json!(params))
}

/// The parameters of a row; `None` if they are of another kind.
pub fn of_row<P: DeserializeOwned>(row: &Row) -> Option<P> {
    serde_json::from_str(&row.params).ok()
}
