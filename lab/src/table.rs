//! Tables in Markdown on standard output.

/// Prints the heading of a table.
pub fn print_header(columns: &[&str]) {
    println!("| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
}
