//! What to do, and how much of it.

/// What the command line asks for.
pub(crate) struct Plan {
    pub(crate) scale: f64,
    pub(crate) seed: u64,
    rows: Vec<String>,
    /// Where the document goes.
    pub(crate) out: Option<String>,
}

impl Plan {
    /// The plan that a command line asks for.
    pub(crate) fn parse(words: &[&str]) -> Self {
        let mut plan = Self { scale: 1.0, seed: 1, rows: Vec::new(), out: None };
        let mut words = words.iter();
        while let Some(&word) = words.next() {
            let mut value = || *words.next().unwrap_or_else(|| panic!("{word} needs a value"));
            match word {
                "--out" => plan.out = Some(value().to_owned()),
                "--scale" => plan.scale = value().parse().expect("--scale needs a number"),
                "--seed" => plan.seed = value().parse().expect("--seed needs a number"),
                row => plan.rows.push(row.to_owned()),
            }
        }
        plan
    }

    /// Whether a row or section is to be made.
    pub(crate) fn wants(&self, row: &str) -> bool {
        self.rows.is_empty() || self.rows.iter().any(|wanted| wanted == row)
    }

    /// A part of the full number of tries, at least 3.
    pub(crate) fn count(&self, full: u64) -> u64 {
        ((full as f64 * self.scale) as u64).max(3)
    }
}
