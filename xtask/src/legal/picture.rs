//! A picture as an adapter of the worst legal arithmetic draws it: who covers a pixel is the CPU rasterizer's to say, what is
//! seen there comes of the WGSL program.
//!
//! The fixed-function stages stay as they are, but for the interpolated parameters: they are off by as much as the project
//! assumes of an adapter ([`ATTRIBUTE_ULPS`]).

use super::arithmetic::{Arithmetic, Direction, Fault};
use super::machine::Machine;
use super::program::{Program, Source};
use anyhow::{Context, Result, ensure};
use bytemuck::cast_slice;
use compare::ATTRIBUTE_ULPS;
use gbuffer::{GBuffer, Hit};
use isophote::stage::Stage;
use nurbs::NormalStatus;
use pipeline::fragment::{Fragment, is_on_skirt};
use pipeline::wgsl::{self, Variant};
use pipeline::{BOUNDED, Parameters, edge};
use raster::coverage::for_each_covered;
use raster::geometry::{Attributes, Geometry};
use raster::rect::Rect;
use raster::setup::Triangle;
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::BTreeMap;
use techniques::exact::{Hulls, PieceRecord};

/// Corners of a hull.
const CORNERS: u32 = 8;

/// Where the words of `SkirtGBufferOutput` have the depth.
const SKIRT_DEPTH: usize = 16;

/// The functions of technique `exact` that are called, each by its name.
pub const CALLED: [&str; 4] = ["sight", "solve", "fragment", "gbuffer_output"];

/// An adapter: a seed, and what is wrong with it.
#[derive(Debug, Clone, Copy)]
pub struct Adapter {
    /// By which it chooses.
    pub seed: u64,
    /// Which values it takes.
    pub direction: Direction,
    /// What it does that is not permitted.
    pub fault: Option<Fault>,
}

impl Adapter {
    /// A legal one.
    pub fn legal(seed: u64) -> Self {
        Self { seed, direction: Direction::of_seed(seed), fault: None }
    }

    /// The one that answers as the CPU rasterizer does.
    pub const STRICT: Self = Self { seed: 0, direction: Direction::Strict, fault: None };
}

/// Who may be seen at a pixel.
#[derive(Debug, Clone)]
enum Candidate {
    /// A triangle, at a depth.
    Sample { depth: f32, face: u32, span: [u32; 2], uv: [f32; 2] },
    /// A hull's piece.
    Piece(PieceRecord),
}

/// A stage made ready to be drawn by many adapters.
pub struct Scene<'s> {
    stage: &'s Stage<'s>,
    /// Of each program of the scene's faces.
    sources: BTreeMap<pipeline::Program, Source>,
    /// Of each pixel, row by row: triangles from the nearest on, of equal depths in their order; or pieces in their order.
    candidates: Vec<Vec<Candidate>>,
}

impl<'s> Scene<'s> {
    /// Prepares a stage whose faces no masks trim, and whose technique is `fragment` or `exact`.
    ///
    /// # Errors
    /// Where a program cannot be read.
    pub fn new(stage: &'s Stage<'s>) -> Result<Self> {
        Self::with_source(stage, &wgsl::source)
    }

