//! Graphs with loops: cycles, true mobility, errors. Counts of dofs are asked by the study `contact`.

use featherbench_constrained::stabilise::Projection;
use featherbench_constrained::systems::{Biped, Bricard, Ladder, Squeezer};
use featherbench_constrained::{BadGraph, Edge, Graph, Mobility};
use featherbench_model::{integrate, neutral};
use featherbench_robots::Random;

fn hinge(name: &str, parent: Option<usize>, child: Option<usize>, cut: bool) -> Edge {
    Edge { name: name.into(), parent, child, freedom: 1, cut }
}

fn links(count: usize) -> Vec<String> {
    (0..count).map(|k| format!("link {k}")).collect()
}

#[test]
fn bad_graphs_are_refused_by_name() {
    let refused = |joints: Vec<Edge>, count: usize| Graph::new(links(count), joints).unwrap_err();
    let (ground, on_0) = (hinge("a", None, Some(0), false), hinge("b", Some(0), Some(1), false));
    assert_eq!(refused(vec![ground.clone()], 2), BadGraph::Orphan { link: "link 1".into() });
    // A cut joint does not carry a link.
    let cut = hinge("b", Some(0), Some(1), true);
    assert_eq!(refused(vec![ground.clone(), cut], 2), BadGraph::Orphan { link: "link 1".into() });
    let twice = vec![ground.clone(), on_0.clone(), hinge("c", None, Some(1), false)];
    let due = BadGraph::TwoParents { link: "link 1".into(), first: "b".into(), second: "c".into() };
    assert_eq!(refused(twice, 2), due);
    // 1 → 2 → 3 → 1, beside a link on the world.
    let round = [("b", 3, 1), ("c", 1, 2), ("d", 2, 3)].map(|(name, parent, child)| hinge(name, Some(parent), Some(child), false));
    let found = refused([vec![ground.clone()], round.to_vec()].concat(), 4);
    assert!(matches!(&found, BadGraph::CycleWithoutCut { links } if links.len() == 3 && !links.contains(&"link 0".into())), "{found}");
    // A four-bar whose last joint ends on the world, and is not cut.
    let found = refused(vec![ground.clone(), on_0.clone(), hinge("c", Some(1), None, false)], 2);
    assert_eq!(found, BadGraph::CycleWithoutCut { links: vec!["link 1".into(), "link 0".into()] });
    assert!(matches!(refused(vec![hinge("a", None, Some(5), false)], 1), BadGraph::NoLink { link: 5, links: 1, .. }));
    assert!(matches!(refused(vec![hinge("a", Some(0), Some(0), false)], 1), BadGraph::SelfLoop { .. }));
    assert!(matches!(refused(vec![Edge { freedom: 7, ..ground.clone() }], 1), BadGraph::Freedom { freedom: 7, .. }));
    let found = refused(vec![ground.clone(), hinge("a", Some(0), Some(1), false)], 2);
    assert_eq!(found, BadGraph::DuplicateName { name: "a".into() });
}

/// The graph of chains of windows, by counting: each cycle has its own cut joint and no other, and closes.
#[test]
fn fundamental_cycles_close() {
    let mechanisms = [
        Ladder { windows: 4, ..Ladder::default() }.mechanism().unwrap(),
        Bricard::default().mechanism().unwrap(),
        Squeezer::default().mechanism().unwrap(),
        Biped::default().mechanism().unwrap(),
    ];
    // (loops, links and joints of each cycle)
    let due = [(4, 4), (1, 6), (3, 0), (6, 4)];
    for (mechanism, (loops, length)) in mechanisms.iter().zip(due) {
        let graph = &mechanism.graph;
        assert_eq!((graph.loops(), graph.cycles().len()), (loops, loops));
        for cycle in graph.cycles() {
            assert_eq!(cycle.links.len(), cycle.joints.len());
            if length > 0 {
                assert_eq!(cycle.joints.len(), length);
            }
            assert_eq!(cycle.joints.iter().filter(|joint| graph.joints()[**joint].cut).count(), 1);
            // Joint k connects link k with link k + 1, and the cut joint the last with the first.
            for (k, joint) in cycle.joints.iter().enumerate() {
                let Edge { parent, child, .. } = graph.joints()[*joint];
                let ends = [cycle.links[k], cycle.links[(k + 1) % cycle.links.len()]];
                assert!(ends == [parent, child] || ends == [child, parent], "{cycle:?}");
            }
        }
    }
    let squeezer = &mechanisms[2].graph;
    let name = |joint: &usize| squeezer.joints()[*joint].name.clone();
    let lengths: Vec<Vec<String>> = squeezer.cycles().iter().map(|cycle| cycle.joints.iter().map(name).collect()).collect();
    assert_eq!(lengths[0], ["K3", "K1", "K2", "E of K3"]);
    assert_eq!(lengths[1], ["K4", "K5", "K1", "K2", "E of K4"]);
}

/// The rank is exact: ten powers of ten lie between the least singular value that counts and the largest that does not.
#[test]
fn ranks_are_clear() {
    let ladder = |windows| Ladder { windows, ..Ladder::default() };
    let biped = Biped::default().mechanism().unwrap();
    let upright = neutral::<f64>(&biped.model.topology);
    for (mechanism, start) in [
        (ladder(1).mechanism().unwrap(), ladder(1).spread(0.7)),
        (ladder(2).mechanism().unwrap(), ladder(2).spread(0.7)),
        (Bricard::default().mechanism().unwrap(), vec![0.0; 5]),
        (Squeezer::default().mechanism().unwrap(), Squeezer::start().to_vec()),
        (biped, upright),
    ] {
        let model = &mechanism.model;
        let random = &mut Random::new(5, 5);
        for _ in 0..20 {
            let step: Vec<f64> = (0..model.topology.nv()).map(|_| random.uniform(-0.2, 0.2)).collect();
            let mut q = integrate(&model.topology, &start, &step).unwrap();
            Projection::default().configuration(model, &mechanism.constraints, &mut q).unwrap();
            let found = Mobility::at(model, &mechanism.constraints, &q).unwrap();
            let (kept, rest) = (found.singular_values[found.rank - 1], found.singular_values.get(found.rank).copied().unwrap_or(0.0));
            assert!(kept > 1e-4 * found.singular_values[0] && rest < 1e-11 * kept, "{:?}", found.singular_values);
        }
    }
    // Flat: every window loses a row.
    for windows in [1, 2, 40] {
        let mechanism = ladder(windows).mechanism().unwrap();
        for angle in [std::f64::consts::FRAC_PI_2, -std::f64::consts::FRAC_PI_2] {
            let flat = Mobility::at(&mechanism.model, &mechanism.constraints, &ladder(windows).spread(angle)).unwrap();
            assert_eq!(flat.freedom(), windows + 1);
        }
    }
}
