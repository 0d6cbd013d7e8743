//! A study as one HTML file that opens from disk: facts, plots, table, and the pictures at the worst pixels.

use super::goal::Goal;
use super::plot::{Plot, Series, svg};
use super::report::Report;
use super::row::{Measured, Outcome};
use super::table::{HEADS, cells, number};
use anyhow::Result;
use plotters::prelude::SeriesLabelPosition;
use std::fmt::Write;
use suite::text::html;

const STYLE: &str = include_str!("../../assets/study.css");

/// The pictures of a row at its worst pixel, as `data:` URIs: the technique's, and the ray caster's.
#[derive(Debug, Clone)]
pub struct Worst {
    /// Which row of the report.
    pub row: usize,
    /// The two pictures.
    pub pictures: [String; 2],
}

/// The page.
///
/// # Errors
/// Where a plot cannot be drawn.
pub fn page(report: &Report, worst: &[Worst]) -> Result<String> {
    let title = format!("Study of {}", html(&report.model));
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{title}</title>\n<style>{STYLE}</style>\n<h1>{title}</h1>\n"
    );
    for fact in facts(report) {
        writeln!(page, "<p class=\"fact\">{}</p>", html(&fact))?;
    }
    page.push_str("<div class=\"plots\">\n");
    for plot in plots(report) {
        if let Some(svg) = svg(&plot)? {
            page.push_str(&svg);
        }
    }
    page.push_str("</div>\n<h2>All rows</h2>\n<div class=\"wide\"><table><thead><tr>");
    for head in HEADS {
        write!(page, "<th>{head}</th>")?;
    }
    page.push_str("</tr></thead><tbody>\n");
    for row in &report.rows {
        let cells = cells(row);
        match &row.outcome {
            Outcome::Measured(_) => {
                page.push_str("<tr>");
                cells.iter().try_for_each(|cell| write!(page, "<td>{}</td>", html(cell)))?;
            }
            // The reason takes the room of all that was not measured.
            Outcome::Failed(_) => {
                let [technique, goal, why] = [0, 1, 2].map(|k| html(&cells[k]));
                let room = HEADS.len() - 2;
                write!(
                    page,
                    "<tr class=\"failed\"><td>{technique}</td><td>{goal}</td><td colspan=\"{room}\">{why}</td>"
                )?;
            }
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</tbody></table></div>\n");
    let untimed: Vec<String> = report
        .measured()
        .flat_map(|(row, m)| m.not_timed.iter().map(move |why| format!("{}, {}: {why}", row.technique, row.goal)))
        .collect();
    list(&mut page, "Not timed", untimed.iter().map(String::as_str))?;
    list(&mut page, "What the numbers are", report.caveats.iter().copied())?;
    page.push_str("<h2>At the worst pixel</h2>\n<p>Left the technique, right the ray caster; the framed pixel has the greatest offset.</p>\n<div class=\"worst\">\n");
    for Worst { row, pictures: [own, exact] } in worst {
        let row = &report.rows[*row];
        let Outcome::Measured(m) = &row.outcome else { continue };
        let Some(at) = m.errors.offset_px.at else { continue };
        writeln!(
            page,
            "<figure><img src=\"{own}\" alt=\"technique\"><img src=\"{exact}\" alt=\"ray caster\"><figcaption>{}, {}: {} px off at {},{} of face {}</figcaption></figure>",
            html(row.technique),
            html(&row.goal.to_string()),
            number(m.errors.offset_px.greatest),
            at.pixel[0],
            at.pixel[1],
            at.face.0
        )?;
    }
    page.push_str("</div>\n</html>\n");
    Ok(page)
}

/// The head of every form of the report.
pub fn facts(report: &Report) -> Vec<String> {
    let Report { model, faces, patches, size: [width, height], threads, frames, seconds, .. } = report;
    let eye = report.camera.eye();
    let gpu = match (&report.adapter, &report.gpu_not_run) {
        (Some(adapter), _) => format!("{} ({})", adapter.name, adapter.driver),
        (None, why) => format!("not run: {}", why.as_deref().unwrap_or("no reason known")),
    };
    vec![
        format!(
            "{model}: {faces} faces, {patches} Bézier patches, hash {}; {width}x{height} pixels",
            report.model_hash
        ),
        format!(
            "seen from {}, {}, {} by {:?}; trims exact, programs specialised by degree",
            number(eye.x),
            number(eye.y),
            number(eye.z),
            report.camera.projection()
        ),
        format!("gpu: {gpu}"),
        format!("raster and raycast on {threads} threads; a time is of up to {frames} frames in about {seconds} s"),
    ]
}

fn list<'a>(page: &mut String, head: &str, items: impl Iterator<Item = &'a str>) -> Result<()> {
    let mut items = items.peekable();
    if items.peek().is_none() {
        return Ok(());
    }
    write!(page, "<h2>{head}</h2>\n<ul>")?;
    for item in items {
        write!(page, "<li>{}</li>", html(item))?;
    }
    page.push_str("</ul>\n");
    Ok(())
}

