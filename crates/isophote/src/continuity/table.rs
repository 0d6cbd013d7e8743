//! The report as lines and a table.

use super::codes::CODES;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use continuity::{Answer, Class, EdgeReport, Named, Report, Verdict};
use scene::escaped;

/// Rows that the table prints before it only counts the rest; JSON and HTML list all.
const ROWS: usize = 40;

/// Lines that a list prints.
const LINES: usize = 8;

/// The report for people.
pub fn text(report: &Report) -> String {
    let mut lines = vec![headline(report)];
    lines.extend(settings(report));
    if !report.edges.is_empty() {
        lines.push(table(report));
    }
    if ROWS < report.edges.len() {
        lines.push(format!("… and {} more (--format json and html list all)", report.edges.len() - ROWS));
    }
    lines.extend(borders(report));
    lines.extend(faces(report));
    lines.join("\n")
}

/// How the model stands, in one line.
pub fn headline(report: &Report) -> String {
    let count = |verdict: Verdict| report.edges.iter().filter(|edge| edge.verdict == verdict).count();
    let class = report.class.map_or("no class".to_owned(), |class| format!("class {}", class_name(class)));
    let state = match report.verdict {
        _ if report.edges.is_empty() => "no shared edge",
        Verdict::Pass => "pass",
        Verdict::Fail => "fail",
        Verdict::Undecided => "undecided",
    };
    format!(
        "{}: {state}, {class}; {} shared edges, {} pass, {} fail, {} undecided; hash {}",
        escaped(&report.model),
        report.edges.len(),
        count(Verdict::Pass),
        count(Verdict::Fail),
        count(Verdict::Undecided),
        report.hash
    )
}

/// What was asked, and where neighbours come from.
pub fn settings(report: &Report) -> Vec<String> {
    let limits = report.settings.limits;
    let curvature = limits.curvature.map_or("not judged".to_owned(), |limit| format!("≤ {limit}"));
    let by = report.edges.iter().filter(|edge| edge.edge.is_some()).count();
    let matched = report.edges.len() - by;
    let millimetres = report.settings.millimetres;
    let gap = match limits.gap {
        gap if millimetres == 1.0 => gap.to_string(),
        gap => format!("{gap:.4e} (of {millimetres} mm: {:.4e} mm)", gap * millimetres),
    };
    let matching = format!("by matching borders within {:.3e}", report.settings.reach);
    let neighbours = match (by, matched) {
        (_, 0) => format!("all {by} edges by their numbers in the file"),
        (0, _) => format!("the file names none; {matched} edges {matching}"),
        _ => format!("{by} edges by their numbers in the file, {matched} that it does not name {matching}"),
    };
    vec![
        format!(
            "limits: gap ≤ {gap}, angle ≤ {}°, curvature {curvature}; flat below {:.2e}",
            limits.angle_deg, report.settings.flat
        ),
        format!("neighbours: {neighbours}"),
    ]
}

fn table(report: &Report) -> String {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(header());
    for edge in report.edges.iter().take(ROWS) {
        table.add_row(cells(edge));
    }
    table.to_string()
}

/// The columns of an edge, with the codes of criteria.
pub fn header() -> [String; 9] {
    let judged = |name: &str, code: &str| format!("{name}\n{code}");
    let [gap, angle, curvature] =
        [judged("gap", CODES.gap), judged("angle °", CODES.angle), judged("curvature", CODES.curvature)];
    let plain = ["edge", "faces", "length", "verdict", "class"].map(str::to_owned);
    let [edge, faces, length, verdict, class] = plain;
    [edge, faces, length, verdict, class, gap, angle, curvature, "at worst".to_owned()]
}

/// An edge in the columns of [`header`].
pub fn cells(edge: &EdgeReport) -> [String; 9] {
    let number = edge.edge.map_or("matched".to_owned(), |edge| edge.to_string());
    let [a, b] = &edge.borders;
    let worst = worst(edge);
    let [x, y, z] = worst.at.position;
    let holes = if edge.degenerate.is_empty() {
        String::new()
    } else {
        format!(", {} without a normal", edge.degenerate.len())
    };
    [
        number,
        format!("{} {}\n{} {}", a.face, a.border, b.face, b.border),
        format!("{:.4}", a.length),
        verdict_name(edge.verdict).to_owned() + &holes,
        edge.class.map_or("–", class_name).to_owned(),
        range(&edge.gap),
        range(&edge.angle_deg),
        range(&edge.curvature),
        format!("{:.1} %\n({x:.4}, {y:.4}, {z:.4})", 100.0 * worst.at.share),
    ]
}

