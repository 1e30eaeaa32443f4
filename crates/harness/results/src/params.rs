//! The `params` column: one text for one set of parameters.

use serde_json::Value;

/// Writes JSON so that identical parameters have identical text: keys sorted, no spaces, numbers in their shortest exact decimals.
///
/// ```
/// let params = serde_json::json!({"states": 1000, "algorithm": "aba"});
/// assert_eq!(featherbench_results::canonical_json(&params), r#"{"algorithm":"aba","states":1000}"#);
/// ```
pub fn canonical_json(value: &Value) -> String {
    match value {
        Value::Object(map) => {
            // serde_json's own order depends on a feature that any crate of a build can enable.
            let mut entries: Vec<_> = map.iter().collect();
            entries.sort_by_key(|(key, _)| key.as_str());
            let entries: Vec<String> =
                entries.into_iter().map(|(key, value)| format!("{}:{}", Value::from(key.as_str()), canonical_json(value))).collect();
            format!("{{{}}}", entries.join(","))
        }
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(canonical_json).collect();
            format!("[{}]", items.join(","))
        }
        leaf => leaf.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::canonical_json;

    #[test]
    fn keys_are_sorted_at_every_level_and_text_is_escaped() {
        let value = serde_json::json!({"b": [1, {"z": null, "a": "\"\n</script>"}], "a": 0.1, "é": true});
        let text = canonical_json(&value);
        assert_eq!(text, r#"{"a":0.1,"b":[1,{"a":"\"\n</script>","z":null}],"é":true}"#);
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
    }
}
