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

/// A document whose paragraphs and items are joined and wrapped. Tables, headings and blocks of code stay as they are.
#[must_use]
pub fn wrapped(text: &str) -> String {
    let (mut in_code, mut is_open) = (false, false);
    let mut blocks: Vec<(bool, String)> = Vec::new();
    for line in text.split('\n') {
        let is_fence = line.starts_with("```");
        in_code ^= is_fence;
        let is_prose = !in_code && !is_fence && !line.is_empty() && !line.starts_with(['|', '#']);
        if let Some((_, block)) = blocks.last_mut().filter(|_| is_open && is_prose && !line.starts_with("- ")) {
            block.push(' ');
            block.push_str(line.trim_start());
        } else {
            blocks.push((is_prose, line.to_owned()));
        }
        is_open = is_prose;
    }
    let lines = blocks.into_iter().map(|(is_prose, block)| if is_prose { wrapped_line(&block) } else { block });
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

    #[test]
    fn wrapped_text_joins_lines_of_a_paragraph_and_of_an_item_only() {
        let text = "One\n`two`.\n\n- three\n  four\n- five\n\n| a |\n| b |\n\n```\nsix\nseven\n```\neight";
        let expected = "One `two`.\n\n- three four\n- five\n\n| a |\n| b |\n\n```\nsix\nseven\n```\neight";
        assert_eq!(wrapped(text), expected);
    }
}
