//! What all rows say together.

use crate::row::Row;

/// A column: its name, its decimals and its value.
type Column = (&'static str, usize, fn(&Row) -> f64);

#[expect(clippy::cast_precision_loss, reason = "counts of a table")]
const COLUMNS: [Column; 7] = [
    ("after", 0, |row| row.after as f64),
    ("iterations", 0, |row| row.iterations as f64),
    ("mean %", 4, |row| row.change.mean_percent),
    ("most %", 3, |row| row.change.most_percent),
    ("short", 3, |row| row.change.shortest),
    ("long", 3, |row| row.change.longest),
    ("area", 3, |row| row.change.smallest),
];

/// The least, the median and the greatest value of each column.
pub(crate) fn print_spread(rows: &[Row]) {
    if rows.is_empty() {
        return;
    }
    for (name, decimals, value) in COLUMNS {
        let mut values: Vec<f64> = rows.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        let [least, median, most] = [0, values.len() / 2, values.len() - 1].map(|index| values[index]);
        println!("  {name:<12} {least:>10.decimals$} {median:>10.decimals$} {most:>10.decimals$}");
    }
}

pub(crate) fn print_summary(rows: &[Row]) {
    let clean = rows.iter().filter(|row| row.after == 0).count();
    #[expect(clippy::cast_precision_loss, reason = "counts of a table")]
    let mean = rows.iter().map(|row| row.iterations as f64).sum::<f64>() / rows.len().max(1) as f64;
    println!("{clean} of {} clean, {mean:.1} iterations on the average", rows.len());
    let mut worst: Vec<f64> = rows.iter().map(|row| row.change.worst_edge()).collect();
    worst.sort_by(|a, b| a.ln().abs().total_cmp(&b.ln().abs()));
    if let Some(median) = worst.get(worst.len() / 2) {
        println!("median of the worst edge ratios: {median:.3}; {:.3} to {:.3}", worst[0], worst[worst.len() - 1]);
    }
}
