//! Documents with sections that a command writes.
//!
//! Such a section stands between two comments of its own name, which a reader does not see:
//!
//! ```text
//! <!-- begin NAME: made by COMMAND -->
//! ..
//! <!-- end NAME -->
//! ```

/// A document without the section that was to be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the document has no section between `<!-- begin {name}: .. -->` and `<!-- end {name} -->`")]
pub struct MissingSection {
    /// Name of the section.
    pub name: String,
}

/// The document with the section's content replaced.
///
/// # Errors
/// [`MissingSection`] when either comment is missing or they come in the wrong order.
pub fn replace_section(document: &str, name: &str, content: &str) -> Result<String, MissingSection> {
    let missing = || MissingSection { name: name.to_owned() };
    let begin = document.find(&format!("<!-- begin {name}:")).ok_or_else(missing)?;
    let open = begin + document[begin..].find("-->\n").ok_or_else(missing)? + "-->\n".len();
    let close = open + document[open..].find(&format!("<!-- end {name} -->")).ok_or_else(missing)?;
    Ok(format!("{}{}\n{}", &document[..open], content.trim_end(), &document[close..]))
}

/// A Markdown table.
#[must_use]
pub fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = head.iter().map(|&cell| cell.to_owned()).collect();
    let rule = format!("|{}\n", "---|".repeat(head.len()));
    line(&head) + &rule + &rows.iter().map(|row| line(row)).collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_section_changes() {
        let text = "a\n<!-- begin x: made by y -->\nold\nold\n<!-- end x -->\nb\n";
        let new = "a\n<!-- begin x: made by y -->\nnew\n<!-- end x -->\nb\n";
        assert_eq!(replace_section(text, "x", "new\n"), Ok(new.to_owned()));
        assert_eq!(replace_section(new, "x", "new"), Ok(new.to_owned()));
        for broken in ["", "<!-- begin x: -->\n", "<!-- end x -->\n<!-- begin x: -->\n"] {
            assert_eq!(replace_section(broken, "x", "new"), Err(MissingSection { name: "x".into() }));
        }
    }
}
