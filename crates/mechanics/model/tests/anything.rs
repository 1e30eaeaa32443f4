//! Any description, however wrong, gives an error or is compiled: nothing panics.

use crate::arbitrary::any_description;
use crate::share::one_of;
use featherbench_model::Model;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn nothing_panics(robot in any_description()) {
        let valid = robot.validate();
        let canonical = robot.canonical();
        if valid.is_err() {
            prop_assert!(canonical.is_err());
        }
        let model = Model::<f64>::build(&robot);
        prop_assert_eq!(model.is_ok(), canonical.is_ok());
        if let (Ok(model), Ok(canonical)) = (model, canonical) {
            prop_assert_eq!(model.topology.nv(), canonical.nv());
            prop_assert_eq!(model.topology.nq(), canonical.nq());
            prop_assert_eq!(model.described.len(), canonical.bodies.len());
            prop_assert_eq!(&model.warnings, &canonical.warnings());
            prop_assert!(canonical.depth() <= canonical.bodies.len());
            // Merging may overflow when a number is near the largest. Otherwise the canonical form is its own canonical form.
            if let Ok(again) = canonical.canonical() {
                prop_assert_eq!(again, canonical);
            }
        }
    }
}
