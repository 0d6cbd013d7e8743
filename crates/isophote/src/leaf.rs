//! One HTML file that opens from disk and answers one question: its head with the answer, its figures, its foot with the settings.

use crate::words;
use anyhow::Result;
use std::fmt::Write;
use suite::text::html;

const STYLE: &str = include_str!("../assets/report.css");

/// A page that begins: its title, as HTML; the state that colours the answer, the answer in a word, and in a line of text.
pub fn begun(title: &str, (state, word, line): (&str, &str, &str)) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><title>{title}</title>\
         <link rel=\"icon\" href=\"data:,\"><style>{STYLE}</style></head>\n<body>\n<header><div class=\"wide bar\"><div>\
         <p class=\"brand\">Isophote</p><h1>{title}</h1></div></div>\n\
         <div class=\"verdict {state}\" role=\"status\"><p><strong>{word}</strong>{}</p></div></header>\n<main class=\"wide\">\n",
        html(line)
    )
}

/// A picture, by its address, with a caption, which is HTML.
///
/// # Errors
/// None: a string takes all.
pub fn figure(page: &mut String, caption: &str, uri: &str) -> Result<()> {
    Ok(writeln!(page, "<figure><figcaption>{caption}</figcaption><img src=\"{uri}\" alt=\"{caption}\"></figure>")?)
}

/// The page's end: what it was made by, and the command that makes it again.
///
/// # Errors
/// None: a string takes all.
pub fn ended(mut page: String, facts: &[(&str, String)]) -> Result<String> {
    page.push_str("<section><h2>Settings</h2><table><tbody>\n");
    for (name, value) in facts {
        writeln!(page, "<tr><th scope=\"row\">{name}</th><td>{}</td></tr>", html(value))?;
    }
    writeln!(page, "</tbody></table><h3>Again</h3><code>{}</code></section>", html(&words::again()))?;
    page.push_str("</main>\n<footer class=\"wide quiet\">One file, nothing fetched.</footer>\n</body></html>\n");
    Ok(page)
}
