//! Tree-sparse matrices of trees without a robot, and depth-first orders.

use crate::{common, ltdl};

use featherbench_dynamics::{NotATree, TreeSparse, depth_first_order};
use featherbench_robots::Random;
use ltdl::{matrix, topologies};

#[test]
fn a_tree_without_a_robot_has_the_matrix_of_the_robot() {
    for (name, topology) in topologies() {
        let of_robot = matrix::<f64>(&topology, 7);
        let mut by_parents = TreeSparse::of_parents(topology.dof_parents()).unwrap();
        assert_eq!((by_parents.size(), by_parents.values().len()), (topology.nv(), topology.stored()), "{name}");
        by_parents.fill(|i, j| of_robot.get(i, j));
        assert_eq!(by_parents, of_robot, "{name}");
        for dof in 0..topology.nv() {
            assert_eq!((by_parents.parent(dof), by_parents.path_length(dof)), (topology.dof_parents()[dof], topology.dof_depth(dof)));
        }
        assert_eq!((by_parents.parent(topology.nv()), by_parents.path_length(topology.nv())), (None, 0), "{name}: there is no such dof");
    }
    let nothing: TreeSparse<f64> = TreeSparse::of_parents(&[]).unwrap();
    assert_eq!((nothing.size(), nothing.into_ltdl().unwrap().factors().values().len()), (0, 0));
}

/// Renumbered at random, a tree is not depth-first; put in order again, it has the same rows as before.
#[test]
fn any_numbering_is_put_in_order() {
    let mut refused = 0;
    for (name, topology) in topologies() {
        let (n, parents) = (topology.nv(), topology.dof_parents());
        let mut random = Random::new(9, n as u64);
        let mut number: Vec<usize> = (0..n).collect();
        for k in (1..n).rev() {
            number.swap(k, random.below(k + 1));
        }
        let mut shuffled = vec![None; n];
        for (dof, parent) in parents.iter().enumerate() {
            shuffled[number[dof]] = parent.map(|parent| number[parent]);
        }
        refused += usize::from(TreeSparse::<f64>::of_parents(&shuffled).is_err());

        let order = depth_first_order(&shuffled).unwrap();
        let mut new = vec![n; n];
        for (place, &old) in order.iter().enumerate() {
            new[old] = place;
        }
        assert!(new.iter().all(|&place| place < n), "{name}: every dof once");
        let renumbered: Vec<_> = order.iter().map(|&old| shuffled[old].map(|parent| new[parent])).collect();
        let sorted = |matrix: TreeSparse<f64>| {
            let mut depths: Vec<usize> = (0..n).map(|dof| matrix.path_length(dof)).collect();
            depths.sort_unstable();
            depths
        };
        assert_eq!(sorted(TreeSparse::of_parents(&renumbered).unwrap()), sorted(TreeSparse::new(&topology)), "{name}");
        // An order that is depth-first already is kept.
        assert_eq!(depth_first_order(parents).unwrap(), (0..n).collect::<Vec<_>>(), "{name}");
    }
    assert!(refused > 50, "only {refused} orders were refused");
}

#[test]
fn what_is_not_a_tree_is_refused_by_name() {
    type Parents<'a> = &'a [Option<usize>];
    let cases: [(Parents, NotATree, Result<(), NotATree>); 6] = [
        (&[None, None, Some(0)], NotATree::NotDepthFirst { dof: 2 }, Ok(())),
        (&[Some(1), None], NotATree::NotDepthFirst { dof: 0 }, Ok(())),
        (&[Some(0)], NotATree::NotDepthFirst { dof: 0 }, Err(NotATree::Cycle { dof: 0 })),
        (&[None, Some(2), Some(1)], NotATree::NotDepthFirst { dof: 1 }, Err(NotATree::Cycle { dof: 1 })),
        (
            &[None, Some(2)],
            NotATree::NoSuchParent { dof: 1, parent: 2, count: 2 },
            Err(NotATree::NoSuchParent { dof: 1, parent: 2, count: 2 }),
        ),
        (
            &[Some(usize::MAX)],
            NotATree::NoSuchParent { dof: 0, parent: usize::MAX, count: 1 },
            Err(NotATree::NoSuchParent { dof: 0, parent: usize::MAX, count: 1 }),
        ),
    ];
    for (parents, as_it_is, in_order) in cases {
        assert_eq!(TreeSparse::<f64>::of_parents(parents).unwrap_err(), as_it_is, "{parents:?}");
        assert_eq!(depth_first_order(parents).map(drop), in_order, "{parents:?}");
    }
    assert!(NotATree::NotDepthFirst { dof: 2 }.to_string().contains("depth_first_order"));
}

/// A million dofs, also on one path: nothing calls itself. A binary tree of them is factored in place.
#[test]
fn size_is_no_limit() {
    let n = 1_000_000;
    let backwards: Vec<_> = (0..n).map(|dof| if dof + 1 < n { Some(dof + 1) } else { None }).collect();
    let order = depth_first_order(&backwards).unwrap();
    assert!(order.iter().rev().enumerate().all(|(place, &old)| place == old));

    // By levels, then depth-first.
    let n = (1 << 15) - 1;
    let by_levels: Vec<_> = (0..n).map(|dof: usize| dof.checked_sub(1).map(|before| before / 2)).collect();
    let order = depth_first_order(&by_levels).unwrap();
    let mut new = vec![0; n];
    for (place, &old) in order.iter().enumerate() {
        new[old] = place;
    }
    let parents: Vec<_> = order.iter().map(|&old| by_levels[old].map(|parent| new[parent])).collect();
    let mut matrix = TreeSparse::of_parents(&parents).unwrap();
    assert_eq!(matrix.values().len(), 14 * (1 << 15) + 1, "Σ k 2^(k−1) = (D − 1) 2^D + 1 for D = 15 levels");
    matrix.fill(|i, j| if i == j { 2.0 } else { 1.0 / 1024.0 });
    let mut x = vec![1.0_f64; n];
    matrix.mul(&vec![1.0; n], &mut x).unwrap();
    matrix.into_ltdl().unwrap().solve(&mut x).unwrap();
    // The largest row sums to 2 + n/1024 = 34, in n roundings of the partial sums, half of that on average; |M⁻¹| is below 1.
    common::within("solution", common::distance(&x, &vec![1.0; n]), 17.0 * n as f64 * f64::EPSILON);
}
