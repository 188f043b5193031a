//! An HTML page built from headings, sentences, tables and figures.

use std::fmt::Write;
use std::path::Path;

use super::escaped;

/// Readable on a phone, on paper, and on a dark screen; figures keep white paper there.
const STYLE: &str = include_str!("page.css");

/// By this a page is known as one of ours, which a later call may replace.
pub const MARK: &str = "<meta name=\"generator\" content=\"palpate ";

/// A figure as a file of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Its title; where it has none, what is drawn.
    pub title: String,
    /// The `<svg>` element.
    pub svg: String,
}

/// A page under construction.
#[derive(Debug, Clone, Default)]
pub struct Page {
    title: String,
    body: String,
    pictures: Vec<Picture>,
}

impl Page {
    /// A page with a title and a line under it; none where the line is empty.
    pub fn new(title: &str, subtitle: &str) -> Self {
        let mut body = format!("<h1>{}</h1>\n", escaped(title));
        if !subtitle.is_empty() {
            let _ = writeln!(body, "<p>{}</p>", escaped(subtitle));
        }
        Self { title: title.to_owned(), body, pictures: Vec::new() }
    }

    /// Starts a section.
    pub fn section(&mut self, heading: &str) {
        let _ = writeln!(self.body, "<h2>{}</h2>", escaped(heading));
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) {
        let _ = writeln!(self.body, "<p>{}</p>", escaped(text));
    }

    /// A paragraph that must not be overlooked.
    pub fn warning(&mut self, text: &str) {
        let _ = writeln!(self.body, "<p class=\"warn\">{}</p>", escaped(text));
    }

    /// The sentence that a reader should leave with, in a frame.
    pub fn verdict(&mut self, text: &str) {
        let _ = writeln!(self.body, "<p class=\"verdict\">{}</p>", escaped(text));
    }

    /// A heading inside a section.
    pub fn heading(&mut self, text: &str) {
        let _ = writeln!(self.body, "<h3>{}</h3>", escaped(text));
    }

    /// A bulleted list.
    pub fn list(&mut self, items: &[String]) {
        self.body.push_str("<ul>\n");
        for item in items {
            let _ = writeln!(self.body, "<li>{}</li>", escaped(item));
        }
        self.body.push_str("</ul>\n");
    }

    /// A table; cells that start like a number are set to the right.
    pub fn table(&mut self, head: &[&str], rows: &[Vec<String>]) {
        self.body.push_str("<div class=\"wide\"><table>");
        if head.iter().any(|cell| !cell.is_empty()) {
            let cells: String = head.iter().map(|cell| format!("<th>{}</th>", escaped(cell))).collect();
            let _ = write!(self.body, "<thead><tr>{cells}</tr></thead>");
        }
        self.body.push_str("<tbody>\n");
        for row in rows {
            self.body.push_str("<tr>");
            for cell in row {
                let numeric = cell.parse::<f64>().is_ok();
                let class = if numeric { " class=\"n\"" } else { "" };
                let _ = write!(self.body, "<td{class}>{}</td>", escaped(cell));
            }
            self.body.push_str("</tr>\n");
        }
        self.body.push_str("</tbody></table></div>\n");
    }

    /// What follows is folded away under a line of text, until [`Page::unfold`].
    pub fn fold(&mut self, summary: &str) {
        let _ = writeln!(self.body, "<details><summary>{}</summary>", escaped(summary));
    }

    /// Ends what is folded away.
    pub fn unfold(&mut self) {
        self.body.push_str("</details>\n");
    }

    /// Figures of the page in their order, each an `<svg>` element of its own.
    #[must_use]
    pub fn pictures(&self) -> &[Picture] {
        &self.pictures
    }

    /// A figure, one or more `<svg>` elements as the figure functions return them, with a caption.
    pub fn figure(&mut self, svg: &str, caption: &str) {
        self.pictures.extend(elements(svg).map(|svg| Picture { title: title_of(svg).to_owned(), svg: svg.to_owned() }));
        let caption = escaped(caption);
        let _ = writeln!(self.body, "<figure>{svg}<figcaption>{caption}</figcaption></figure>");
    }

    /// The whole document.
    pub fn html(&self) -> String {
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">{MARK}{}\"><title>{}</title><style>{STYLE}</style></head>\n<body>\n{}</body></html>\n",
            env!("CARGO_PKG_VERSION"),
            escaped(&self.title),
            self.body
        )
    }

    /// Writes the document, making its folder if need be.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn write(&self, file: &Path) -> std::io::Result<()> {
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder)?;
        }
        std::fs::write(file, self.html())
    }
}

/// The outermost `<svg>` elements of a text, one after the other.
fn elements(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = text;
    std::iter::from_fn(move || {
        let start = rest.find("<svg")?;
        let (mut depth, mut at) = (0_usize, start);
        loop {
            let next = rest.get(at..)?.find("svg").map(|step| at + step)?;
            depth = match (rest.get(..next)?.ends_with('<'), rest.get(..next)?.ends_with("</")) {
                (true, _) => depth + 1,
                (_, true) => depth.checked_sub(1)?,
                _ => depth,
            };
            at = next + 3;
            if depth == 0 {
                break;
            }
        }
        let end = rest.get(at..)?.find('>').map(|step| at + step + 1)?;
        let (element, left) = (rest.get(start..end)?, rest.get(end..)?);
        rest = left;
        Some(element)
    })
}

/// The `<title>` of an element up to where it becomes a description.
fn title_of(svg: &str) -> &str {
    let inner = svg.split_once("<title>").and_then(|(_, rest)| rest.split_once("</title>"));
    let title = inner.map_or("", |(title, _)| title);
    title.split([':', ';']).next().unwrap_or(title)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_taken_apart_into_files() {
        let mut page = Page::new("a", "");
        page.figure("<svg a><title>one svg</title><svg b></svg></svg>\n<svg c><title>two</title></svg>\n", "both");
        let told: Vec<(&str, &str)> = page.pictures().iter().map(|p| (p.title.as_str(), p.svg.as_str())).collect();
        let first = ("one svg", "<svg a><title>one svg</title><svg b></svg></svg>");
        assert_eq!(told, [first, ("two", "<svg c><title>two</title></svg>")]);
        page.fold("more");
        page.unfold();
        let html = page.html();
        assert!(html.contains(MARK) && html.contains("initial-scale=1") && html.contains("prefers-color-scheme"));
        assert_eq!(html.matches("<details>").count(), html.matches("</details>").count());
    }
}
