//! Values by name over a struct that has them: the configuration, and the settings of a session.

use serde::{Serialize, de::DeserializeOwned};
use toml::{Table, Value};

/// The struct with one value replaced, by the path of its name.
///
/// # Errors
/// Why the value does not fit, in words that name neither it nor its key.
pub(crate) fn replace<T: Serialize + DeserializeOwned>(base: &T, path: &[&str], value: Value) -> Result<T, String> {
    let mut table = Table::try_from(base).map_err(|error| error.to_string())?;
    let mut place = &mut table;
    let (last, sections) = path.split_last().ok_or("it has no name")?;
    for section in sections {
        let inner = place.entry(*section).or_insert_with(|| Table::new().into());
        place = inner.as_table_mut().ok_or_else(|| format!("`{section}` is no section"))?;
    }
    place.insert((*last).to_owned(), value);
    Value::Table(table).try_into().map_err(|error: toml::de::Error| in_words(error.message()))
}

/// The message of a parser without the names of our types, on one line.
pub(crate) fn in_words(message: &str) -> String {
    let mut words = message.trim().replace('\n', " ");
    for (name, meaning) in [
        ("usize", "a whole number that is not negative"),
        ("u64", "a whole number that is not negative"),
        ("u32", "a whole number that is not negative"),
        ("f64", "a number"),
    ] {
        words = words.replace(&format!("expected {name}"), &format!("expected {meaning}"));
    }
    words
}

/// The known name that is most like a given one, unless none is much like it.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const LEAST: f64 = 0.75;
    let length = name.chars().count();
    let known = known.into_iter().filter(|other| may_be_like(length, other.chars().count()));
    let likeness = known.map(|other| (strsim::normalized_damerau_levenshtein(name, other), other));
    likeness.filter(|(likeness, _)| *likeness >= LEAST).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, other)| other)
}

/// Whether names of these lengths can be alike in three of four characters, since each too many is a difference. The
/// comparison takes memory and time that grow with both lengths, and peers send names of any length.
fn may_be_like(one: usize, other: usize) -> bool {
    one.abs_diff(other) <= one.max(other) / 4
}

#[cfg(test)]
mod tests {
    use untangle::settings::{Response, Settings};

    use super::*;

    #[test]
    fn replace_takes_a_value_by_name_and_says_in_words_why_not() {
        let base = Settings { max_step_edge_lengths: f64::INFINITY, ..Settings::default() };
        let with = |name: &str, value: Value| replace(&base, &[name], value);
        assert_eq!(with("response", "mask".into()).unwrap(), Settings { response: Response::Mask, ..base.clone() });
        assert_eq!(with("deadline_us", 5.into()).unwrap(), Settings { deadline_us: Some(5), ..base.clone() });
        let negative = with("path_rings", (-1).into()).unwrap_err();
        assert!(negative.contains("-1") && negative.contains("a whole number that is not negative"), "{negative}");
        let text = with("thickness_m", "thin".into()).unwrap_err();
        assert!(text.contains("expected a number") && !text.contains("f64"), "{text}");
    }

    #[test]
    fn nearest_finds_slips_and_nothing_else() {
        let known = ["path_rings", "response", "deadline_us"];
        assert_eq!(nearest("path_ring", known), Some("path_rings"));
        assert_eq!(nearest("dealine_us", known), Some("deadline_us"));
        assert_eq!(nearest("gravity", known), None);
        assert_eq!(nearest("response..", known), Some("response"));
        assert_eq!(nearest("response...", known), None);
    }

    #[test]
    fn names_far_longer_or_shorter_than_all_known_ones_are_not_compared() {
        assert!(may_be_like(8, 10) && may_be_like(10, 8) && may_be_like(9, 12) && may_be_like(0, 0));
        assert!(!may_be_like(8, 11) && !may_be_like(1 << 20, 20) && !may_be_like(0, 1));
    }
}
