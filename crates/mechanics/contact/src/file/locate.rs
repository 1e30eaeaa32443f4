//! Where a field stands in a text that is valid JSON.

/// Line and column, counted from 1, of the value at a path such as `contacts[2].friction.coulomb[0]`.
///
/// Where the path leads to nothing, the place of the last part that exists. None for the whole text (`.`).
pub(super) fn position_of(text: &str, path: &str) -> Option<(usize, usize)> {
    let steps: Vec<&str> = path.split(['.', '[', ']']).filter(|step| !step.is_empty()).collect();
    if steps.is_empty() {
        return None;
    }
    let mut place = skip_space(text, 0);
    for step in steps {
        match child(text, place, step) {
            Some(found) => place = found,
            None => break,
        }
    }
    let before = &text[..place];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    Some((before.matches('\n').count() + 1, before[line_start..].chars().count() + 1))
}

fn skip_space(text: &str, from: usize) -> usize {
    text[from..].find(|c: char| !c.is_ascii_whitespace()).map_or(text.len(), |by| from + by)
}

/// The place of a member of an object, or of an item of a list.
fn child(text: &str, place: usize, step: &str) -> Option<usize> {
    let list = text[place..].starts_with('[');
    if !list && !text[place..].starts_with('{') {
        return None;
    }
    let mut at = skip_space(text, place + 1);
    for index in 0.. {
        if text[at..].starts_with([']', '}']) || at >= text.len() {
            return None;
        }
        let found = if list {
            step.parse() == Ok(index)
        } else {
            let end = end_of(text, at);
            let key: Option<String> = serde_json::from_str(&text[at..end]).ok();
            at = skip_space(text, skip_space(text, end) + 1);
            key.as_deref() == Some(step)
        };
        if found {
            return Some(at);
        }
        at = skip_space(text, end_of(text, at));
        if text[at..].starts_with(',') {
            at = skip_space(text, at + 1);
        }
    }
    None
}

/// The end of the value that begins here.
fn end_of(text: &str, from: usize) -> usize {
    let (mut depth, mut quoted, mut escaped) = (0_usize, false, false);
    for (offset, byte) in text[from..].bytes().enumerate() {
        let here = from + offset;
        if quoted {
            match byte {
                _ if escaped => escaped = false,
                b'\\' => escaped = true,
                b'"' if depth == 0 => return here + 1,
                b'"' => quoted = false,
                _ => {}
            }
            continue;
        }
        match byte {
            b'"' => quoted = true,
            b'[' | b'{' => depth += 1,
            b']' | b'}' if depth > 1 => depth -= 1,
            b']' | b'}' => return if depth == 1 { here + 1 } else { here },
            b',' if depth == 0 => return here,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::position_of;

    #[test]
    fn places_are_found() {
        let text = "{\"a\": [1, {\"b, \\\"]\": 2,\n \"c\": [[3, 4],\n  [5, 6]]}], \"d\": \"x\"}";
        for (path, place) in [
            ("a", (1, 7)),
            ("a[0]", (1, 8)),
            ("a[1].c", (2, 7)),
            ("a[1].c[1][1]", (3, 7)),
            ("d", (3, 19)),
            // The part that exists.
            ("a[1].c[7]", (2, 7)),
            ("e", (1, 1)),
        ] {
            assert_eq!(position_of(text, path), Some(place), "{path}");
        }
        assert_eq!(position_of(text, "."), None);
    }
}
