//! A report as one self-contained HTML file, which prints on A4.

use mechanics::chart::svg::{escaped, svg};

use super::content::{Block, Figure, Report, Section, Table};

/// No scripts, nothing from elsewhere.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:";

/// The height of a page, the largest of a figure, in points.
const LARGEST: f64 = 760.0;

/// The light colours of the page, since a report is for paper.
const PALETTE: &str = include_str!("../../../web/dist/assets/palette.css");

const STYLE: &str = "
@page { size: A4; margin: 13mm 14mm; }
* { box-sizing: border-box; }
body { font: 10.5pt/1.4 Helvetica, Arial, 'Liberation Sans', sans-serif; color: var(--ink); background: var(--card);
  max-width: 190mm; margin: 0 auto; padding: 1rem; overflow-wrap: anywhere; }
h1 { font-size: 1.7em; margin: 0; } h2 { font-size: 1.15em; margin: 1.1em 0 0.3em; }
p { margin: 0.3em 0; } .subtitle { color: var(--soft); }
.notice { border: 1px solid var(--warn-ink); background: var(--warn-ground); color: var(--warn-ink); padding: 0.25em 0.6em; font-weight: bold; }
figure { margin: 0.5em 0; } figure svg { width: 100%; height: auto; display: block; }
figcaption { color: var(--soft); font-size: 0.9em; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: 0.93em; }
th, td { text-align: right; padding: 0.15em 0.4em; border-bottom: 1px solid var(--line); vertical-align: top; }
th, td { overflow-wrap: normal; } .facts td { overflow-wrap: anywhere; }
th:first-child, td:first-child, .facts td { text-align: left; } thead th { border-bottom: 1px solid var(--soft); }
tbody th { font-weight: normal; } .facts th { width: 26%; color: var(--soft); }
ul { margin: 0.2em 0; padding-left: 1.3em; }
.signature { display: flex; gap: 1.5em; margin: 2.4em 0 0.3em; } .signature span { flex: 1; border-top: 1px solid var(--ink); color: var(--soft); }
@media print { body { font-size: 8.6pt; line-height: 1.3; padding: 0; max-width: none; }
  .page { break-before: page; } figure, tr, .signature { break-inside: avoid; } h2 { break-after: avoid; margin: 8pt 0 2pt; }
  figure { margin: 4pt 0; } figure svg { max-height: var(--most); } p { margin: 1pt 0; } .signature { margin: 22pt 0 4pt; } footer p { margin: 4pt 0 0; }
  .wide { overflow: visible; } table { table-layout: fixed; font-size: 8.2pt; line-height: 10.2pt; } th, td { padding: 1pt 3pt; overflow-wrap: anywhere; }
  th:first-child, .facts th { width: 26%; } * { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
";

pub fn html(report: &Report) -> String {
    let [title, subtitle, notice] =
        [&report.title, &report.subtitle, &report.notice].map(|words| escaped(words));
    let sections: String = report.sections.iter().map(section).collect();
    format!(
        "<!doctype html>\n<html lang=\"{}\" data-theme=\"light\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n<style>{PALETTE}{STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1>{title}</h1>\n<p class=\"subtitle\">{subtitle}</p>\n<p class=\"notice\">{notice}</p>\n</header>\n\
         <main>\n{sections}</main>\n<footer><p class=\"notice\">{notice}</p></footer>\n</body>\n</html>\n",
        report.language.tag()
    )
}

fn section(section: &Section) -> String {
    let class = if section.on_new_page { " class=\"page\"" } else { "" };
    let blocks: String = section.blocks.iter().map(block).collect();
    format!("<section{class}>\n<h2>{}</h2>\n{blocks}</section>\n", escaped(&section.heading))
}

fn block(block: &Block) -> String {
    match block {
        Block::Paragraph(words) => format!("<p>{}</p>\n", escaped(words)),
        Block::List(entries) => {
            let entries = entries.iter().map(|words| format!("<li>{}</li>\n", escaped(words)));
            format!("<ul>\n{}</ul>\n", entries.collect::<String>())
        }
        Block::Table(own) => table(own),
        Block::Figure(Figure { drawing, title, caption, height }) => format!(
            "<figure role=\"img\" aria-label=\"{}\" style=\"--most: {:.0}pt\">\n{}<figcaption>{}</figcaption>\n</figure>\n",
            escaped(title),
            height.min(LARGEST),
            svg(drawing, title),
            escaped(caption)
        ),
        Block::Signature(names) => {
            let lines = names.iter().map(|name| format!("<span>{}</span>", escaped(name)));
            format!("<p class=\"signature\">{}</p>\n", lines.collect::<String>())
        }
    }
}

fn table(table: &Table) -> String {
    let cells = |row: &Vec<String>, scope: &str| -> String {
        let cell = |(column, words): (usize, &String)| {
            let words = escaped(words);
            match (scope, column) {
                ("col", _) => format!("<th scope=\"col\">{words}</th>"),
                (_, 0) => format!("<th scope=\"row\">{words}</th>"),
                _ => format!("<td>{words}</td>"),
            }
        };
        row.iter().enumerate().map(cell).collect()
    };
    let head = match table.columns.is_empty() {
        true => String::new(),
        false => format!("<thead><tr>{}</tr></thead>\n", cells(&table.columns, "col")),
    };
    let class = if table.columns.is_empty() { " class=\"facts\"" } else { "" };
    let rows = table.rows.iter().map(|row| format!("<tr>{}</tr>\n", cells(row, "row")));
    let rows: String = rows.collect();
    format!(
        "<div class=\"wide\" tabindex=\"0\"><table{class}>\n{head}<tbody>\n{rows}</tbody></table></div>\n"
    )
}
