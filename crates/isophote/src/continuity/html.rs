//! The report as one page to print and sign: verdict, a picture with the edges by class, table, settings, the model's hash.

use super::table;
use crate::overlay::{Mark, Overlay};
use anyhow::Result;
use continuity::{Report, Verdict};
use gbuffer::Picture;
use std::fmt::Write;
use suite::embedded::data_uri;
use suite::text::html;

const STYLE: &str = include_str!("../../assets/report.css");

/// The page's own rules, after the style of reports.
const OWN: &str =
    "figure { margin: 0; } figure img { border-radius: 12px; width: 100%; height: auto; }
.marks { display: flex; flex-wrap: wrap; gap: 6px 22px; margin: 10px 0 0; padding: 0; list-style: none; font-size: 14px; }
.marks i { display: inline-block; width: 26px; height: 4px; border-radius: 2px; margin-right: 8px; vertical-align: middle; }
pre { white-space: pre-wrap; font: 13px/1.5 var(--mono); }
td { white-space: pre-line; }
.sign { display: grid; grid-template-columns: 1fr 1fr 1fr; gap: 32px; margin: 56px 0 40px; }
.sign div { border-top: 1px solid var(--ink); padding-top: 4px; font-size: 13px; color: var(--quiet); }
@media print { body { font-size: 11px; } section { break-inside: auto; } tr { break-inside: avoid; } }";

/// The page, with a picture of isophotes beside zebra stripes.
///
/// # Errors
/// Where the picture cannot be encoded.
pub fn page(report: &Report, picture: &Picture) -> Result<String> {
    let state = match report.verdict {
        _ if report.edges.is_empty() => "partial",
        Verdict::Pass => "agree",
        Verdict::Fail => "differ",
        Verdict::Undecided => "partial",
    };
    let title = format!("Continuity of {}", html(&report.model));
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <link rel=\"icon\" href=\"data:,\">\n<style>{STYLE}\n{OWN}</style>\n</head>\n<body>\n<header>\n\
         <div class=\"wide bar\"><div><p class=\"brand\">Isophote</p><h1>{title}</h1>\
         <p class=\"quiet\">Model hash {}</p></div></div>\n\
         <div class=\"verdict {state}\" role=\"status\"><p>{}</p></div>\n</header>\n<main class=\"wide\">\n",
        html(&report.hash),
        html(&table::headline(report))
    );
    section(&mut page, "Settings", &preformatted(&table::settings(report)));
    section(&mut page, "Edges by class", &figure(report, picture)?);
    section(&mut page, "Edges, worst first", &rows(report));
    section(&mut page, "Borders", &preformatted(&table::borders(report)));
    section(&mut page, "Faces", &preformatted(&table::faces(report)));
    page.push_str(
        "<p class=\"quiet\">Each value lies between the two numbers: the upper is proven for all of the edge, the lower \
         was seen at the place given.</p>\n\
         <div class=\"sign\"><div>Name</div><div>Date</div><div>Signature</div></div>\n</main>\n</body>\n</html>",
    );
    Ok(page)
}

fn section(page: &mut String, title: &str, body: &str) {
    let body = if body.is_empty() { "<p class=\"quiet\">Nothing to say.</p>" } else { body };
    let _ = writeln!(page, "<section><h2>{title}</h2>{body}</section>");
}

fn preformatted(lines: &[String]) -> String {
    if lines.is_empty() { String::new() } else { format!("<pre>{}</pre>", html(&lines.join("\n"))) }
}

fn rows(report: &Report) -> String {
    let header: String = table::header().iter().map(|name| format!("<th>{}</th>", html(name))).collect();
    let row = |edge: &continuity::EdgeReport| -> String {
        let cells: String = table::cells(edge).iter().map(|cell| format!("<td>{}</td>", html(cell))).collect();
        format!("<tr>{cells}</tr>")
    };
    let rows: String = report.edges.iter().map(row).collect();
    format!("<div class=\"scroll\"><table><thead><tr>{header}</tr></thead><tbody>{rows}</tbody></table></div>")
}

/// The picture, and how many edges have which colour.
fn figure(report: &Report, picture: &Picture) -> Result<String> {
    let overlay = Overlay::of(report);
    let mark = |mark: Mark| {
        let [red, green, blue] = mark.colour();
        let (name, count) = (mark.name(), overlay.count(mark));
        format!("<li><i style=\"background:#{red:02x}{green:02x}{blue:02x}\"></i>{name}: {count}</li>")
    };
    let marks: String = Mark::ALL.into_iter().filter(|mark| 0 < overlay.count(*mark)).map(mark).collect();
    Ok(format!(
        "<figure><img alt=\"Isophotes and zebra stripes with the edges by class\" width=\"{}\" height=\"{}\" src=\"{}\">\
         <figcaption><ul class=\"marks\">{marks}</ul>\
         <p class=\"quiet\">Isophotes on the left, zebra stripes on the right; edges are drawn where they are seen.</p>\
         </figcaption></figure>",
        picture.width(),
        picture.height(),
        data_uri(picture)?
    ))
}
