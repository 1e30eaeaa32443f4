//! The style sheet that every page has: the colours of light and dark, then the rules.

/// Colours on a light page, as declarations.
const LIGHT: &str = include_str!("../assets/light.css");
/// Colours on a dark page; what is not here is as on a light one.
const DARK: &str = include_str!("../assets/dark.css");
/// What uses them.
const RULES: &str = concat!(include_str!("../assets/style.css"), include_str!("../assets/robot.css"));

/// The style sheet. The script of a report sets `data-theme`, the reader's choice. A page without it follows the system. Paper is light.
pub fn sheet() -> String {
    format!(
        ":root {{\n{LIGHT}}}\n:root[data-theme=\"dark\"] {{\n{DARK}}}\n\
         @media screen and (prefers-color-scheme: dark) {{\n:root:not([data-theme]) {{\n{DARK}}}\n}}\n{RULES}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// The names between a prefix and the first character that no name has.
    fn names<'a>(text: &'a str, before: &str) -> BTreeSet<&'a str> {
        text.split(before)
            .skip(1)
            .map(|rest| rest.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-')).next().unwrap_or_default())
            .collect()
    }

    #[test]
    fn every_colour_that_is_used_is_set_light_and_dark() {
        let (light, dark) = (names(LIGHT, "--"), names(DARK, "--"));
        assert!(light.len() > 40 && light == dark, "{:?}", light.symmetric_difference(&dark).collect::<Vec<_>>());
        let set = names(RULES, " --").into_iter().chain(light).collect::<BTreeSet<_>>();
        let used = names(RULES, "var(--");
        assert!(used.len() > 30 && used.is_subset(&set), "{:?}", used.difference(&set).collect::<Vec<_>>());
    }

    #[test]
    fn a_page_without_a_script_follows_the_system() {
        let sheet = sheet();
        assert_eq!(sheet.matches(DARK).count(), 2, "for the reader's choice and for the system's");
        assert_eq!(sheet.matches("@media screen and (prefers-color-scheme: dark) {\n:root:not([data-theme]) {").count(), 1);
    }
}
