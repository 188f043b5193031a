//! An HTML page built from headings, sentences, tables and figures.

use std::fmt::Write;
use std::path::Path;

use super::escaped;

const STYLE: &str = "body{font:15px/1.5 Helvetica,Arial,sans-serif;color:#222;background:#fff;max-width:980px;margin:2em auto;padding:0 1.2em}\
h1{font-size:1.6em;margin-bottom:.1em}h2{font-size:1.15em;margin-top:2em;border-bottom:1px solid #ccc}h3{font-size:1em;margin:1.4em 0 .3em}\
table{border-collapse:collapse;margin:.8em 0}th,td{padding:.25em .9em .25em 0;text-align:left;vertical-align:top;border-bottom:1px solid #e4e4e4}\
th{font-weight:600}td.n{text-align:right;font-variant-numeric:tabular-nums}\
.verdict{border:2px solid #15364f;padding:.6em 1em;font-size:1.15em}\
.warn{border-left:4px solid #b4481e;padding:.3em .8em;background:#fbf3ef}\
figure{margin:1em 0}svg{max-width:100%;height:auto}li{margin:.2em 0}@media print{body{margin:0;max-width:none}figure{break-inside:avoid}}";

/// A page under construction.
#[derive(Debug, Clone, Default)]
pub struct Page {
    title: String,
    body: String,
}

impl Page {
    /// A page with a title and a line under it.
    pub fn new(title: &str, subtitle: &str) -> Self {
        let body = format!("<h1>{}</h1>\n<p>{}</p>\n", escaped(title), escaped(subtitle));
        Self { title: title.to_owned(), body }
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
        self.body.push_str("<table><thead><tr>");
        for cell in head {
            let _ = write!(self.body, "<th>{}</th>", escaped(cell));
        }
        self.body.push_str("</tr></thead><tbody>\n");
        for row in rows {
            self.body.push_str("<tr>");
            for cell in row {
                let numeric = cell.parse::<f64>().is_ok();
                let class = if numeric { " class=\"n\"" } else { "" };
                let _ = write!(self.body, "<td{class}>{}</td>", escaped(cell));
            }
            self.body.push_str("</tr>\n");
        }
        self.body.push_str("</tbody></table>\n");
    }

    /// A figure, an `<svg>` element as the figure functions return it, with a caption.
    pub fn figure(&mut self, svg: &str, caption: &str) {
        let caption = escaped(caption);
        let _ = writeln!(self.body, "<figure>{svg}<figcaption>{caption}</figcaption></figure>");
    }

    /// The whole document.
    pub fn html(&self) -> String {
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\"><title>{}</title><style>{STYLE}</style></head>\n<body>\n{}</body></html>\n",
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
