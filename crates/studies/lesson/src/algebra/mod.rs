//! Expressions: numbers, symbols, sums, products, quotients, sines and cosines; their derivatives, values and source text.
//!
//! All expressions live in one [`Algebra`], which keeps each one once: a common part is computed once, whatever uses it. An operand is always
//! older than its result. So the order of the nodes is an order of evaluation, and nothing here calls itself.

mod derivative;
mod source;

pub use source::Language;

use featherbench_spatial::Real;
use std::collections::HashMap;
use thiserror::Error;

/// An expression of one [`Algebra`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Expression(usize);

/// What an expression is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Node {
    /// The bits of a finite number.
    Number(u64),
    /// The index of a symbol.
    Symbol(usize),
    Sum(Expression, Expression),
    Difference(Expression, Expression),
    Product(Expression, Expression),
    Quotient(Expression, Expression),
    Sine(Expression),
    Cosine(Expression),
}

/// Why an expression has no value or text.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum AlgebraError {
    /// A symbol that is in no list of arguments.
    #[error("the symbol '{symbol}' is not among the arguments; add it to them")]
    Unbound {
        /// Its name.
        symbol: String,
    },
    /// Names and values of unequal count.
    #[error("{names} arguments are named, but {values} values are given")]
    Count {
        /// Names.
        names: usize,
        /// Values.
        values: usize,
    },
    /// A name that is no identifier in every language.
    #[error("'{name}' is no name for a function or an argument: a letter, then letters, digits and underscores")]
    Name {
        /// The name.
        name: String,
    },
    /// Lists that should be as long as each other.
    #[error("{what}: {found} are given, {due} are due")]
    Shape {
        /// Which.
        what: &'static str,
        /// Found.
        found: usize,
        /// Due.
        due: usize,
    },
}

/// A store of expressions.
///
/// ```
/// use featherbench_lesson::Algebra;
/// let mut a = Algebra::default();
/// let x = a.symbol("x");
/// let (sine, square) = (a.sin(x), a.mul(x, x));
/// let f = a.mul(square, sine);
/// // (x² sin x)′ = 2x sin x + x² cos x
/// let slope = a.derivative(f, x);
/// let known = 2.0 * 0.5 * f64::sin(0.5) + 0.25 * f64::cos(0.5);
/// assert!((a.evaluate(&[slope], &["x"], &[0.5])?[0] - known).abs() < 1e-15);
/// # Ok::<(), featherbench_lesson::AlgebraError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Algebra {
    nodes: Vec<Node>,
    known: HashMap<Node, Expression>,
    symbols: Vec<String>,
}

impl Algebra {
    fn keep(&mut self, node: Node) -> Expression {
        let next = Expression(self.nodes.len());
        let kept = *self.known.entry(node).or_insert(next);
        if kept == next {
            self.nodes.push(node);
        }
        kept
    }

    /// How many different parts all expressions have.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no expression yet.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// A number.
    pub fn number(&mut self, value: f64) -> Expression {
        // −0 is 0 here: both are the same number.
        self.keep(Node::Number((value + 0.0).to_bits()))
    }

    /// The symbol of this name, always the same.
    pub fn symbol(&mut self, name: &str) -> Expression {
        let index = self.symbols.iter().position(|known| known == name).unwrap_or_else(|| {
            self.symbols.push(name.into());
            self.symbols.len() - 1
        });
        self.keep(Node::Symbol(index))
    }

    /// The value of a number, `None` of anything else.
    fn value(&self, of: Expression) -> Option<f64> {
        match self.nodes[of.0] {
            Node::Number(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// a + b.
    pub fn add(&mut self, a: Expression, b: Expression) -> Expression {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => self.number(x + y),
            (Some(0.0), _) => b,
            (_, Some(0.0)) => a,
            // Sums commute: each is kept in one order.
            _ => self.keep(Node::Sum(a.min(b), a.max(b))),
        }
    }

    /// a − b.
    pub fn sub(&mut self, a: Expression, b: Expression) -> Expression {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => self.number(x - y),
            (_, Some(0.0)) => a,
            _ if a == b => self.number(0.0),
            _ => self.keep(Node::Difference(a, b)),
        }
    }

    /// a · b.
    pub fn mul(&mut self, a: Expression, b: Expression) -> Expression {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => self.number(x * y),
            (Some(0.0), _) | (_, Some(0.0)) => self.number(0.0),
            (Some(1.0), _) => b,
            (_, Some(1.0)) => a,
            _ => self.keep(Node::Product(a.min(b), a.max(b))),
        }
    }

