//! Two versions of a surface as one HTML file that opens from disk: the answer, pictures with their legends, the worst places, tables.

use super::measured::{Measured, Spread};
use super::report::{Report, Worst, short};
use crate::brush::Brush;
use crate::leaf;
use crate::words;
use anyhow::Result;
use gbuffer::{GBuffer, Picture};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use std::fmt::Write;
use suite::embedded::data_uri;
use suite::text::html;

/// The ring round a worst place: its radius, half the width of its line, and places along it.
const RING: f64 = 9.0;
const RING_LINE: f64 = 0.9;
const RING_PLACES: usize = 180;

/// The page.
///
/// # Errors
/// Where a picture cannot be encoded.
pub fn page(report: &Report, buffer: &GBuffer, measured: &Measured, facts: &[(&str, String)]) -> Result<String> {
    let [first, second] = report.versions.each_ref().map(|name| html(name));
    let title = format!("{second}, measured from {first}");
    let (state, word) = match (report.exit_code(), report.within) {
        (0, None) => ("partial", "Measured."),
        (0, Some(_)) => ("agree", "Within."),
        (1, _) => ("differ", "Beyond."),
        _ => ("partial", "Nothing was seen."),
    };
    let mut page = leaf::begun(&title, (state, word, &report.line()));
    let unit = html(&report.unit);
    page.push_str("<section><h2>Pictures</h2><div class=\"maps large\">\n");
    let pictures = [
        (format!("Deviation, {unit}"), measured.deviation_picture(buffer, &report.unit), &report.worst_distance),
        ("Angle between the tangent planes, °".to_owned(), measured.angle_picture(buffer), &report.worst_angle),
    ];
    for (caption, picture, worst) in pictures {
        let picture = worst.as_ref().map_or(Ok(picture.clone()), |worst| ringed(&picture, worst))?;
        leaf::figure(&mut page, &caption, &data_uri(&picture)?)?;
    }
    page.push_str(
        "</div><p class=\"quiet\">Above 0 the second version lies on the side that the first one's normal points to. ",
    );
    page.push_str("A ring is round the worst place.</p></section>\n");
    spreads(&mut page, report)?;
    worst_places(&mut page, report)?;
    leaf::ended(page, facts)
}

/// A picture with a ring round a place, white in black.
fn ringed(picture: &Picture, worst: &Worst) -> Result<Picture> {
    let [x, y] = worst.pixel.map(|number| number as f64 + 0.5);
    let along = |k: usize| DVec2::new(x, y) + RING * DVec2::from_angle(TAU * k as f64 / RING_PLACES as f64);
    let places: Vec<DVec2> = (0..RING_PLACES).map(along).collect();
    let mut brush = Brush::new(picture);
    brush.draw(&places, 2.0 * RING_LINE, [0; 3], 1.0);
    brush.draw(&places, RING_LINE, [255; 3], 1.0);
    brush.picture()
}

fn spreads(page: &mut String, report: &Report) -> Result<()> {
    page.push_str(
        "<section><h2>How much</h2><div class=\"scroll\"><table><thead><tr><th>pixels at most</th><th>half</th>",
    );
    page.push_str("<th>90 %</th><th>99 %</th><th>all</th></tr></thead><tbody>\n");
    let rows = [(format!("distance, {}", report.unit), report.distance), ("angle, °".to_owned(), report.angle_deg)];
    for (name, spread) in rows {
        let numbers = match spread {
            Some(Spread { half, percentile_90, percentile_99, greatest }) => {
                [half, percentile_90, percentile_99, greatest].map(short)
            }
            None => ["—"; 4].map(str::to_owned),
        };
        let cells: String = numbers.iter().map(|number| format!("<td class=\"number\">{number}</td>")).collect();
        writeln!(page, "<tr><th scope=\"row\">{}</th>{cells}</tr>", html(&name))?;
    }
    page.push_str("</tbody></table></div><table><tbody>\n");
    let mut counts = vec![
        ("pixels that show the first version", report.seen),
        ("pixels whose nearest point is on a border or a crease of the second", report.beside),
        ("pixels that the ray caster left undecided", report.undecided),
    ];
    counts.extend(report.within.map(|_| ("pixels that are farther off than is allowed", report.beyond)));
    for (what, count) in counts {
        writeln!(page, "<tr><th scope=\"row\">{what}</th><td>{count}</td></tr>")?;
    }
    page.push_str("</tbody></table></section>\n");
    Ok(())
}

fn worst_places(page: &mut String, report: &Report) -> Result<()> {
    let worst = [("farthest", &report.worst_distance), ("most turned", &report.worst_angle)];
    let worst: Vec<(&str, &Worst)> =
        worst.into_iter().filter_map(|(what, worst)| Some((what, worst.as_ref()?))).collect();
    let Some((_, farthest)) = worst.first() else { return Ok(()) };
    let point = |p: DVec3| format!("({}, {}, {})", short(p.x), short(p.y), short(p.z));
    page.push_str("<section><h2>The worst places</h2><div class=\"scroll\"><table><thead><tr><th></th><th>pixel</th>");
    page.push_str("<th>deviation</th><th>angle</th><th>on the first version</th><th>nearest on the second</th></tr></thead><tbody>\n");
    for (what, worst) in &worst {
        let [x, y] = worst.pixel;
        let angle = worst.angle_deg.map_or("—".to_owned(), |angle| format!("{}°", short(angle)));
        let side = |k: usize| {
            let [u, v] = worst.uv[k].map(short);
            format!("face {} at (u, v) = ({u}, {v})<br>{}", worst.face[k], point(worst.position[k]))
        };
        let deviation = format!("{} {}", short(worst.deviation), html(&report.unit));
        writeln!(
            page,
            "<tr><th scope=\"row\">{what}</th><td>{x}, {y}</td><td class=\"number\">{deviation}</td>\
             <td class=\"number\">{angle}</td><td>{}</td><td>{}</td></tr>",
            side(0),
            side(1)
        )?;
    }
    let [x, y] = farthest.pixel;
    let next = format!("isophote pixel {} {x},{y}{}", words::line([report.versions[0].clone()]), report.view);
    writeln!(page, "</tbody></table></div><h3>Next</h3><code>{}</code></section>", html(&next))?;
    Ok(())
}
