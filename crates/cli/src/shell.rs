//! Command lines as text: words that are quoted where they must be, and read back.

/// A word as a shell takes it.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./=:,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\"'\"'")) }
}

/// The words of a text: split at blanks; quotes of either kind keep blanks in a word.
///
/// # Errors
/// A sentence, when a quote is not closed.
pub fn words(text: &str) -> Result<Vec<String>, String> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in text.chars() {
        match quote {
            Some(end) if c == end => quote = None,
            None if c == '"' || c == '\'' => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            None if c.is_whitespace() => words.extend(word.take()),
            _ => word.get_or_insert_default().push(c),
        }
    }
    if let Some(open) = quote {
        return Err(format!("a quote {open} is not closed in {text}"));
    }
    words.extend(word);
    Ok(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_quoted_is_read_back() {
        let list = ["run", "", "a b", "mine=sh 'my oracle.sh'", "x=\"a 'b'\"", "^agreement/panda/", "(a|b)$", "it's", "a\\b"];
        let line = list.map(quoted).join(" ");
        assert_eq!(words(&line).unwrap(), list);
        assert_eq!(quoted("--suite"), "--suite");
        assert!(words("a 'b").unwrap_err().contains("is not closed"));
    }
}
