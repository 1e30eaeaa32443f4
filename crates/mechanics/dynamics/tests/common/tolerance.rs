//! The factor on every tolerance, `FEATHERBENCH_TOL_SCALE`: one text for the tests of two crates.

/// Asserts that a residual is finite and no larger than its tolerance times the factor.
///
/// Where the variable is set, every residual is printed. At 0 each residual but zero fails, and its message contains it. No factor turns an
/// assertion off.
#[track_caller]
pub fn assert_within(what: &str, residual: f64, tolerance: f64) {
    let text = std::env::var("FEATHERBENCH_TOL_SCALE").ok();
    let scale = factor(text.as_deref()).unwrap_or_else(|complaint| panic!("{complaint}"));
    if text.is_some() {
        println!("{what}: residual {residual:.2e}, tolerance {tolerance:.2e} × {scale}");
    }
    if let Err(complaint) = judged(what, residual, tolerance, scale) {
        panic!("{complaint}");
    }
}

/// The factor that the variable holds; 1 where it is not set.
fn factor(text: Option<&str>) -> Result<f64, String> {
    let Some(text) = text else { return Ok(1.0) };
    let number = text.trim().parse::<f64>().ok().filter(|factor| factor.is_finite() && *factor >= 0.0);
    number.ok_or_else(|| format!("FEATHERBENCH_TOL_SCALE is '{text}': it must be a finite number, 0 or more"))
}

fn judged(what: &str, residual: f64, tolerance: f64, scale: f64) -> Result<(), String> {
    if !residual.is_finite() {
        return Err(format!("{what}: residual {residual} is not finite"));
    }
    let good = residual <= tolerance * scale;
    if good { Ok(()) } else { Err(format!("{what}: residual {residual:e} exceeds {tolerance:e} × {scale}")) }
}

#[test]
fn no_factor_turns_an_assertion_off() {
    assert_eq!((factor(None), factor(Some("0")), factor(Some(" 1e3 "))), (Ok(1.0), Ok(0.0), Ok(1e3)));
    for text in ["", "NaN", "-1", "-0.5", "inf", "1e999", "off", "1,5"] {
        assert!(
            factor(Some(text)).is_err_and(|complaint| complaint.contains("FEATHERBENCH_TOL_SCALE") && complaint.contains(text)),
            "{text}"
        );
    }
    assert_eq!(judged("M", 1e-15, 1e-14, 1.0), Ok(()));
    assert_eq!(judged("M", 1e-14, 1e-14, 1.0), Ok(()), "up to the tolerance");
    assert_eq!(judged("M", 2e-14, 1e-14, 1.0), Err("M: residual 2e-14 exceeds 1e-14 × 1".into()));
    assert_eq!(judged("M", 1e-300, 1e-14, 0.0), Err("M: residual 1e-300 exceeds 1e-14 × 0".into()), "0 fails, and shows it");
    assert_eq!(judged("M", 0.0, 1e-14, 0.0), Ok(()));
    for lost in [f64::NAN, f64::INFINITY] {
        assert!(judged("M", lost, 1e-14, 1.0).is_err() && judged("M", lost, f64::INFINITY, 1.0).is_err());
    }
    assert!(judged("M", 1e-15, f64::NAN, 1.0).is_err());
}