    /// The same with other texts of the programs.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_source(stage: &'s Stage<'s>, source: &dyn Fn(Variant) -> String) -> Result<Self> {
        let programs = stage.scene.programs().iter().copied();
        let technique = stage.plan.technique;
        let read = |program| {
            let variant = Variant {
                parts: technique.parts(),
                program,
                curvature: true,
                vertex_normals: false,
                trims: stage.scene.trim_method(),
            };
            Ok((program, Source::new(&source(variant))?))
        };
        let sources = programs.map(read).collect::<Result<_>>()?;
        let candidates = match stage.prepared.mesh() {
            Some(_) => samples(stage).context("the technique draws no triangles")?,
            None => {
                let hulls = Hulls::new(stage.model, &stage.scene, &stage.camera, stage.viewport)?;
                pieces(stage, &hulls)
            }
        };
        Ok(Self { stage, sources, candidates })
    }

    /// The G-buffer of an adapter; the same for any number of threads.
    ///
    /// # Errors
    /// Where a program does not end, cannot be run, or shows a face that is not there.
    pub fn draw(&self, adapter: Adapter) -> Result<GBuffer> {
        let is_exact = self.stage.prepared.mesh().is_none();
        let entries: &[&str] = if is_exact { &CALLED } else { &["fragment_gbuffer", "skirt_gbuffer"] };
        let programs = self.sources.iter().map(|(&kind, source)| Ok((kind, Program::new(source, entries)?)));
        let programs: BTreeMap<pipeline::Program, Program> = programs.collect::<Result<_>>()?;
        let (width, height) = (self.stage.viewport.width(), self.stage.viewport.height());
        // Of each pixel what is seen, and whether a search ended without an answer.
        let row = |y: usize| -> Result<Vec<(Option<Hit>, bool)>> {
            let mut machines = BTreeMap::new();
            for (&kind, program) in &programs {
                let arithmetic = Arithmetic::new(0, adapter.direction, adapter.fault);
                machines.insert(kind, Machine::new(program, arithmetic, |group, binding| self.bound(group, binding))?);
            }
            let mut pixels = Vec::with_capacity(width);
            for x in 0..width {
                let seed = (adapter.seed << 32) ^ (y * width + x) as u64;
                let arithmetic = Arithmetic::new(seed, adapter.direction, adapter.fault);
                machines.values_mut().for_each(|machine| machine.arithmetic = arithmetic.clone());
                let (fragment, is_undecided) = self.pixel(&mut machines, [x, y])?;
                if let Some(Fragment { face, .. }) = fragment {
                    ensure!(
                        (face as usize) < self.stage.scene.faces().len(),
                        "({x}, {y}) shows a face that is not there"
                    );
                }
                let ray = self.stage.camera.ray(self.stage.viewport, x as f64 + 0.5, y as f64 + 0.5);
                pixels.push((fragment.map(|fragment| self.stage.scene.hit(&fragment, &ray)), is_undecided));
            }
            Ok(pixels)
        };
        let rows = (0..height).into_par_iter().map(row).collect::<Result<Vec<_>>>()?;
        let hits = rows.iter().map(|row| row.iter().map(|(hit, _)| *hit).collect());
        let buffer = GBuffer::from_rows(self.stage.viewport, self.stage.meta("legal"), hits);
        let undecided = rows.iter().flatten().enumerate().filter(|(_, (_, is_undecided))| *is_undecided);
        let undecided: Vec<(usize, usize)> = undecided.map(|(i, _)| (i % width, i / width)).collect();
        Ok(buffer.with_undecided(undecided).with_edges(self.stage.scene.has_edges()))
    }

    /// What the scene's bindings hold.
    fn bound(&self, group: u32, binding: u32) -> Option<Vec<u32>> {
        let scene = &self.stage.scene;
        let bytes: &[u8] = match (group, binding) {
            (0, 0) => cast_slice(scene.faces()),
            (0, 1) => cast_slice(&self.stage.views),
            (0, 2) => cast_slice(scene.knots()),
            (0, 3) => cast_slice(scene.points()),
            _ => return None,
        };
        Some(bytemuck::pod_collect_to_vec(bytes))
    }

    /// What is seen at a pixel, and whether a search ended there without an answer.
    fn pixel(
        &self,
        machines: &mut BTreeMap<pipeline::Program, Machine>,
        [x, y]: [usize; 2],
    ) -> Result<(Option<Fragment>, bool)> {
        let at = [x as f32 + 0.5, y as f32 + 0.5];
        // By triangles the words that are shown, by pieces the face and the place; each with its depth.
        let mut shown: Option<(f32, Vec<u32>)> = None;
        let mut nearest: Option<(f32, u32, [u32; 4])> = None;
        let mut is_undecided = false;
        for candidate in &self.candidates[y * self.stage.viewport.width() + x] {
            match candidate {
                &Candidate::Sample { depth, face, span, uv } => {
                    let machine = self.machine(machines, face);
                    let uv = uv.map(|t| interpolated(&mut machine.arithmetic, t));
                    let input = sample_words(at, face, span, uv);
                    let is_nearer = |depth: f32| shown.as_ref().is_none_or(|(old, _)| depth > *old);
                    let record = &self.stage.scene.faces()[face as usize];
                    if record.flags & BOUNDED != 0 && is_on_skirt(record, Parameters { span, uv }) {
                        if let Some(words) = machine.call("skirt_gbuffer", &[&input])? {
                            let depth = f32::from_bits(words[SKIRT_DEPTH]);
                            if is_nearer(depth) {
                                shown = Some((depth, words));
                            }
                        }
                    } else if is_nearer(depth)
                        && let Some(words) = machine.call("fragment_gbuffer", &[&input])?
                    {
                        shown = Some((depth, words));
                    }
                }
                Candidate::Piece(piece) => {
                    let view = &self.stage.views[piece.face as usize];
                    let machine = self.machine(machines, piece.face);
                    let view: &[u32] = cast_slice(std::slice::from_ref(view));
                    let sight = machine.call("sight", &[view, &at.map(f32::to_bits)])?.expect("it does not discard");
                    let record: &[u32] = cast_slice(std::slice::from_ref(piece));
                    let outcome = machine.call("solve", &[record, &sight])?.expect("it does not discard");
                    let [status, u, v, depth] = outcome[..] else { unreachable!("an outcome has four words") };
                    is_undecided |= status == 2;
                    // The bits of depths from 0 to 1 stand in their order; of equal ones the first stays.
                    let depth = f32::from_bits(depth & 0x7fff_ffff);
                    if status == 0 && depth > 0.0 && nearest.is_none_or(|(old, ..)| depth > old) {
                        nearest = Some((depth, piece.face, [piece.span_u, piece.span_v, u, v]));
                    }
                }
            }
        }
        if let Some((_, words)) = shown {
            return Ok((Some(self.fragment(&words)), false));
        }
        let Some((_, face, place)) = nearest else { return Ok((None, is_undecided)) };
        let machine = self.machine(machines, face);
        let fragment = machine.call("fragment", &[&[face], &place])?.expect("it does not discard");
        let words = machine.call("gbuffer_output", &[&[face], &fragment, &at.map(f32::to_bits)])?;
        Ok((Some(self.fragment(&words.expect("it does not discard"))), is_undecided))
    }

    fn machine<'a, 'p>(
        &self,
        machines: &'a mut BTreeMap<pipeline::Program, Machine<'p>>,
        face: u32,
    ) -> &'a mut Machine<'p> {
        machines.get_mut(&self.stage.scene.programs()[face as usize]).expect("one for each program of the scene")
    }

    /// The words of `GBufferOutput`, as the CPU reads them.
    fn fragment(&self, words: &[u32]) -> Fragment {
        let real = |k: usize| f32::from_bits(words[k]);
        let (status, edge) = if self.stage.scene.has_edges() { edge::unpacked(words[1]) } else { (words[1], None) };
        Fragment {
            face: words[0].wrapping_sub(1),
            uv: [real(7), real(11)],
            span: [words[2], words[3]],
            position: [real(4), real(5), real(6)],
            normal: [real(8), real(9), real(10)],
            status: if status == 0 { NormalStatus::Regular } else { NormalStatus::Undefined },
            curvature: [real(12), real(13)],
            speed: [real(14), real(15)],
            edge,
        }
    }
}

