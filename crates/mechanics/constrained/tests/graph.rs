//! Graphs with loops: cycles, Grübler's count, true mobility, errors.

use featherbench_constrained::library::{Biped, Bricard, Ladder, Squeezer};
use featherbench_constrained::stabilise::Projection;
use featherbench_constrained::{BadGraph, BadMechanism, Edge, Graph, LoopJoint, LoopMotion, Mechanism, Mobility, singular_values};
use featherbench_model::{Description, Placement, integrate, neutral};
use featherbench_robots::Random;
use nalgebra::DMatrix;

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

#[test]
fn bad_loop_joints_are_refused_by_name() {
    let description = featherbench_robots::Family::parse("chain:n=3").unwrap().generate().unwrap();
    let refused = |first: Option<&str>, second: Option<&str>, description: &Description| {
        let place = Placement::default();
        let joint = LoopJoint {
            name: "closing".into(),
            first: first.map(Into::into),
            first_placement: place,
            second: second.map(Into::into),
            second_placement: place,
            motion: LoopMotion::Spherical,
        };
        Mechanism::new(description, &[joint], |_| Vec::new()).unwrap_err()
    };
    let due = BadMechanism::NoBody { joint: "closing".into(), body: "nothing".into() };
    assert_eq!(refused(None, Some("nothing"), &description), due);
    assert!(matches!(refused(None, None, &description), BadMechanism::Graph(BadGraph::SelfLoop { .. })));
    assert!(matches!(refused(None, None, &Description::default()), BadMechanism::Tree(_)));
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

/// Grübler's count and the truth at random configurations that close the loops, and at flat ones.
#[test]
fn mobility_is_what_the_rank_says() {
    let ladder = |windows| Ladder { windows, ..Ladder::default() };
    let one_of = |mechanism: Mechanism, start: Vec<f64>, space: usize, gruebler: i64, mobility: usize| {
        assert_eq!(mechanism.graph.gruebler(space), gruebler, "{:?}", mechanism.graph.links());
        let model = &mechanism.model;
        let random = &mut Random::new(5, 5);
        let mut counted = 0;
        for _ in 0..20 {
            let step: Vec<f64> = (0..model.topology.nv()).map(|_| random.uniform(-0.2, 0.2)).collect();
            let mut q = integrate(&model.topology, &start, &step).unwrap();
            Projection::default().configuration(model, &mechanism.constraints, &mut q).unwrap();
            let found = Mobility::at(model, &mechanism.constraints, &q).unwrap();
            assert!(found.residual <= 1e-12);
            assert_eq!(found.freedom(), mobility, "{:?}", found.singular_values);
            // The count is exact: ten powers of ten lie between the least that counts and the largest that does not.
            if let Some(rest) = found.singular_values.get(found.rank) {
                let kept = found.singular_values[found.rank - 1];
                assert!(kept > 1e-4 * found.singular_values[0] && *rest < 1e-11 * kept, "{:?}", found.singular_values);
            }
            counted += 1;
        }
        assert_eq!(counted, 20);
    };
    one_of(ladder(1).mechanism().unwrap(), ladder(1).spread(0.7), 3, 1, 1);
    one_of(ladder(2).mechanism().unwrap(), ladder(2).spread(0.7), 3, 1, 1);
    one_of(Bricard::default().mechanism().unwrap(), vec![0.0; 5], 6, 0, 1);
    one_of(Squeezer::default().mechanism().unwrap(), Squeezer::start().to_vec(), 3, 1, 1);
    let biped = Biped::default().mechanism().unwrap();
    let upright = neutral::<f64>(&biped.model.topology);
    one_of(biped, upright, 6, 6, 12);
    // Flat: every window loses a row.
    for windows in [1, 2, 40] {
        let mechanism = ladder(windows).mechanism().unwrap();
        for angle in [std::f64::consts::FRAC_PI_2, -std::f64::consts::FRAC_PI_2] {
            let flat = Mobility::at(&mechanism.model, &mechanism.constraints, &ladder(windows).spread(angle)).unwrap();
            assert_eq!(flat.freedom(), windows + 1);
        }
        // One configuration that is not singular tells.
        let (flat, bent) = (ladder(windows).spread(std::f64::consts::FRAC_PI_2), ladder(windows).spread(0.5));
        let generic = Mobility::generic(&mechanism.model, &mechanism.constraints, [&*flat, &*bent]).unwrap().unwrap();
        // Five rows of each window, of which two are independent.
        assert_eq!((generic.freedom(), generic.redundant(&mechanism.constraints)), (1, 3 * windows));
    }
}

/// Singular values against those of a matrix that is made of them.
#[test]
fn singular_values_are_those_of_the_construction() {
    let random = &mut Random::new(8, 8);
    for (rows, columns) in [(6, 6), (9, 4), (3, 8)] {
        let orthogonal = |n: usize, random: &mut Random| DMatrix::from_fn(n, n, |_, _| random.uniform(-1.0, 1.0)).qr().q();
        let due = [3.0, 1.0, 1e-5, 1e-9, 0.0, 0.0];
        let count = rows.min(columns);
        let mut middle = DMatrix::zeros(rows, columns);
        (0..count).for_each(|k| middle[(k, k)] = due[k]);
        let matrix = orthogonal(rows, random) * middle * orthogonal(columns, random).transpose();
        let found = singular_values(&matrix);
        assert_eq!(found.len(), count);
        // Products of orthogonal matrices round to a few ε of the largest.
        assert!(found.iter().zip(due).all(|(found, due)| (found - due).abs() < 3e-15), "{found:?}");
    }
}

/// A loop joint on a body that is merged into its parent has the rows of the same joint on the parent.
#[test]
fn loop_joints_reach_merged_bodies() {
    let mut description = featherbench_robots::Family::parse("chain:n=3").unwrap().generate().unwrap();
    let offset = Placement { rotation: [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0], translation: [0.1, 0.2, 0.3] };
    let joint = featherbench_model::JointDescription { placement: offset, ..Default::default() };
    let tip = description.bodies[2].name.clone();
    description.bodies.push(featherbench_model::BodyDescription {
        name: "tool".into(),
        parent: Some(2),
        mass: 0.0,
        com: [0.0; 3],
        inertia: [0.0; 6],
        joint,
    });
    let closing = |second: &str, second_placement| LoopJoint {
        name: "closing".into(),
        first: None,
        first_placement: Placement::default(),
        second: Some(second.into()),
        second_placement,
        motion: LoopMotion::Revolute,
    };
    let rows = |joint: LoopJoint| {
        let mechanism = Mechanism::new(&description, &[joint], |_| Vec::new()).unwrap();
        assert_eq!((mechanism.graph.links().len(), mechanism.graph.loops()), (3, 1));
        let mut rows = featherbench_constrained::Rows::new(&mechanism.constraints);
        rows.run(&mechanism.model, &mechanism.constraints, &[0.3, 0.5, 0.7], &[1.0, -0.4, 0.2]).unwrap();
        let numbers: Vec<f64> = rows.residuals().chain(rows.biases()).chain(rows.jacobian().iter().copied()).collect();
        numbers
    };
    let (merged, direct) = (rows(closing("tool", Placement::default())), rows(closing(&tip, offset)));
    assert!(merged.iter().any(|x| x.abs() > 0.1));
    // One product of placements more: a rounding or two of numbers near one.
    assert!(merged.iter().zip(&direct).all(|(a, b)| (a - b).abs() < 1e-14), "{merged:?} {direct:?}");
}
