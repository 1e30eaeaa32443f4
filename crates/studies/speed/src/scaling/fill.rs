//! Fill-in of a Cholesky factorization of a tree-sparse matrix, by the order of elimination.
//!
//! No number is factorized. The factor's pattern follows from that of M alone (J. W. H. Liu, *The role of elimination trees in sparse
//! factorization*, 1990). Its elimination tree takes time O(|M| log n). The length of each column follows by a walk of its entries' subtrees,
//! in time O(|L|) and memory O(n).
//!
//! | order | fill-in of a tree-sparse M |
//! |---|---|
//! | leaves first | none: all neighbours of a leaf are on one path, where M is full |
//! | root first | everything: the root's neighbours are all dofs of its tree |
//! | minimum degree | none: a dof of least degree has its descendants on one path (below) |
//!
//! Dof v of depth d with s strict descendants has d − 1 + s neighbours. A leaf below it has at most d − 1 + s neighbours, all on its path.
//! So if v has the least degree of all, the leaf's path contains all descendants of v: v and its neighbours are one path, where M is full.
//! Eliminating v leaves the pattern of a tree. So the argument holds until the end.

use std::collections::BTreeSet;

/// An order of elimination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    LeavesFirst,
    RootFirst,
    MinimumDegree,
}

impl Order {
    pub(crate) const ALL: [Self; 3] = [Self::LeavesFirst, Self::RootFirst, Self::MinimumDegree];

    /// The word for it in rows.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::LeavesFirst => "leaves_first",
            Self::RootFirst => "root_first",
            Self::MinimumDegree => "minimum_degree",
        }
    }

    /// The dofs in the order in which they are eliminated.
    pub(crate) fn of(self, parents: &[Option<usize>]) -> Vec<usize> {
        match self {
            // Depth-first numbers: every dof comes after those that support it.
            Self::LeavesFirst => (0..parents.len()).rev().collect(),
            Self::RootFirst => (0..parents.len()).collect(),
            Self::MinimumDegree => minimum_degree(parents),
        }
    }
}

/// The size of a factor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Factor {
    /// Stored numbers, the diagonal included.
    pub(crate) stored: u64,
    /// Multiply-subtracts of the factorization: c (c + 1) / 2 of a column with c numbers below its diagonal.
    pub(crate) multiply_subtracts: u64,
}

/// The strict ancestors of a dof, the nearest first.
fn ancestors(parents: &[Option<usize>], dof: usize) -> impl Iterator<Item = usize> + '_ {
    std::iter::successors(parents[dof], |&dof| parents[dof])
}

/// The size of the factor for an order of elimination. M is nonzero where one dof supports the other.
pub(crate) fn factor(parents: &[Option<usize>], order: &[usize]) -> Factor {
    let n = parents.len();
    let mut place = vec![0; n];
    order.iter().enumerate().for_each(|(k, &dof)| place[dof] = k);
    // The pattern of M below its diagonal, row after row, in the places of the order.
    let mut rows: Vec<Vec<usize>> = vec![Vec::new(); n];
    for dof in 0..n {
        for other in ancestors(parents, dof) {
            let (low, high) = (place[dof].min(place[other]), place[dof].max(place[other]));
            rows[high].push(low);
        }
    }
    // The elimination tree, with shortcuts to the highest known ancestor.
    let (mut parent, mut highest) = (vec![None; n], vec![None; n]);
    for (row, columns) in rows.iter().enumerate() {
        for &column in columns {
            let mut at = column;
            while let Some(next) = highest[at].filter(|&next| next != row) {
                highest[at] = Some(row);
                at = next;
            }
            if highest[at].is_none() {
                (highest[at], parent[at]) = (Some(row), Some(row));
            }
        }
    }
    // Row i of L has the columns on the tree's paths from the columns of row i of M to i.
    let (mut below, mut seen) = (vec![0_u64; n], vec![usize::MAX; n]);
    for (row, columns) in rows.iter().enumerate() {
        seen[row] = row;
        for &column in columns {
            let mut at = column;
            while seen[at] != row {
                seen[at] = row;
                below[at] += 1;
                match parent[at] {
                    Some(next) => at = next,
                    None => break,
                }
            }
        }
    }
    let stored = n as u64 + below.iter().sum::<u64>();
    Factor { stored, multiply_subtracts: below.iter().map(|c| c * (c + 1) / 2).sum() }
}

