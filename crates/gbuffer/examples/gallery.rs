//! Every kind of shading on a torus around a sphere: `cargo run -p gbuffer --example gallery -- DIRECTORY`.
//!
//! The G-buffer is made by hand from the two bodies' equations, so that no renderer is needed.

use gbuffer::{GBuffer, GBufferError, Hit, Meta, Picture, PrincipalCurvatures, ShadeKind, Shading};
use glam::{DVec2, DVec3};
use nurbs::{KnotVector, Normal, Surface};
use scene::{Camera, FaceId, Model, Projection, Ray, Viewport};
use std::f64::consts::TAU;
use std::path::PathBuf;

/// Radius of the sphere, of the torus's middle circle, and of its tube.
const SPHERE: f64 = 0.62;
const CIRCLE: f64 = 1.25;
const TUBE: f64 = 0.42;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let directory = PathBuf::from(std::env::args().nth(1).ok_or("name a directory to write to")?);
    let viewport = Viewport::new(480, 360)?;
    let camera =
        Camera::look_at(DVec3::new(2.6, -4.2, 3.0), DVec3::ZERO, DVec3::Z, Projection::Perspective { fov_deg: 36.0 })?;
    let model = Model::of_surfaces("torus and sphere", vec![plate()?, plate()?])?;
    let meta = Meta::new("gallery", "equations", &model, &camera);
    let rows = (0..viewport.height()).map(|y| {
        (0..viewport.width()).map(|x| first_hit(&camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5))).collect()
    });
    let buffer = GBuffer::from_rows(viewport, meta, rows.collect::<Vec<_>>());
    buffer.write_npz(directory.join("gallery.npz"))?;
    let mut pictures = vec![];
    for kind in ShadeKind::ALL {
        let shading = Shading::new(kind);
        let picture = buffer.shaded(&shading, &model, &camera)?;
        let legend = shading.legend(viewport.height());
        let picture = Picture::beside(&[&picture].into_iter().chain(&legend).collect::<Vec<_>>());
        picture.write_png(directory.join(format!("{}.png", kind.name())))?;
        pictures.push(picture);
    }
    let depth = |x, y| buffer.get(x, y).map(|hit| hit.t);
    let depth = Picture::false_colour(viewport.width(), viewport.height(), depth, [4.0, 7.5]);
    depth.write_png(directory.join("depth.png"))?;
    pictures.push(depth);
    sheet(&pictures, &directory.join("gallery.png"))?;
    Ok(())
}

/// A square as large as the bodies: it lends the model its size and its faces their domains.
fn plate() -> Result<Surface, nurbs::NurbsError> {
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]);
    let (r, h) = (CIRCLE + TUBE, SPHERE);
    let points = vec![DVec3::new(-r, -r, -h), DVec3::new(-r, r, -h), DVec3::new(r, -r, h), DVec3::new(r, r, h)];
    Surface::new(knots()?, knots()?, points, None)
}

/// Where a ray first meets the torus (face 0) or the sphere (face 1), by sphere tracing.
fn first_hit(ray: &Ray) -> Option<Hit> {
    let torus = |p: DVec3| (p.truncate().length() - CIRCLE).hypot(p.z) - TUBE;
    let sphere = |p: DVec3| p.length() - SPHERE;
    let mut t = 0.0;
    // Enough even for rays that graze: each step is the whole distance to the nearest body.
    for _ in 0..2000 {
        let p = ray.at(t);
        let distance = torus(p).min(sphere(p));
        // Below this, model units, the eye cannot tell; the bodies are of unit size.
        if distance < 1e-12 {
            break;
        }
        t += distance;
        if t > 20.0 {
            return None;
        }
    }
    let p = ray.at(t);
    let azimuth = (p.y.atan2(p.x) / TAU).rem_euclid(1.0);
    let (face, uv, normal, k1, k2) = if torus(p) < sphere(p) {
        let out = p - p.truncate().normalize().extend(0.0) * CIRCLE;
        let around = p.truncate().length() - CIRCLE;
        let v = (p.z.atan2(around) / TAU).rem_euclid(1.0);
        let ring = (around / TUBE) / (CIRCLE + around);
        (0, DVec2::new(azimuth, v), out.normalize(), -ring, -1.0 / TUBE)
    } else {
        let v = (p.z / SPHERE).clamp(-1.0, 1.0).asin() * 2.0 / TAU + 0.5;
        (1, DVec2::new(azimuth, v), p.normalize(), -1.0 / SPHERE, -1.0 / SPHERE)
    };
    Some(Hit {
        face: FaceId(face),
        uv,
        local: None,
        t,
        position: p,
        normal: Normal::Regular(normal),
        curvature: Some(PrincipalCurvatures { k1, k2 }),
        edge: None,
    })
}

/// Three pictures a row.
fn sheet(pictures: &[Picture], path: &std::path::Path) -> Result<(), GBufferError> {
    let rows: Vec<Picture> = pictures.chunks(3).map(|row| Picture::beside(&row.iter().collect::<Vec<_>>())).collect();
    let width = rows.iter().map(Picture::width).max().unwrap_or(1);
    let mut rgb = vec![];
    for row in &rows {
        for line in row.rgb().chunks_exact(row.width()) {
            rgb.extend(line);
            rgb.extend(std::iter::repeat_n(gbuffer::background(), width - row.width()));
        }
    }
    Picture::new(width, rows.iter().map(Picture::height).sum(), rgb)?.write_png(path)
}
