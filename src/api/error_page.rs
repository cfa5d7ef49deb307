//! The page of error and warning codes, target of the `type` of every problem.

use std::sync::LazyLock;

use axum::http::header;
use axum::response::{IntoResponse, Response};
use utoipa_axum::routes;

use super::plain_page::plain_page;
use super::resources::Resources;

/// The source of the page; a test compares it with the codes of the program.
const WRITTEN: &str = include_str!("../../docs/errors.md");
const HTML: &str = "text/html; charset=utf-8";

static PAGE: LazyLock<String> = LazyLock::new(|| html(WRITTEN));

pub fn router() -> Resources {
    Resources::new().open(routes!(errors))
}

/// All codes of problems, job errors and warnings, each in a row with the code as its anchor: the `type`
/// of a problem is the address of its row.
#[utoipa::path(
    get, path = "/errors", operation_id = "show_errors", tag = "about",
    responses((status = 200, description = "the page", body = String, content_type = "text/html"))
)]
async fn errors() -> Response {
    page()
}

/// The page, also for the admin listener.
pub fn page() -> Response {
    ([(header::CONTENT_TYPE, HTML)], PAGE.as_str()).into_response()
}

/// The page as HTML: of Markdown only headings, paragraphs, words in backquotes and tables, whose rows are identified by
/// the word in their first cell.
fn html(written: &str) -> String {
    let mut body = String::new();
    for block in written.split("\n\n") {
        let lines: Vec<&str> = block.lines().collect();
        match lines.as_slice() {
            [] => {}
            [heading] if heading.starts_with('#') => body += &headline(heading),
            [head, _, rows @ ..] if head.starts_with("| ") => {
                let table = table(&body, head, rows);
                body += &table;
            }
            paragraph => body += &format!("<p>{}</p>\n", inline(&paragraph.join("\n"))),
        }
    }
    plain_page("errors and warnings", &body)
}

fn headline(line: &str) -> String {
    let text = line.trim_start_matches('#');
    let level = line.len() - text.len();
    format!("<h{level}>{}</h{level}>\n", inline(text.trim()))
}

/// A table whose rows have anchors, except for codes with a row `above`: a warning may have the code of an error.
fn table(above: &str, head: &str, rows: &[&str]) -> String {
    let mut table =
        format!("<div class=\"wide\" tabindex=\"0\"><table>\n<tr>{}</tr>\n", cells(head, "th"));
    for row in rows {
        let name = escaped(row.split('`').nth(1).unwrap_or_default());
        let anchor = format!(" id=\"{name}\"");
        let anchor = if above.contains(&anchor) { String::new() } else { anchor };
        table += &format!("<tr{anchor}>{}</tr>\n", cells(row, "td"));
    }
    table + "</table></div>\n"
}

fn cells(row: &str, tag: &str) -> String {
    let inner = row.trim_start_matches("| ").trim_end_matches(" |");
    inner.split(" | ").map(|cell| format!("<{tag}>{}</{tag}>", inline(cell))).collect()
}

/// Text with backquoted parts as code. Links lead to documentation that the service does not have: their words remain.
fn inline(text: &str) -> String {
    let text = without_links(text);
    let mut parts = text.split('`').map(escaped);
    let first = parts.next().unwrap_or_default();
    let code = |(index, part): (usize, String)| match index % 2 {
        0 => format!("<code>{part}</code>"),
        _ => part,
    };
    first + &parts.enumerate().map(code).collect::<String>()
}

/// `[words](target)` as its words.
fn without_links(text: &str) -> String {
    let mut parts = text.split("](");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        if let Some(start) = plain.rfind('[') {
            plain.remove(start);
        }
        plain += part.split_once(')').map_or("", |(_, rest)| rest);
    }
    plain
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
