//! Tables and text in Markdown on standard output.

/// Columns of text in documents.
const MAX_COLUMNS: usize = 120;

/// Prints the heading of a table.
pub fn print_header(columns: &[&str]) {
    println!("| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
}

/// Prints text as a document has it.
pub fn print_text(text: &str) {
    println!("{}", wrapped(text));
}

/// A document whose paragraphs are wrapped. Tables, headings and blocks of code stay as they are.
#[must_use]
pub fn wrapped(text: &str) -> String {
    let mut in_code = false;
    let lines = text.split('\n').map(|line| {
        in_code ^= line.starts_with("```");
        if in_code || line.starts_with(['|', '#', '`']) { line.to_owned() } else { wrapped_line(line) }
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn wrapped_line(line: &str) -> String {
    let indent = if line.starts_with("- ") { "  " } else { "" };
    let mut lines = vec![String::new()];
    for word in line.split(' ') {
        let last = lines.last().map_or(0, |line| line.chars().count());
        if last > 0 && last + 1 + word.chars().count() > MAX_COLUMNS {
            lines.push(indent.to_owned() + word);
        } else if let Some(line) = lines.last_mut() {
            if last > 0 {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_text_keeps_words_tables_and_code_and_has_no_long_line() {
        let words = ["word"; 100].join(" ");
        let table = format!("| {words} |");
        let text = format!("# Title\n\n{words}\n\n- {words}\n\n{table}\n\n```\n{words}\n```");
        let result = wrapped(&text);
        assert!(result.contains(&table) && result.contains(&format!("```\n{words}\n```")));
        assert!(result.lines().filter(|line| line.len() > MAX_COLUMNS).count() == 2);
        let split = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(split(&result), split(&text));
    }
}
