//! Values of flags: what is refused as a usage error.

fn number(text: &str, what: &str, is_valid: fn(f64) -> bool) -> Result<f64, String> {
    let value = text.parse().ok().filter(|&value: &f64| value.is_finite() && is_valid(value));
    value.ok_or_else(|| format!("expected {what}"))
}

pub(crate) fn finite(text: &str) -> Result<f64, String> {
    number(text, "a finite number", |_| true)
}

pub(crate) fn positive(text: &str) -> Result<f64, String> {
    number(text, "a number greater than 0", |value| value > 0.0)
}

pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    number(text, "a number that is not negative", |value| value >= 0.0)
}

/// Without this, clap would take the text itself for a JSON string.
pub(crate) fn json_object(text: &str) -> Result<serde_json::Value, String> {
    match serde_json::from_str(text) {
        Ok(value @ serde_json::Value::Object(_)) => Ok(value),
        Ok(_) => Err(r#"expected a JSON object, such as {"quality": "accurate"}"#.into()),
        Err(error) => Err(format!(r#"expected a JSON object, such as {{"quality": "accurate"}}: {error}"#)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_object_is_read_and_nothing_else() {
        let read = json_object(r#"{"quality": "accurate", "path_rings": 3}"#);
        assert_eq!(read, Ok(serde_json::json!({"quality": "accurate", "path_rings": 3})));
        for bad in ["accurate", r#""accurate""#, "[1]", "3", "null", r#"{"quality": "#] {
            let said = json_object(bad).unwrap_err();
            assert!(said.contains("expected a JSON object"), "{bad}: {said}");
        }
    }

    #[test]
    fn numbers_that_no_simulation_can_use_are_refused() {
        for read in [finite, positive, not_negative] {
            assert_eq!(read("1.5"), Ok(1.5));
            assert!(["NaN", "inf", "-inf", "", "1.5m"].iter().all(|bad| read(bad).is_err()));
        }
        assert!(positive("0").is_err() && positive("-1").is_err() && not_negative("-0.1").is_err());
        assert!(not_negative("0").is_ok() && finite("-1.62").is_ok());
    }
}
