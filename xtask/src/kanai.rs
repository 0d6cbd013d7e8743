//! `kanai`: Fig. 3 of Kanai 2007, with numbers.

use anyhow::Result;
use clap::Args;
use gbuffer::{GBuffer, Picture, ShadeKind, Shading};
use isophote::angles::{Angles, angles};
use isophote::compare::DrawingArgs;
use isophote::format::Format;
use isophote::stage::Stage;
use isophote::view::{ModelArgs, ViewArgs};
use isophote::{output, say, terminal};
use raycast::Caster;
use serde::Serialize;
use std::path::PathBuf;
use std::sync::Arc;
use techniques::fragment::Tessellation;

/// Reproduce Kanai's Fig. 3: isophotes from interpolated vertex normals and from per-fragment normals
///
/// The same coarse tessellation is shaded twice. Writes vertex-normals.png, fragment-normals.png, raycast.png and
/// beside.png, and prints the angular error of each against the ray caster.
#[derive(Debug, Args)]
pub struct KanaiArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    drawing: DrawingArgs,
    /// Cells of the tessellation along each parameter of every face
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u16).range(1..=1024))]
    cells: u16,
    /// Where the pictures go
    #[arg(long, value_name = "DIR", default_value = "out/kanai")]
    out: PathBuf,
    /// For people or for machines
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

#[derive(Serialize)]
struct Report {
    model: String,
    triangles: usize,
    vertex_normals: Angles,
    fragment_normals: Angles,
}

/// Runs the command.
///
/// # Errors
/// Where input is bad or a picture cannot be written.
pub fn run(args: &KanaiArgs) -> Result<()> {
    let model = args.model.open()?;
    let viewport = args.view.viewport()?;
    let camera = args.view.camera(&model, viewport)?;
    let mut stage = Stage::new(&model, camera, viewport, args.drawing.plan())?;
    stage.prepared = Arc::new(Tessellation::uniform(&model, &stage.scene, usize::from(args.cells))?);
    let [vertex, fragment] = buffers(&stage);
    let exact = stage.raycast(&Caster::new(&model));
    let report = Report {
        model: model.name().to_owned(),
        triangles: stage.prepared.triangles(),
        vertex_normals: angles(&vertex, &exact),
        fragment_normals: angles(&fragment, &exact),
    };
    output::folder(&args.out)?;
    let shading = Shading::new(ShadeKind::Isophotes);
    let mut pictures = vec![];
    for (name, buffer) in [("vertex-normals", &vertex), ("fragment-normals", &fragment), ("raycast", &exact)] {
        let picture = buffer.shaded(&shading, &model, &camera)?;
        picture.write_png(args.out.join(format!("{name}.png")))?;
        pictures.push(picture);
    }
    Picture::beside(&pictures.iter().collect::<Vec<_>>()).write_png(args.out.join("beside.png"))?;
    match args.format {
        Format::Json => terminal::json(&report)?,
        Format::Table => {
            terminal::show(&Picture::beside(&pictures.iter().collect::<Vec<_>>()))?;
            say!("{}: {} triangles, angle to the ray caster's normal, degrees", report.model, report.triangles)?;
            for (name, a) in [("vertex normals", report.vertex_normals), ("fragment normals", report.fragment_normals)]
            {
                say!(
                    "{name:18} median {:.2e}, 99 % below {:.2e}, greatest {:.2e}, {} pixels",
                    a.median_deg,
                    a.percentile_99_deg,
                    a.greatest_deg,
                    a.pixels
                )?;
            }
            say!("pictures are in {}", args.out.display())?;
        }
    }
    Ok(())
}

/// The G-buffers with normals interpolated from the vertices, and with the fragments' own.
pub fn buffers(stage: &Stage) -> [GBuffer; 2] {
    [true, false].map(|vertex_normals| {
        let options = raster::Options { curvature: false, vertex_normals };
        stage.rasterizer(options).render(stage.meta("raster"), &|_| {})
    })
}
