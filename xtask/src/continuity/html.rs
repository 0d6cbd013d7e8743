//! The report as one page to print and sign: verdict, edges drawn by class, table, settings, the model's hash.
//!
//! The picture is a line drawing of the edges, without what hides them. Zebra stripes under it are missing.

use super::table;
use crate::text::escaped;
use continuity::{Class, Report, Verdict};
use glam::DVec3;
use scene::{Camera, Model, Viewport};
use std::fmt::Write;

const STYLE: &str = include_str!("../../assets/report.css");

/// The page's own rules, after the style of reports.
const OWN: &str =
    "svg { background: var(--card); border: 1px solid var(--line); border-radius: 12px; width: 100%; height: auto; }
pre { white-space: pre-wrap; font: 13px/1.5 var(--mono); }
td { white-space: pre-line; }
.sign { display: grid; grid-template-columns: 1fr 1fr 1fr; gap: 32px; margin: 56px 0 40px; }
.sign div { border-top: 1px solid var(--ink); padding-top: 4px; font-size: 13px; color: var(--quiet); }
@media print { body { font-size: 11px; } section { break-inside: auto; } tr { break-inside: avoid; } }";

/// Pixels of the picture.
const SIZE: [usize; 2] = [1200, 800];

/// The page.
pub fn page(report: &Report, model: &Model) -> String {
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
    section(&mut page, "Edges by class", &format!("{LEGEND}{}", picture(report, model)));
    section(&mut page, "Edges, worst first", &rows(report));
    section(&mut page, "Borders", &preformatted(&table::borders(report)));
    section(&mut page, "Faces", &preformatted(&table::faces(report)));
    page.push_str(
        "<p class=\"quiet\">Each value lies between the two numbers: the upper is proven for all of the edge, the lower \
         was seen at the place given. The picture hides no line behind a face, and has no zebra stripes.</p>\n\
         <div class=\"sign\"><div>Name</div><div>Date</div><div>Signature</div></div>\n</main>\n</body>\n</html>",
    );
    page
}

const LEGEND: &str = "<p class=\"lead\">Class A green, B blue, C orange, none red, free edges grey and dashed.</p>";

fn section(page: &mut String, title: &str, body: &str) {
    let body = if body.is_empty() { "<p class=\"quiet\">Nothing to say.</p>" } else { body };
    let _ = writeln!(page, "<section><h2>{title}</h2>{body}</section>");
}

fn preformatted(lines: &[String]) -> String {
    if lines.is_empty() { String::new() } else { format!("<pre>{}</pre>", html(&lines.join("\n"))) }
}

fn rows(report: &Report) -> String {
    let header: String = table::HEADER.iter().map(|name| format!("<th>{}</th>", html(name))).collect();
    let row = |edge: &continuity::EdgeReport| -> String {
        let cells: String = table::cells(edge).iter().map(|cell| format!("<td>{}</td>", html(cell))).collect();
        format!("<tr>{cells}</tr>")
    };
    let rows: String = report.edges.iter().map(row).collect();
    format!("<div class=\"scroll\"><table><thead><tr>{header}</tr></thead><tbody>{rows}</tbody></table></div>")
}

/// The edges as lines, as a camera that frames the model sees them.
fn picture(report: &Report, model: &Model) -> String {
    let Ok(viewport) = Viewport::new(SIZE[0], SIZE[1]) else { return String::new() };
    let camera = Camera::framing(model, viewport);
    let project = |p: &[f64; 3]| {
        let at = DVec3::from_array(*p) - camera.eye();
        let scale = 0.5 * SIZE[1] as f64 / camera.half_height() / at.dot(camera.forward());
        let [x, y] = [at.dot(camera.right()), at.dot(camera.above())];
        (0.5 * SIZE[0] as f64 + scale * x, 0.5 * SIZE[1] as f64 - scale * y)
    };
    let mut drawing =
        format!("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"Edges by class\">", SIZE[0], SIZE[1]);
    let mut line = |path: &[[f64; 3]], style: &str| {
        let points: String = path.iter().map(project).map(|(x, y)| format!("{x:.1},{y:.1} ")).collect();
        let _ = write!(drawing, "<polyline fill=\"none\" {style} points=\"{}\"/>", points.trim_end());
    };
    for border in &report.free {
        line(&border.path, "stroke=\"#888\" stroke-width=\"1\" stroke-dasharray=\"4 3\"");
    }
    // The worst last, so that nothing covers it.
    for edge in report.edges.iter().rev() {
        let colour = match edge.class {
            Some(Class::A) => "#0b7a4b",
            Some(Class::B) => "#2456c9",
            Some(Class::C) => "#d07800",
            None => "#b3261e",
        };
        line(&edge.borders[0].path, &format!("stroke=\"{colour}\" stroke-width=\"1.6\""));
    }
    drawing + "</svg>"
}

/// Text with nothing in it that a page takes for markup, nor hidden characters.
fn html(text: &str) -> String {
    let visible: Vec<_> = text.lines().map(escaped).collect();
    visible.join("\n").replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
