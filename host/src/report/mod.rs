//! Reports and figures: self-contained HTML with inline SVG, readable without scripts, network
//! or colour. Every figure has a text that says what it shows.

mod axis;
mod bar;
mod believed;
pub mod cloud;
pub mod compression;
pub mod control;
pub mod diagnosis;
pub mod displacement;
pub mod display;
pub mod feel;
pub mod field;
pub mod figure;
pub mod finger;
pub mod gain;
pub mod identification;
pub mod magnet;
pub mod map;
mod page;
pub mod readings;
pub mod response;
mod scale;
mod sheet;
pub mod strip;
pub mod table;
pub mod tour;
pub mod track;
pub mod trial;
pub mod tuning;
pub mod valley;

pub use page::{MARK, Page, Picture};
pub use scale::number;

/// Text with the characters that mean something in HTML and SVG replaced.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            other => out.push(other),
        }
    }
    out
}
