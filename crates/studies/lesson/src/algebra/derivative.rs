//! Derivatives of expressions: each node's from those of its operands, oldest first.

use super::{Algebra, Expression, Node};

impl Algebra {
    /// ∂f/∂x for a symbol x.
    pub fn derivative(&mut self, f: Expression, x: Expression) -> Expression {
        let needed = self.needed(&[f]);
        let zero = self.number(0.0);
        let mut slopes = vec![zero; f.0 + 1];
        for at in (0..=f.0).filter(|at| needed[*at]) {
            slopes[at] = match self.nodes[at] {
                Node::Number(_) => zero,
                Node::Symbol(_) => self.number(if at == x.0 { 1.0 } else { 0.0 }),
                Node::Sum(a, b) => self.add(slopes[a.0], slopes[b.0]),
                Node::Difference(a, b) => self.sub(slopes[a.0], slopes[b.0]),
                Node::Product(a, b) => {
                    let (first, second) = (self.mul(slopes[a.0], b), self.mul(a, slopes[b.0]));
                    self.add(first, second)
                }
                // (a/b)′ = (a′ − (a/b) b′)/b
                Node::Quotient(a, b) => {
                    let part = self.mul(Expression(at), slopes[b.0]);
                    let over = self.sub(slopes[a.0], part);
                    self.div(over, b)
                }
                Node::Sine(a) => {
                    let cosine = self.cos(a);
                    self.mul(cosine, slopes[a.0])
                }
                Node::Cosine(a) => {
                    let sine = self.sin(a);
                    let down = self.negative(sine);
                    self.mul(down, slopes[a.0])
                }
            };
        }
        slopes[f.0]
    }
}
