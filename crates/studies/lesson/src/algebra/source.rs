//! Expressions as the source text of a function: one operation per statement, so that every language rounds alike.

use super::{Algebra, AlgebraError, Expression, Node};
use std::fmt::Write;

/// The language of an exported function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// `pub fn name(x: f64, …) -> [f64; n]`.
    Rust,
    /// `void name(double x, …, double out[n])`, of C99; it needs `math.h`.
    C,
    /// `def name(x, …)`, which returns a tuple; it needs the module `math`.
    Python,
}

impl Language {
    /// All of them.
    pub const ALL: [Language; 3] = [Language::Rust, Language::C, Language::Python];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Language::Rust => "rust",
            Language::C => "c",
            Language::Python => "python",
        }
    }

    /// A number with all its digits.
    fn number(self, value: f64) -> String {
        match self {
            Language::Rust => format!("{value:?}_f64"),
            Language::C | Language::Python => format!("{value:?}"),
        }
    }

    fn function(self, name: &str, argument: &str) -> String {
        match self {
            Language::Rust => format!("{argument}.{name}()"),
            Language::C => format!("{name}({argument})"),
            Language::Python => format!("math.{name}({argument})"),
        }
    }
}

fn is_name(name: &str) -> bool {
    let letter = |c: char| c.is_ascii_alphabetic();
    name.starts_with(letter) && name.chars().all(|c| letter(c) || c.is_ascii_digit() || c == '_')
}

impl Algebra {
    /// A function of these arguments with these results, as source text. Each statement is one operation of IEEE arithmetic.
    ///
    /// ```
    /// use featherbench_lesson::{Algebra, Language};
    /// let mut a = Algebra::default();
    /// let (x, y) = (a.symbol("x"), a.symbol("y"));
    /// let product = a.mul(x, y);
    /// let text = a.source(Language::C, "area", &[product], &["x", "y"])?;
    /// assert!(text.contains("const double t2 = x * y;") && text.contains("out[0] = t2;"));
    /// # Ok::<(), featherbench_lesson::AlgebraError>(())
    /// ```
    ///
    /// # Errors
    /// [`AlgebraError`] if a name is no identifier or a result needs a symbol that is no argument.
    pub fn source(&self, language: Language, name: &str, results: &[Expression], arguments: &[&str]) -> Result<String, AlgebraError> {
        if let Some(bad) = [name].iter().chain(arguments).find(|name| !is_name(name)) {
            return Err(AlgebraError::Name { name: (*bad).to_owned() });
        }
        let needed = self.needed(results);
        let mut lines = Vec::new();
        let mut texts = vec![String::new(); self.nodes.len()];
        for (at, node) in self.nodes.iter().enumerate().filter(|(at, _)| needed[*at]) {
            let of = |operand: Expression| texts[operand.0].as_str();
            let right = match *node {
                Node::Number(bits) => {
                    texts[at] = language.number(f64::from_bits(bits));
                    continue;
                }
                Node::Symbol(symbol) => {
                    let symbol = &self.symbols[symbol];
                    if !arguments.contains(&symbol.as_str()) {
                        return Err(AlgebraError::Unbound { symbol: symbol.clone() });
                    }
                    texts[at] = symbol.clone();
                    continue;
                }
                Node::Sum(a, b) => format!("{} + {}", of(a), of(b)),
                Node::Difference(a, b) => format!("{} - {}", of(a), of(b)),
                Node::Product(a, b) => format!("{} * {}", of(a), of(b)),
                Node::Quotient(a, b) => format!("{} / {}", of(a), of(b)),
                Node::Sine(a) => language.function("sin", of(a)),
                Node::Cosine(a) => language.function("cos", of(a)),
            };
            texts[at] = format!("t{at}");
            lines.push((at, right));
        }
        let out: Vec<&str> = results.iter().map(|result| texts[result.0].as_str()).collect();
        Ok(written(language, name, arguments, &lines, &out))
    }
}

fn written(language: Language, name: &str, arguments: &[&str], lines: &[(usize, String)], out: &[&str]) -> String {
    let typed = |of: &dyn Fn(&&str) -> String| arguments.iter().map(of).collect::<Vec<_>>().join(", ");
    let mut text = match language {
        Language::Rust => format!("pub fn {name}({}) -> [f64; {}] {{\n", typed(&|name| format!("{name}: f64")), out.len()),
        Language::C => {
            format!("#include <math.h>\n\nvoid {name}({}, double out[{}]) {{\n", typed(&|name| format!("double {name}")), out.len())
        }
        Language::Python => format!("import math\n\n\ndef {name}({}):\n", arguments.join(", ")),
    };
    for (at, right) in lines {
        // Writing to a String cannot fail.
        let _ = match language {
            Language::Rust => writeln!(text, "    let t{at} = {right};"),
            Language::C => writeln!(text, "    const double t{at} = {right};"),
            Language::Python => writeln!(text, "    t{at} = {right}"),
        };
    }
    match language {
        Language::Rust => text.push_str(&format!("    [{}]\n}}\n", out.join(", "))),
        Language::C => {
            out.iter().enumerate().for_each(|(k, result)| text.push_str(&format!("    out[{k}] = {result};\n")));
            text.push_str("}\n");
        }
        Language::Python => text.push_str(&format!("    return ({},)\n", out.join(", "))),
    }
    text
}
