//! Bad input is refused with an error that names it.

use crate::support::{cart, lesson};
use featherbench_model::Model;
use featherbench_residuals::{
    Corrected, Delay, DryFriction, Lag, Linear, Passive, Payload, PayloadError, Projection, Residual, ResidualError, Rigid, SeriesElastic,
    SmoothCoulomb, SpringDamper, State, Stribeck, Sum, Viscous, WellPosed, Zero,
};
use nalgebra::DMatrix;

#[test]
fn parameters_are_checked() {
    let nan = f64::NAN;
    let stribeck =
        |stiction: f64| Stribeck { coulomb: vec![2.0], stiction: vec![stiction], speed: vec![0.1], viscous: vec![0.5], width: vec![1e-3] };
    let model: Model<f64> = Model::build(&lesson()).unwrap();
    let tree = &model.topology;
    let errors = [
        Viscous::new(vec![-1.0]).unwrap_err(),
        Viscous::new(vec![nan]).unwrap_err(),
        SmoothCoulomb::new(vec![1.0], vec![0.0]).unwrap_err(),
        SmoothCoulomb::new(vec![1.0], vec![]).unwrap_err(),
        DryFriction::new(vec![f64::INFINITY]).unwrap_err(),
        stribeck(1.0).checked().unwrap_err(),
        stribeck(nan).checked().unwrap_err(),
        SpringDamper::new(tree, vec![1.0; 2], vec![-1.0, 0.0], vec![0.0; 2]).unwrap_err(),
        SpringDamper::new(tree, vec![1.0; 2], vec![1.0; 2], vec![nan, 0.0]).unwrap_err(),
        SpringDamper::new(tree, vec![1.0; 3], vec![1.0; 2], vec![0.0; 2]).unwrap_err(),
        SeriesElastic::new(vec![1.0], vec![0.0], vec![0.0]).unwrap_err(),
        Lag::new(vec![0.0]).unwrap_err(),
        Linear::new(2, 2, vec![0.0; 7]).unwrap_err(),
        Linear::new(1, 1, vec![0.0, nan, 0.0, 0.0]).unwrap_err(),
        Linear::fit(&[]).unwrap_err(),
        Delay::new(1, 2).advance(&mut [0.0], &[1.0]).unwrap_err(),
        Sum::new(2, vec![Box::new(Zero::new(1))]).unwrap_err(),
        Passive::nearest(&Linear::new(2, 1, vec![0.0; 5]).unwrap(), &Projection { mass_below: DMatrix::zeros(1, 1), margin: 1.0 })
            .unwrap_err(),
        Passive::nearest(&Linear::new(1, 1, vec![0.0; 4]).unwrap(), &Projection { mass_below: DMatrix::zeros(1, 1), margin: 0.0 })
            .unwrap_err(),
        WellPosed::of(&DMatrix::from_element(1, 1, nan), &DMatrix::zeros(1, 1)).unwrap_err(),
        WellPosed::of(&DMatrix::zeros(1, 1), &DMatrix::zeros(1, 1)).unwrap_err(),
    ];
    assert!(errors.iter().all(|error| error.to_string().len() > 20));
    for error in [
        Payload::new(&lesson(), 2, 1.0, [0.0; 3], [0.0; 6]),
        Payload::new(&lesson(), 0, -1.0, [0.0; 3], [0.0; 6]),
        Payload::new(&lesson(), 0, 1.0, [nan; 3], [0.0; 6]),
    ] {
        assert!(matches!(error.unwrap_err(), PayloadError::Residual(_)));
    }
}

/// NaN in a state never comes out as a number, and a residual for another robot is refused.
#[test]
fn states_are_checked() {
    let model = cart(1.0);
    let mut corrected = Corrected::new(Rigid::new(&model), Viscous::new(vec![1.0]).unwrap()).unwrap();
    for (q, v, x) in [(f64::NAN, 0.0, 0.0), (0.0, f64::NAN, 0.0), (0.0, 0.0, f64::NAN), (0.0, f64::INFINITY, 0.0)] {
        assert!(matches!(corrected.inverse(&[q], &[v], &[x]), Err(ResidualError::NotFinite { .. })));
        assert!(matches!(corrected.forward(&[q], &[v], &[x]), Err(ResidualError::NotFinite { .. })));
    }
    assert!(matches!(corrected.inverse(&[0.0], &[0.0, 1.0], &[0.0]), Err(ResidualError::Dimension(_))));
    assert!(matches!(corrected.inverse(&[], &[0.0], &[0.0]), Err(ResidualError::Dimension(_))));
    assert!(matches!(corrected.forward(&[0.0], &[0.0], &[]), Err(ResidualError::Dimension(_))));
    assert!(Corrected::new(Rigid::new(&model), Zero::new(2)).is_err());
    assert!(Corrected::new(Rigid::new(&model), Linear::new(2, 1, vec![0.0; 5]).unwrap()).is_err());
    assert!(
        Lag::new(vec![1.0]).unwrap().value(&State::new(&[0.0], &[0.0], &[0.0]).with_command(&[1.0])).is_err(),
        "its inner state is missing"
    );
}