/// The exact minimum degree order on the graph of eliminations; of equal degrees, the dof with the smallest number.
fn minimum_degree(parents: &[Option<usize>]) -> Vec<usize> {
    let n = parents.len();
    let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); n];
    for dof in 0..n {
        for other in ancestors(parents, dof) {
            neighbours[dof].push(other);
            neighbours[other].push(dof);
        }
    }
    neighbours.iter_mut().for_each(|list| list.sort_unstable());
    let mut waiting: BTreeSet<(usize, usize)> = (0..n).map(|dof| (neighbours[dof].len(), dof)).collect();
    let mut order = Vec::with_capacity(n);
    while let Some((_, dof)) = waiting.pop_first() {
        order.push(dof);
        let clique = std::mem::take(&mut neighbours[dof]);
        for &other in &clique {
            waiting.remove(&(neighbours[other].len(), other));
            neighbours[other] = joined(&neighbours[other], &clique, [dof, other]);
            waiting.insert((neighbours[other].len(), other));
        }
    }
    order
}

/// The union of two sorted lists without these two.
fn joined(a: &[usize], b: &[usize], without: [usize; 2]) -> Vec<usize> {
    let mut union = Vec::with_capacity(a.len().max(b.len()));
    let (mut a, mut b) = (a.iter().copied().peekable(), b.iter().copied().peekable());
    while let Some(next) = [a.peek(), b.peek()].into_iter().flatten().min().copied() {
        a.next_if_eq(&next);
        b.next_if_eq(&next);
        if !without.contains(&next) {
            union.push(next);
        }
    }
    union
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_robots::Random;

    /// The factor's size by elimination on a full table: a second route.
    fn by_table(parents: &[Option<usize>], order: &[usize]) -> Factor {
        let n = parents.len();
        let mut table = vec![vec![false; n]; n];
        for (a, b) in (0..n).flat_map(|dof| ancestors(parents, dof).map(move |other| (dof, other))) {
            (table[a][b], table[b][a]) = (true, true);
        }
        let (mut left, mut size) = (vec![true; n], Factor::default());
        for &dof in order {
            left[dof] = false;
            let clique: Vec<usize> = (0..n).filter(|&other| left[other] && table[dof][other]).collect();
            for &a in &clique {
                clique.iter().filter(|&&b| a != b).for_each(|&b| table[a][b] = true);
            }
            let below = clique.len() as u64;
            size.stored += 1 + below;
            size.multiply_subtracts += below * (below + 1) / 2;
        }
        size
    }

    /// A random forest in depth-first order.
    fn forest(n: usize, seed: u64) -> Vec<Option<usize>> {
        let (mut random, mut path, mut parents) = (Random::new(seed, 0), Vec::new(), Vec::new());
        for dof in 0..n {
            if random.below(3) == 0 {
                path.truncate(random.below(path.len() + 1));
            }
            parents.push(path.last().copied());
            path.push(dof);
        }
        parents
    }

    #[test]
    fn the_walk_agrees_with_elimination_on_a_table() {
        for seed in 0..40 {
            let parents = forest(1 + seed as usize, seed);
            let mut orders: Vec<Vec<usize>> = Order::ALL.iter().map(|order| order.of(&parents)).collect();
            // An order that fills in some places and not in others.
            let mut random = Random::new(seed, 1);
            let mut shuffled: Vec<usize> = (0..parents.len()).collect();
            (1..shuffled.len()).for_each(|k| shuffled.swap(k, random.below(k + 1)));
            orders.push(shuffled);
            for order in orders {
                assert_eq!(factor(&parents, &order), by_table(&parents, &order), "{parents:?} {order:?}");
            }
        }
    }

    #[test]
    fn leaves_first_and_minimum_degree_fill_nothing_and_root_first_everything() {
        for seed in 0..40 {
            let parents = forest(60, seed);
            let pattern = (0..60).map(|dof| 1 + ancestors(&parents, dof).count() as u64).sum::<u64>();
            let stored = |order: Order| factor(&parents, &order.of(&parents)).stored;
            assert_eq!((stored(Order::LeavesFirst), stored(Order::MinimumDegree)), (pattern, pattern));
            // A tree's dofs follow each other.
            let mut sizes: Vec<u64> = Vec::new();
            for parent in &parents {
                match (parent, sizes.last_mut()) {
                    (Some(_), Some(size)) => *size += 1,
                    _ => sizes.push(1),
                }
            }
            assert_eq!(stored(Order::RootFirst), sizes.iter().map(|size| size * (size + 1) / 2).sum::<u64>());
        }
    }
}