    /// a / b.
    pub fn div(&mut self, a: Expression, b: Expression) -> Expression {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) if y != 0.0 => self.number(x / y),
            (_, Some(1.0)) => a,
            _ => self.keep(Node::Quotient(a, b)),
        }
    }

    /// −a.
    pub fn negative(&mut self, a: Expression) -> Expression {
        let minus = self.number(-1.0);
        self.mul(minus, a)
    }

    /// sin a.
    pub fn sin(&mut self, a: Expression) -> Expression {
        if self.value(a) == Some(0.0) { a } else { self.keep(Node::Sine(a)) }
    }

    /// cos a.
    pub fn cos(&mut self, a: Expression) -> Expression {
        if self.value(a) == Some(0.0) { self.number(1.0) } else { self.keep(Node::Cosine(a)) }
    }

    /// The product of all.
    pub fn product(&mut self, factors: &[Expression]) -> Expression {
        let one = self.number(1.0);
        factors.iter().fold(one, |product, &factor| self.mul(product, factor))
    }

    /// The sum of all.
    pub fn sum(&mut self, terms: &[Expression]) -> Expression {
        let zero = self.number(0.0);
        terms.iter().fold(zero, |sum, &term| self.add(sum, term))
    }

    /// The operands of an expression.
    fn operands(&self, of: usize) -> impl Iterator<Item = usize> {
        let both = match self.nodes[of] {
            Node::Number(_) | Node::Symbol(_) => [None, None],
            Node::Sum(a, b) | Node::Difference(a, b) | Node::Product(a, b) | Node::Quotient(a, b) => [Some(a.0), Some(b.0)],
            Node::Sine(a) | Node::Cosine(a) => [Some(a.0), None],
        };
        both.into_iter().flatten()
    }

    /// Of each node whether one of the results needs it.
    fn needed(&self, results: &[Expression]) -> Vec<bool> {
        let mut needed = vec![false; self.nodes.len()];
        results.iter().for_each(|result| needed[result.0] = true);
        // Operands are older: one sweep from the newest node reaches all of them if it looks at the marks as they are set.
        for node in (0..self.nodes.len()).rev() {
            if needed[node] {
                self.operands(node).for_each(|operand| needed[operand] = true);
            }
        }
        needed
    }

    /// The values of some results, in any scalar.
    ///
    /// # Errors
    /// [`AlgebraError`] if names and values differ in number, or a result needs a symbol that has no name.
    pub fn evaluate<T: Real>(&self, results: &[Expression], names: &[&str], values: &[T]) -> Result<Vec<T>, AlgebraError> {
        if names.len() != values.len() {
            return Err(AlgebraError::Count { names: names.len(), values: values.len() });
        }
        let needed = self.needed(results);
        let mut found = vec![T::zero(); self.nodes.len()];
        for (at, node) in self.nodes.iter().enumerate().filter(|(at, _)| needed[*at]) {
            found[at] = match *node {
                Node::Number(bits) => T::from_f64(f64::from_bits(bits)),
                Node::Symbol(symbol) => {
                    let symbol = &self.symbols[symbol];
                    let place = names.iter().position(|name| name == symbol);
                    values[place.ok_or_else(|| AlgebraError::Unbound { symbol: symbol.clone() })?]
                }
                Node::Sum(a, b) => found[a.0] + found[b.0],
                Node::Difference(a, b) => found[a.0] - found[b.0],
                Node::Product(a, b) => found[a.0] * found[b.0],
                Node::Quotient(a, b) => found[a.0] / found[b.0],
                Node::Sine(a) => found[a.0].sin_cos().0,
                Node::Cosine(a) => found[a.0].sin_cos().1,
            };
        }
        Ok(results.iter().map(|result| found[result.0]).collect())
    }
}
