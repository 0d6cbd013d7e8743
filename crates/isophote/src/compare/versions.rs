//! `compare A B`: two versions of a surface, and how far the second is from each pixel of the first.

use super::args::CompareArgs;
use crate::antialias::Antialias;
use crate::format::Format;
use crate::text::escaped;
use crate::versions::{Measured, Nearest, Report, page};
use crate::view::ModelArgs;
use crate::{output, say, terminal, words};
use anyhow::{Result, bail};
use formats::{Document, Unit};
use gbuffer::Picture;
use raycast::Caster;
use scene::Model;
use std::process::ExitCode;

/// Runs the command.
pub(super) fn run(args: &CompareArgs, [first, second]: [&String; 2]) -> Result<ExitCode> {
    for (is_given, option) in [
        (args.antialias != Antialias::None, "--antialias"),
        (args.approximate.is_asked(), "--approximate"),
        (args.no_gpu, "--no-gpu"),
        (args.drawing.adapter.is_some(), "--adapter"),
    ] {
        if is_given {
            bail!("{option} goes with renderers, and two models are measured from each other, as rays see them");
        }
    }
    let opened = |name: &String| ModelArgs { model: name.clone(), strict: args.strict }.document();
    let Document { model, unit, .. } = opened(first)?;
    let Document { model: other, unit: other_unit, .. } = opened(second)?;
    if let (Some(unit), Some(other)) = (&unit, &other_unit)
        && unit.millimetres != other.millimetres
    {
        bail!(
            "{} is in {}, and {} in {}: a distance between them has no unit",
            escaped(first),
            escaped(&unit.name),
            escaped(second),
            escaped(&other.name)
        );
    }
    let viewport = args.view.viewport()?;
    let camera = args.view.camera(&model, viewport)?;
    let bar = terminal::progress("raycast", viewport.height());
    let buffer = Caster::new(&model).render(&camera, viewport, &|rows| bar.inc(rows as u64));
    let nearest = Nearest::new(other);
    let bar = terminal::progress("nearest points", viewport.height());
    let measured = Measured::new(&buffer, &nearest, &|rows| bar.inc(rows as u64));
    drop(bar);
    let length = unit.or(other_unit).map_or("unit".to_owned(), |Unit { name, .. }| name);
    let words = words::line(args.view.words().into_iter().flatten());
    let view = if words.is_empty() { words } else { format!(" {words}") };
    let report =
        Report::new([first, second], view, &length, args.within, [&model, nearest.model()], &buffer, &measured);
    let pictures =
        [("deviation", measured.deviation_picture(&buffer, &length)), ("angle", measured.angle_picture(&buffer))];
    if let Some(folder) = &args.out {
        for (name, picture) in &pictures {
            output::write(&folder.join(format!("{name}.png")), &picture.png(None)?)?;
        }
        output::write_json(&folder.join("report.json"), &report)?;
    }
    if let Some(path) = &args.report {
        let facts = [
            ("model hashes", [&model, nearest.model()].map(Model::hash).join(", ")),
            ("size", format!("{} x {} pixels", viewport.width(), viewport.height())),
            ("camera", serde_json::to_string(&camera)?),
            ("program", env!("CARGO_PKG_VERSION").to_owned()),
        ];
        output::write(path, page(&report, &buffer, &measured, &facts)?.as_bytes())?;
        if output::is_standard(path) {
            return Ok(ExitCode::from(report.exit_code()));
        }
    }
    match args.format {
        Format::Json => terminal::json(&report)?,
        Format::Table => {
            terminal::show(&Picture::beside(&pictures.each_ref().map(|(_, picture)| picture)))?;
            if let Some(folder) = &args.out {
                say!("pictures and report.json are in {}", folder.display())?;
            }
            if let Some(path) = &args.report {
                say!("the report is {}", path.display())?;
            }
            report.print()?;
        }
    }
    Ok(ExitCode::from(report.exit_code()))
}
