//! Every claim is decided by its numbers.

use featherbench_lesson::{Holds, claims};
use std::collections::BTreeSet;

#[test]
fn names_differ_and_words_are_there() {
    let mut seen = BTreeSet::new();
    for claim in claims::all() {
        assert!(seen.insert(claim.id), "{} is twice", claim.id);
        assert!(![claim.place, claim.title, claim.says, claim.right].iter().any(|words| words.is_empty()), "{}", claim.id);
        let numbers = (claim.numbers)(1).unwrap();
        let names: BTreeSet<&String> = numbers.iter().map(|number| &number.name).collect();
        assert_eq!(names.len(), numbers.len(), "{} has a number twice", claim.id);
    }
    assert_eq!(seen.len(), 27);
}

/// Two routes agree, and so do the two routes of each separation.
#[test]
fn both_routes_agree() {
    let mut count = 0;
    for claim in claims::all() {
        for number in (claim.numbers)(1).unwrap() {
            println!("{:<24} {:<70} {:>24} {:e} {:?}", claim.id, number.name, number.corrected, number.error(), number.separation_error());
            // What the gates of the study ask; crates/studies/registry has no looser one.
            assert!(number.error() < 1e-12, "{} {number:?}", claim.id);
            assert!(number.separation_error().is_none_or(|error| error < 1e-12), "{} {number:?}", claim.id);
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
}

/// The verdict is what the numbers say.
#[test]
fn verdicts_follow_from_numbers() {
    for claim in claims::all() {
        let stated: Vec<bool> = (claim.numbers)(1).unwrap().iter().filter_map(|number| number.holds()).collect();
        let (right, wrong) = (stated.iter().any(|holds| *holds), stated.iter().any(|holds| !holds));
        let due = match (right, wrong) {
            (false, false) => Holds::Silent,
            (true, false) => Holds::Yes,
            (true, true) => Holds::InPart,
            (false, true) => Holds::No,
        };
        assert_eq!(claim.holds, due, "{} {stated:?}", claim.id);
    }
}

/// NaN is neither right nor agreed.
#[test]
fn nan_is_seen() {
    let number = featherbench_lesson::Number::new("lost", "1", f64::NAN, 1.0).stated(1.0, 0.0);
    assert_eq!(number.holds(), Some(false));
    assert!(number.error().is_nan() && number.separation_error().unwrap().is_nan());
}

/// The lesson's own numbers, as they are published with it.
#[test]
fn published_numbers() {
    let known = [
        ("residual_torque", "torque of joint 1", 1.0, Some(1.6647656)),
        ("residual_torque", "torque of joint 2", -0.5, Some(-0.333_333_3)),
        ("residual_torque", "acceleration of joint 1", 8.84002504, None),
        ("residual_torque", "acceleration of joint 2", -42.25566338, None),
        ("residual_power", "P⋆ − P̂", -0.26600129342, Some(-0.26600129342)),
        ("jump_scaled", "∂x(1)/∂θ, f = θ", 1.0, Some(0.75)),
        ("jump_law", "∂x/∂x₀", 0.190551558384, Some(1.0)),
        ("jump_law", "∂x/∂v₀", -0.112742553774, Some(0.2527426)),
        ("jump_law", "∂v/∂x₀", 3.98650222626, Some(0.0)),
        ("jump_law", "∂v/∂v₀", 1.0, Some(-0.8)),
        ("jump_law", "∂x/∂e", 1.1006128, Some(1.1006128)),
        ("random_modes", "P(bounced)", 0.446404769690, Some(0.0)),
        ("random_modes", "mean velocity", -0.935411159488, Some(-4.4145)),
        ("random_modes", "deviation of the velocity", 3.875151891794, Some(0.0)),
        ("arm_accelerations", "acceleration of joint 1, masses at the tips", 5.5110867986, Some(3.8274597656)),
        ("arm_accelerations", "acceleration of joint 2, masses at the tips", -20.6120093841, Some(-14.0243927662)),
        ("arm_accelerations", "acceleration of joint 1, uniform rods", 8.8127960477, Some(3.8274597656)),
        ("arm_accelerations", "acceleration of joint 2, uniform rods", -43.1567473102, Some(-14.0243927662)),
        ("continuum_beam", "frequency 1 of a cantilever over √(EI/ρAL⁴)", 1.87510406871196 * 1.87510406871196, Some(0.0)),
        ("continuum_string", "frequency 3 of a hanging chain over √(g/L)", 4.32686395646, Some(4.32686395646)),
    ];
    for (id, name, right, lesson) in known {
        let claim = claims::all().into_iter().find(|claim| claim.id == id).unwrap();
        let number = (claim.numbers)(1).unwrap().into_iter().find(|number| number.name == name).unwrap_or_else(|| panic!("{id} {name}"));
        // Their last digit.
        let near = |value: f64, known: f64| (value - known).abs() < 5e-8 * known.abs().max(1.0);
        assert!(near(number.corrected, right), "{number:?}");
        assert_eq!(number.lesson.map(|stated| near(stated.value, lesson.unwrap_or(f64::NAN))), lesson.map(|_| true), "{number:?}");
    }
}
