//! Numbers for readers.

/// Two significant digits, in scientific form where it is shorter: `3.2e-14`, `0.25`, `1200`.
pub fn short(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".into()
    } else if !(1e-3..1e6).contains(&size) {
        format!("{value:.1e}").replace(".0e", "e")
    } else if size >= 100.0 || value.fract() == 0.0 {
        format!("{value:.0}")
    } else {
        let decimals = (1 - size.log10().floor() as i32).max(0) as usize;
        format!("{value:.decimals$}")
    }
}

/// Three digits, always in scientific form, so that columns of them are easy to compare: `3.21e-14`.
pub fn scientific(value: f64) -> String {
    if value == 0.0 { "0".into() } else { format!("{value:.2e}") }
}

/// Decades with a sign and one digit, rounded down: 0.99 decades are `+0.9`, not `+1.0`.
pub fn decades(margin: f64) -> String {
    let tenths = (margin * 10.0).floor() / 10.0;
    format!("{}{:.1}", if tenths < 0.0 { "−" } else { "+" }, tenths.abs())
}

/// A count with its noun: `1 row`, `12 300 rows`, `2 bodies`.
pub fn count(number: usize, noun: &str) -> String {
    let many = match noun.strip_suffix('y') {
        Some(stem) if !stem.ends_with(['a', 'e', 'o', 'u']) => format!("{stem}ies"),
        _ => format!("{noun}s"),
    };
    format!("{} {}", grouped(number), if number == 1 { noun } else { &many })
}

/// Groups of three digits with narrow spaces.
pub fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() * 2);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A text as the beginning of a sentence.
pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Names in a sentence: `a`, `a and b`, `a, b and c`.
pub fn listed(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Lines of a table for a terminal: the columns `words` begin at the left, the others, which are numbers, end at the right.
pub fn aligned<const N: usize>(lines: &[[String; N]], words: &[usize]) -> Vec<String> {
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    let cell = |(column, text): (usize, &String)| {
        let width = widths[column];
        if words.contains(&column) { format!("{text:<width$}") } else { format!("{text:>width$}") }
    };
    lines.iter().map(|line| line.iter().enumerate().map(cell).collect::<Vec<_>>().join("  ").trim_end().to_owned()).collect()
}

/// The larger of two numbers; NaN when either is, so that a fold keeps every NaN.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// The smaller of two numbers; NaN when either is.
pub fn smaller(a: f64, b: f64) -> f64 {
    -larger(-a, -b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!([0.0, 3.21e-14, 0.25, 1.0, 1234.4, 0.012, 2e9].map(short), ["0", "3.2e-14", "0.25", "1", "1234", "0.012", "2e9"]);
        assert_eq!([0.99, -0.01, 16.0, -2.34].map(decades), ["+0.9", "−0.1", "+16.0", "−2.4"]);
        assert_eq!([grouped(7), grouped(1234), grouped(1_234_567)], ["7", "1\u{202f}234", "1\u{202f}234\u{202f}567"]);
        assert_eq!((count(1, "row"), count(0, "row")), ("1 row".into(), "0 rows".into()));
        assert_eq!((count(1, "body"), count(2, "body"), count(2, "key")), ("1 body".into(), "2 bodies".into(), "2 keys".into()));
        assert_eq!(listed(&["a".into(), "b".into(), "c".into()]), "a, b and c");
        let table = [["engine", "time"], ["ours", "1"]].map(|line| line.map(str::to_owned));
        assert_eq!(aligned(&table, &[0]), ["engine  time", "ours       1"]);
        assert_eq!(["all known", "1 row", ""].map(capitalised), ["All known", "1 row", ""]);
    }
}
