//! Numbers of the command line: each option names its domain here, and nothing outside of it gets any further.

/// The largest error in the picture that may be asked for, pixels.
pub const MAX_ERROR_PX: f64 = 64.0;

/// The text as a number; `what` says which are legal, where `is_legal` does not take it. NaN is legal nowhere.
fn number(text: &str, what: &str, is_legal: impl Fn(f64) -> bool) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() && is_legal(x) => Ok(x),
        _ => Err(format!("it is not {what}")),
    }
}

/// Any number but infinities and NaN.
///
/// # Errors
/// In words, what would be legal; so for all that follow.
pub fn finite(text: &str) -> Result<f64, String> {
    number(text, "a finite number", |_| true)
}

/// A length above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    number(text, "a positive, finite number", |x| x > 0.0)
}

/// A depth from 0.
pub fn not_negative(text: &str) -> Result<f64, String> {
    number(text, "a finite number from 0", |x| x >= 0.0)
}

/// A part of a whole, from 0 to 1.
pub fn share(text: &str) -> Result<f64, String> {
    number(text, "a share from 0 to 1", |x| (0.0..=1.0).contains(&x))
}

/// A field of view, degrees.
pub fn field_of_view(text: &str) -> Result<f64, String> {
    number(text, "an angle above 0 and below 180 degrees", |x| x > 0.0 && x < 180.0)
}

/// An angle above the horizon, degrees.
pub fn elevation(text: &str) -> Result<f64, String> {
    number(text, "an angle from -89 to 89 degrees (see --view top)", |x| (-89.0..=89.0).contains(&x))
}

/// An error that is asked for, pixels: a tolerance of half a picture would let any picture agree.
pub fn error_px(text: &str) -> Result<f64, String> {
    let what = format!("a positive number of at most {MAX_ERROR_PX} pixels");
    number(text, &what, |x| x > 0.0 && x <= MAX_ERROR_PX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_outside_a_domain_is_refused() {
        let nonsense =
            ["nan", "NaN", "-nan", "inf", "-inf", "infinity", "1e999", "-1e999", "", " 1", "1 ", "x", "1,5", "0x1"];
        for parse in [finite, positive, not_negative, share, field_of_view, elevation, error_px] {
            for text in nonsense {
                assert!(parse(text).is_err(), "{text:?}");
            }
        }
        type Case = (fn(&str) -> Result<f64, String>, &'static [&'static str], &'static [&'static str]);
        let cases: [Case; 7] = [
            (finite, &["-8e-05", "-.5", "1E3", "0"], &[]),
            (positive, &["1e-300", "4"], &["0", "-0", "-1", "-8e-05"]),
            (not_negative, &["0", "1e9"], &["-1e-300"]),
            (share, &["0", "0.01", "1"], &["-0.01", "1.0001", "5", "-1e-9"]),
            (field_of_view, &["1e-3", "179.9"], &["0", "180", "-40"]),
            (elevation, &["-89", "0", "89"], &["-90", "91"]),
            (error_px, &["0.25", "1e-6", "64"], &["0", "-1", "64.1", "1e9"]),
        ];
        for (parse, legal, illegal) in cases {
            for text in legal {
                assert_eq!(parse(text), Ok(text.parse().expect("a number")));
            }
            for text in illegal {
                assert!(parse(text).is_err(), "{text}");
            }
        }
    }
}