/// A parameter as an adapter may interpolate it: the CPU rasterizer's own is off by less than one of these units.
fn interpolated(arithmetic: &mut Arithmetic, t: f32) -> f32 {
    if arithmetic.is_strict() {
        return t;
    }
    let off = (ATTRIBUTE_ULPS - 1.0) * (2.0 * arithmetic.random.unit() - 1.0);
    (f64::from(t) + off / f64::from(1 << 24)) as f32
}

/// `VertexOutput` as the fragment stage takes it.
fn sample_words(at: [f32; 2], face: u32, span: [u32; 2], uv: [f32; 2]) -> [u32; 15] {
    let mut words = [0; 15];
    words[..2].copy_from_slice(&at.map(f32::to_bits));
    words[4..6].copy_from_slice(&uv.map(f32::to_bits));
    words[6] = face;
    words[13..].copy_from_slice(&span);
    words
}

/// The triangles that cover each pixel's centre.
fn samples(stage: &Stage) -> Option<Vec<Vec<Candidate>>> {
    let geometry = Geometry::new(Cow::Borrowed(stage.prepared.mesh()?), &stage.views, stage.viewport);
    let mut candidates = vec![vec![]; stage.viewport.pixels()];
    for_each_triangle(&geometry, stage, |id, triangle, x, y| {
        let depth = triangle.depth(x, y);
        if depth > 0.0 {
            let Attributes { face, span, uv, .. } = geometry.attributes(id);
            let uv = triangle.interpolate(triangle.weights(x, y), uv);
            let pixel = y as usize * stage.viewport.width() + x as usize;
            candidates[pixel].push(Candidate::Sample { depth, face, span, uv });
        }
    });
    let depth = |candidate: &Candidate| match candidate {
        Candidate::Sample { depth, .. } => *depth,
        Candidate::Piece(_) => 0.0,
    };
    // Stable: of equal depths the first stays in front.
    candidates.iter_mut().for_each(|pixel| pixel.sort_by(|a, b| depth(b).total_cmp(&depth(a))));
    Some(candidates)
}

/// The pieces of whose hulls the far side covers each pixel's centre.
fn pieces(stage: &Stage, hulls: &Hulls) -> Vec<Vec<Candidate>> {
    let geometry = Geometry::new(Cow::Borrowed(&hulls.mesh), &stage.views, stage.viewport);
    let mut candidates = vec![vec![]; stage.viewport.pixels()];
    for_each_triangle(&geometry, stage, |id, triangle, x, y| {
        if !triangle.is_counterclockwise() {
            let piece = hulls.pieces[(geometry.first_vertex(id) / CORNERS) as usize];
            candidates[y as usize * stage.viewport.width() + x as usize].push(Candidate::Piece(piece));
        }
    });
    candidates
}

/// Calls `visit` with every triangle or piece of one and each pixel whose centre it covers.
fn for_each_triangle(geometry: &Geometry, stage: &Stage, mut visit: impl FnMut(u32, &Triangle, i32, i32)) {
    let whole = Rect { left: 0, top: 0, right: stage.viewport.width() as i32, bottom: stage.viewport.height() as i32 };
    for i in 0..geometry.triangles() {
        geometry.ids(i, |id| {
            if let Some(triangle) = Triangle::new(geometry.corners(id), [0.0; 2]) {
                for_each_covered(&triangle, whole, |x, y| visit(id, &triangle, x, y));
            }
        });
    }
}
