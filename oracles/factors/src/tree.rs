//! The tree of a mass matrix, and where its entries are.

/// A tree of dofs in an order, and the stored entries of its mass matrix.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tree {
    /// The dof that each dof hangs on, in depth-first order.
    parents: Vec<Option<usize>>,
    reversed: bool,
}

impl Tree {
    /// The tree of these parents; with `reversed` its dofs have the places from the last to the first.
    #[must_use]
    pub fn new(parents: &[Option<usize>], reversed: bool) -> Self {
        Self { parents: parents.to_vec(), reversed }
    }

    /// Dofs.
    #[must_use]
    pub fn size(&self) -> usize {
        self.parents.len()
    }

    /// The stored entries of M, row after row of the tree-sparse layout, as (row, column) in the order of the tree with row ≥ column.
    #[must_use]
    pub fn entries(&self) -> Vec<(usize, usize)> {
        let mut entries = Vec::new();
        for dof in 0..self.size() {
            let path = path(&self.parents, dof);
            entries.extend(path.into_iter().map(|other| {
                let (a, b) = (self.place(dof), self.place(other));
                (a.max(b), a.min(b))
            }));
        }
        entries
    }

    /// The place of a dof.
    #[must_use]
    pub fn place(&self, dof: usize) -> usize {
        if self.reversed { self.size() - 1 - dof } else { dof }
    }

    /// Numbers in the order of the tree, from or to those of the dofs.
    pub fn arrange(&self, x: &mut [f64]) {
        if self.reversed {
            x.reverse();
        }
    }
}

/// The dofs from the root to this one.
pub(crate) fn path(parents: &[Option<usize>], dof: usize) -> Vec<usize> {
    let mut path: Vec<usize> = std::iter::successors(Some(dof), |&dof| parents[dof]).collect();
    path.reverse();
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_of_the_lower_triangle_in_either_order() {
        let parents = [None, Some(0), Some(0), Some(2)];
        let natural = Tree::new(&parents, false).entries();
        assert_eq!(natural, [(0, 0), (1, 0), (1, 1), (2, 0), (2, 2), (3, 0), (3, 2), (3, 3)]);
        let reversed = Tree::new(&parents, true).entries();
        assert_eq!(reversed, [(3, 3), (3, 2), (2, 2), (3, 1), (1, 1), (3, 0), (1, 0), (0, 0)]);
    }
}
