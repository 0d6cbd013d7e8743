//! `kanai`: Fig. 3 of Kanai 2007, with numbers.

use crate::compare::DrawingArgs;
use crate::format::Format;
use crate::stage::Stage;
use crate::view::{ModelArgs, ViewArgs};
use crate::{output, say, terminal};
use anyhow::Result;
use clap::Args;
use gbuffer::{GBuffer, Hit, Picture, ShadeKind, Shading};
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

/// Angles between a picture's normals and the ray caster's, degrees, over pixels that show the same face.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Angles {
    /// Pixels compared.
    pub pixels: usize,
    /// Half are below.
    pub median_deg: f64,
    /// 99 of 100 are below.
    pub percentile_99_deg: f64,
    /// The largest.
    pub greatest_deg: f64,
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

/// The angle between the normals of two hits, degrees; `None` where they show different faces, or one has no normal.
pub fn angle_deg(a: &Hit, b: &Hit) -> Option<f64> {
    let (n, m) = (a.normal.unit()?.normalize_or_zero(), b.normal.unit()?);
    // The cross product keeps small angles that the dot product rounds away.
    (a.face == b.face).then(|| n.cross(m).length().atan2(n.dot(m)).to_degrees())
}

/// How far a buffer's normals are from the exact ones.
pub fn angles(buffer: &GBuffer, exact: &GBuffer) -> Angles {
    let mut found: Vec<f64> = buffer.pixels().zip(exact.pixels()).filter_map(|(a, b)| angle_deg(a?, b?)).collect();
    found.sort_by(f64::total_cmp);
    let at = |share: f64| found.get(((found.len() as f64 - 1.0) * share) as usize).copied().unwrap_or(0.0);
    Angles { pixels: found.len(), median_deg: at(0.5), percentile_99_deg: at(0.99), greatest_deg: at(1.0) }
}