type Figure = fn(&Measured) -> Option<f64>;

/// The lines of all techniques, of rows by budget or by error; what has neither is a point in both.
fn lines(report: &Report, by_budget: bool, suffix: &str, x: Figure, y: Figure) -> Vec<Series> {
    let mut series: Vec<Series> = vec![];
    for (row, measured) in report.measured() {
        let belongs = match row.goal {
            Goal::Triangles(_) => by_budget,
            Goal::Error(_) => !by_budget,
            Goal::Own => true,
        };
        let Some(point) = x(measured).zip(y(measured)).filter(|_| belongs) else { continue };
        let name = format!("{}{suffix}", row.technique);
        match series.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push(point),
            None => series.push(Series { name, points: vec![point] }),
        }
    }
    series
}

fn plots(report: &Report) -> Vec<Plot> {
    let triangles: Figure = |m| Some(m.triangles as f64);
    let offset: Figure = |m| Some(m.errors.offset_px.greatest);
    let cpu: Figure = |m| m.cpu.as_ref().map(|cost| cost.frame_ms);
    let gpu: Figure = |m| m.gpu.as_ref().map(|cost| cost.frame_ms);
    let fragment: Figure = |m| Some(m.errors.normal_deg.percentile_99);
    let vertex: Figure = |m| m.vertex_normal_deg.as_ref().map(|spread| spread.percentile_99);
    let mut normals = lines(report, true, ", at the fragment", triangles, fragment);
    normals.extend(lines(report, true, ", from corners", triangles, vertex));
    use SeriesLabelPosition::{LowerLeft, UpperLeft, UpperRight};
    let plot = |title, axes, legend, series| Plot { title, axes, series, legend };
    vec![
        plot(
            "Equal triangles: greatest offset",
            ["triangles", "pixels"],
            LowerLeft,
            lines(report, true, "", triangles, offset),
        ),
        plot("Equal triangles: normals, 99th percentile", ["triangles", "degrees"], LowerLeft, normals),
        plot(
            "Equal triangles: a frame on the GPU",
            ["triangles", "ms"],
            UpperLeft,
            lines(report, true, "", triangles, gpu),
        ),
        plot(
            "Equal triangles: a frame on the CPU",
            ["triangles", "ms"],
            UpperLeft,
            lines(report, true, "", triangles, cpu),
        ),
        plot(
            "Equal error: a frame on the GPU",
            ["greatest offset, pixels", "ms"],
            UpperRight,
            lines(report, false, "", offset, gpu),
        ),
        plot(
            "Equal error: a frame on the CPU",
            ["greatest offset, pixels", "ms"],
            UpperRight,
            lines(report, false, "", offset, cpu),
        ),
    ]
}