/// The answer that decides: the first that is as bad as the edge.
fn worst(edge: &EdgeReport) -> &Answer {
    let answers = [&edge.gap, &edge.angle_deg, &edge.curvature];
    answers.into_iter().find(|answer| answer.verdict == Some(edge.verdict)).unwrap_or(&edge.gap)
}

fn range(answer: &Answer) -> String {
    let mark = answer.verdict.map_or("", |verdict| match verdict {
        Verdict::Pass => "",
        Verdict::Fail => " fail",
        Verdict::Undecided => " undecided",
    });
    format!("≥ {:.3e}\n≤ {:.3e}{mark}", answer.seen, answer.bound)
}

/// What is said of borders beside edges.
pub fn borders(report: &Report) -> Vec<String> {
    let mut lines = vec![];
    list(&mut lines, &coded("free edges", CODES.free), &report.free, of);
    list(&mut lines, &coded("edges of three faces or more", CODES.non_manifold), &report.non_manifold, |edge| {
        edge.borders.iter().map(of).collect::<Vec<_>>().join("; ")
    });
    list(&mut lines, "T-junctions", &report.t_junctions, |junction| {
        let [x, y, z] = junction.position;
        format!("{} ends within {} at ({x:.4}, {y:.4}, {z:.4})", of(&junction.ending), of(&junction.through))
    });
    list(&mut lines, &coded("borders that are points, or shorter than the reach", CODES.points), &report.points, of);
    let turned: Vec<&EdgeReport> = report.edges.iter().filter(|edge| !edge.is_turned_alike).collect();
    list(&mut lines, &coded("edges whose faces are turned to different sides", CODES.turned), &turned, |edge| {
        edge.borders.iter().map(of).collect::<Vec<_>>().join("; ")
    });
    lines
}

/// What is said of faces.
pub fn faces(report: &Report) -> Vec<String> {
    let mut lines = vec![];
    let tightest = report.faces.iter().filter(|face| face.least_radius_seen.is_some());
    let tightest =
        tightest.min_by(|a, b| a.least_radius_seen.unwrap_or(0.0).total_cmp(&b.least_radius_seen.unwrap_or(0.0)));
    if let Some(face) = tightest {
        let ([x, y, z], _) = face.at.unwrap_or_default();
        lines.push(format!(
            "{}: ≤ {:.4e}, ≥ {:.4e}, face {} at ({x:.4}, {y:.4}, {z:.4})",
            coded("least radius of curvature", CODES.radius),
            face.least_radius_seen.unwrap_or(f64::INFINITY),
            face.least_radius_bound,
            face.face
        ));
    }
    let degenerate: Vec<_> = report.faces.iter().filter(|face| !face.degenerate_normals.is_empty()).collect();
    list(
        &mut lines,
        &coded("faces with places without a proven normal", CODES.degenerate_normals),
        &degenerate,
        |face| {
            let (uv, _, kind) = face.degenerate_normals[0];
            format!(
                "face {}: {} places, first {kind} at (u, v) = ({}, {})",
                face.face,
                face.degenerate_normals.len(),
                uv[0],
                uv[1]
            )
        },
    );
    let slivers: Vec<_> = report.faces.iter().filter(|face| face.is_sliver).collect();
    list(&mut lines, &coded("slivers", CODES.sliver), &slivers, |face| {
        format!("face {}: {:.3e} wide on the whole", face.face, face.mean_width)
    });
    list(&mut lines, "not judged", &report.notes, |note| escaped(note).to_string());
    lines
}

fn list<T>(lines: &mut Vec<String>, what: &str, items: &[T], line: impl Fn(&T) -> String) {
    if items.is_empty() {
        return;
    }
    lines.push(format!("{what}: {}", items.len()));
    lines.extend(items.iter().take(LINES).map(|item| format!("  {}", line(item))));
    if LINES < items.len() {
        lines.push("  …".to_owned());
    }
}

fn coded(what: &str, code: &str) -> String {
    format!("{what} ({code})")
}

fn of(border: &Named) -> String {
    format!("face {} {}", border.face, border.border)
}

/// A class's letter.
pub fn class_name(class: Class) -> &'static str {
    match class {
        Class::A => "A",
        Class::B => "B",
        Class::C => "C",
    }
}

/// A verdict's word.
pub fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "pass",
        Verdict::Fail => "fail",
        Verdict::Undecided => "undecided",
    }
}
