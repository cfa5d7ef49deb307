//! Static pages without a script, in the colours of the page for planners.

/// Light and dark colours.
const PALETTE: &str = include_str!("../../web/dist/assets/palette.css");

const STYLE: &str = "
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--ink); font: 15px/1.45 system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif; }
header { padding: .6em 1.1em; background: var(--card); border-bottom: 1px solid var(--line); }
.brand { font-weight: 700; font-size: 1.15rem; color: var(--ink); text-decoration: none; }
main { max-width: 75em; margin: 0 auto; padding: 1.2em; }
h1 { font-size: 1.3rem; margin: 0 0 .6em; } h2 { font-size: 1.05rem; margin: 1.6em 0 .4em; }
p { max-width: 50em; margin: .4em 0; } a { color: var(--accent); }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
code { font: .88em ui-monospace, 'DejaVu Sans Mono', monospace; }
.wide { overflow-x: auto; background: var(--card); border: 1px solid var(--line); border-radius: 8px; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: .4em .8em; border-bottom: 1px solid var(--line); }
th { color: var(--soft); font-weight: 600; } tr:last-child td { border-bottom: 0; }
td:first-child { white-space: nowrap; }
tr:target td { background: var(--warn-ground); color: var(--warn-ink); }
@media (max-width: 760px) { main { padding: .8em; } td:first-child { white-space: normal; overflow-wrap: anywhere; } th, td { padding: .35em .5em; } }
";

/// A separate page with a link back to the one at `/`; `body` is HTML.
pub fn plain_page(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>facies: {title}</title>\n\
         <style>{PALETTE}{STYLE}</style>\n</head>\n<body>\n\
         <header><a class=\"brand\" href=\"/\">facies</a></header>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )
}
