//! What a window shows, and what is done to it: no window is needed for that.

use super::args::ViewerArgs;
use super::drawer::{Drawer, Scene};
use super::judging::{Judging, Question};
use super::reading::{Reading, Told};
use crate::compare::DrawingArgs;
use crate::look::{LookArgs, Opened, Painter};
use crate::output;
use crate::stage::Stage;
use crate::view::{ModelArgs, ViewArgs};
use crate::with::With;
use crate::words::{self, Words};
use ::view::{control, light, orbit};
use anyhow::{Context, Result};
use clap::Parser;
use export::{Asked, export};
use formats::Document;
use gbuffer::{GBuffer, Picture};
use glam::{DVec2, DVec3};
use scene::{Camera, FaceId, Model, Projection, Viewport};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use techniques::Technique;

/// How long nothing moves before the picture is drawn in full.
const REST: Duration = Duration::from_millis(150);

/// How long it takes to look whether a verdict has come.
const LISTEN: Duration = Duration::from_millis(50);

/// A frame that takes longer makes the next ones smaller, while something moves; one that takes a quarter of it, larger.
const SLOW: Duration = Duration::from_millis(80);

/// The most pixels along a side that a frame has one for, while something moves.
const COARSEST: usize = 8;

/// The way of the mouse across the picture's height that turns the model by half a turn, in heights.
const HALF_TURN_RAD: f64 = std::f64::consts::PI;

/// How near a control point must be to the mouse to be meant, pixels.
const REACH_PX: f64 = 12.0;

/// What a step of the wheel leaves of the distance.
const STEP: f64 = 0.9;

/// The angle that a perspective view has after a parallel one, degrees.
const FOV_DEG: f64 = 40.0;

/// What saved pictures are called unless told.
const PICTURE: &str = "view.png";

/// How far the picture is behind what is to be shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shown {
    /// Not at all, and drawn in full.
    AtRest,
    /// Drawn in haste, then.
    Moving(Instant),
    /// It shows what was before.
    Behind,
    /// It is to be drawn in full at once.
    Awaited,
}

/// Files that were written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Saved {
    /// The picture.
    pub picture: PathBuf,
    /// The edited model, where it was edited.
    pub model: Option<PathBuf>,
    /// The command that draws the picture again.
    pub command: Vec<String>,
}

/// What is shown, and how.
pub struct Session<'d> {
    model: ModelArgs,
    document: Document,
    is_edited: bool,
    /// What stays upright while the model is turned.
    axis: DVec3,
    camera: Camera,
    viewport: Viewport,
    drawing: DrawingArgs,
    look: LookArgs,
    /// What its options named.
    opened: Opened,
    out: PathBuf,
    reading: Option<Reading>,
    /// What is said of it.
    judging: Judging,
    /// The face whose control points are shown and can be moved: that of the pixel that was picked last.
    selected: Option<FaceId>,
    grabbed: Option<(FaceId, [usize; 2])>,
    drawer: Drawer<'d>,
    shown: Shown,
    picture: Option<Picture>,
    /// What the picture at rest is made of.
    at_rest: Option<Arc<GBuffer>>,
    /// How the picture was painted that was last made of a G-buffer.
    painter: Option<Painter>,
    coarseness: usize,
    frames: usize,
    took: Duration,
}

impl<'d> Session<'d> {
    /// A session that begins with what the arguments ask for; nothing is drawn yet. `device` is the GPU, where it is to draw.
    ///
    /// # Errors
    /// Where the arguments make no scene.
    pub fn new(args: &ViewerArgs, device: Option<&'d gpu::Device>) -> Result<Self> {
        args.look.check()?;
        let document = args.model.document()?;
        let viewport = args.view.viewport()?;
        let camera = args.view.camera(&document.model, viewport)?;
        let axis = args.view.up.as_deref().map(DVec3::from_slice).and_then(DVec3::try_normalize).unwrap_or(DVec3::Z);
        Ok(Self {
            model: args.model.clone(),
            document,
            is_edited: false,
            axis,
            camera,
            viewport,
            drawing: args.drawing.clone(),
            look: args.look.clone(),
            opened: args.look.opened()?,
            out: args.out.clone().unwrap_or_else(|| PathBuf::from(PICTURE)),
            reading: None,
            judging: Judging::default(),
            selected: None,
            grabbed: None,
            drawer: Drawer::new(args.with, device),
            shown: Shown::Awaited,
            picture: None,
            at_rest: None,
            painter: None,
            coarseness: 1,
            frames: 0,
            took: Duration::ZERO,
        })
    }

    /// The model as it is now.
    pub fn model(&self) -> &Model {
        &self.document.model
    }

    /// Who looks.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Pictures drawn so far, in haste or in full.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// What the last of them took.
    pub fn took(&self) -> Duration {
        self.took
    }

    /// At how many pixels the camera looks.
    pub fn viewport(&self) -> Viewport {
        self.viewport
    }

    /// What the picture shows, and how.
    pub fn look(&self) -> &LookArgs {
        &self.look
    }

    /// Whether a control point was moved.
    pub fn is_edited(&self) -> bool {
        self.is_edited
    }

    /// The picture as it was last drawn; it may have fewer pixels than the viewport.
    pub fn picture(&self) -> Option<&Picture> {
        self.picture.as_ref()
    }

    /// The picked pixel.
    pub fn reading(&self) -> Option<&Reading> {
        self.reading.as_ref()
    }

    /// Where the surface is evaluated.
    pub fn technique(&self) -> &'static dyn Technique {
        self.drawing.technique()
    }

    /// Evaluates the surface elsewhere from now on.
    pub fn set_technique(&mut self, technique: &'static dyn Technique) {
        self.drawing = self.drawing.clone().with_technique(technique);
        self.changed();
    }

    /// Shows the model in another way.
    pub fn set_look(&mut self, look: LookArgs) {
        self.look = look;
        self.changed();
    }

    /// Shows so many pixels.
    pub fn resize(&mut self, viewport: Viewport) {
        if viewport != self.viewport {
            self.viewport = viewport;
            self.changed();
        }
    }

    /// Turns the model along with the mouse, which moved by so many pixels to the right and down.
    ///
    /// # Errors
    /// Where the numbers make no camera; so for all that follow.
    pub fn turn(&mut self, by_px: DVec2) -> Result<()> {
        let angle = by_px / self.viewport.height() as f64 * HALF_TURN_RAD;
        self.look_from(orbit::turned(&self.camera, self.axis, -angle.x, angle.y)?);
        Ok(())
    }

    /// Moves the picture along with the mouse.
    ///
    /// # Errors
    /// As [`Self::turn`].
    pub fn pan(&mut self, by_px: DVec2) -> Result<()> {
        self.look_from(orbit::panned(&self.camera, self.viewport, by_px)?);
        Ok(())
    }

    /// Brings what is at a pixel nearer by so many steps of the wheel, or takes it away.
    ///
    /// # Errors
    /// As [`Self::turn`].
    pub fn zoom(&mut self, at: DVec2, steps: f64) -> Result<()> {
        self.look_from(orbit::nearer(&self.camera, self.viewport, at, STEP.powf(steps))?);
        Ok(())
    }

    /// Frames the model from where it is seen unless told, or from a side: `direction` is that to the eye.
    ///
    /// # Errors
    /// As [`Self::turn`].
    pub fn frame(&mut self, direction: Option<DVec3>) -> Result<()> {
        let model = &self.document.model;
        let framed = match direction {
            Some(direction) => Camera::framing_from(model, self.viewport, direction)?,
            None => Camera::framing(model, self.viewport),
        };
        let is_parallel = matches!(self.camera.projection(), Projection::Orthographic { .. });
        self.look_from(if is_parallel { orbit::projected(&framed, FOV_DEG)? } else { framed });
        Ok(())
    }

    /// Changes from perspective to a parallel projection, or back.
    ///
    /// # Errors
    /// As [`Self::turn`].
    pub fn change_projection(&mut self) -> Result<()> {
        self.look_from(orbit::projected(&self.camera, FOV_DEG)?);
        Ok(())
    }

    /// Moves the light to where it would make a ball brightest at a pixel. What has no light keeps none.
    pub fn light(&mut self, at: DVec2) {
        if self.look.is_lit() {
            self.look = self.look.clone().with_light(light::toward(self.viewport, at));
            self.changed();
        }
    }

    /// Takes hold of the control point at a pixel, of the face that was picked, or of that which is seen there. Says whether there is
    /// one.
    ///
    /// # Errors
    /// As [`Self::pick`].
    pub fn grab(&mut self, at: DVec2) -> Result<bool> {
        if self.selected.is_none() {
            self.pick([at.x.max(0.0) as usize, at.y.max(0.0) as usize])?;
        }
        let within = |face: &FaceId| {
            let surface = self.document.model.surface(*face);
            control::nearest(surface, &self.camera, self.viewport, at, REACH_PX).map(|index| (*face, index))
        };
        self.grabbed = self.selected.as_ref().and_then(within);
        Ok(self.grabbed.is_some())
    }

    /// Moves the control point that was taken hold of along with the mouse.
    ///
    /// # Errors
    /// Where it cannot be there, or the adapter refuses.
    pub fn pull(&mut self, by_px: DVec2) -> Result<()> {
        let Some((face, index)) = self.grabbed else { return Ok(()) };
        let model = &self.document.model;
        let surface = control::pulled(model.surface(face), index, &self.camera, self.viewport, by_px)?;
        let (of_face, faces) = (model.faces()[face.0 as usize].surface, model.faces());
        let is_shared = faces.iter().filter(|other| other.surface == of_face).count() > 1;
        self.document.model = model.with_surface(of_face, surface);
        (self.is_edited, self.at_rest) = (true, None);
        self.shown = Shown::Behind;
        if is_shared {
            // An edit is followed for one face.
            self.drawer.forget();
            return Ok(());
        }
        let scene = scene(&self.document.model, self.camera, self.viewport, &self.drawing);
        self.drawer.edited(scene, face)
    }

    /// Lets go of the control point; what was read is read anew.
    ///
    /// # Errors
    /// As [`Self::pick`].
    pub fn release(&mut self) -> Result<()> {
        match (self.grabbed.take(), &self.reading) {
            (Some(_), Some(reading)) => self.pick(reading.at),
            _ => Ok(()),
        }
    }

    /// The face of the pixel that was picked last, whose control points can be moved.
    pub fn selected(&self) -> Option<FaceId> {
        self.selected
    }

    /// Reads a pixel, and has it judged by a ray that is cast there: [`Self::draw`] takes the verdict when it has come. Outside of
    /// the picture nothing is read.
    ///
    /// # Errors
    /// Where the picture cannot be drawn.
    pub fn pick(&mut self, at: [usize; 2]) -> Result<()> {
        self.reading = None;
        self.judging.forget();
        if at[0] >= self.viewport.width() || at[1] >= self.viewport.height() {
            return Ok(());
        }
        self.draw_in_full()?;
        let Some(buffer) = &self.at_rest else { return Ok(()) };
        let model = &self.document.model;
        let stage = self.drawer.stage(scene(model, self.camera, self.viewport, &self.drawing));
        let told = match stage.filter(|_| self.drawer.with() != With::Raycast) {
            None => Told::RayItself,
            Some(Stage { camera, viewport, plan, scene, prepared, .. }) => {
                let (model, buffer) = (model.clone(), buffer.clone());
                self.judging.ask(Question { model, camera, viewport, plan, scene, prepared, buffer, at });
                Told::Awaited
            }
        };
        let hit = buffer.get(at[0], at[1]).copied();
        let named = |face: FaceId| self.document.attributes.get(face.0 as usize)?.name.clone();
        self.selected = hit.map(|hit| hit.face);
        self.reading = Some(Reading { at, hit, name: hit.and_then(|hit| named(hit.face)), told });
        Ok(())
    }

    /// Takes a verdict that has come; says when to look again where one is to come.
    fn listen(&mut self) -> Option<Duration> {
        if let (Some(answer), Some(reading)) = (self.judging.answered(), &mut self.reading) {
            reading.told = answer.map_or_else(Told::Failed, Told::Verdict);
        }
        self.judging.is_awaited().then_some(LISTEN)
    }

    /// Draws what is to be drawn at this time, and says when there will be more; `None` where the picture is at rest, and no verdict
    /// is awaited.
    ///
    /// # Errors
    /// Where it cannot be drawn.
    pub fn draw(&mut self, now: Instant) -> Result<Option<Duration>> {
        let verdict = self.listen();
        match self.shown {
            Shown::AtRest => return Ok(verdict),
            Shown::Moving(since) if now.duration_since(since) < REST => {
                return Ok(Some(REST - now.duration_since(since)));
            }
            Shown::Behind => {
                self.draw_in_haste()?;
                self.shown = Shown::Moving(Instant::now());
                return Ok(Some(REST));
            }
            Shown::Moving(_) | Shown::Awaited => self.draw_in_full()?,
        }
        Ok(verdict)
    }

    /// Writes the picture at rest, the command that draws it again (X.sh), and the model where it was edited (X.json). Files that are
    /// there stay.
    ///
    /// # Errors
    /// Where they cannot be drawn or written.
    pub fn save(&mut self) -> Result<Saved> {
        self.draw_in_full()?;
        let picture = free(&self.out);
        let (Some(buffer), Some(painter), Some(shown)) = (&self.at_rest, &self.painter, &self.picture) else {
            anyhow::bail!("there is no picture yet");
        };
        let seen: Vec<u32> = buffer.pixels().map(|hit| u32::from(hit.is_some())).collect();
        output::write(&picture, &painter.png(shown, &seen, 1)?)?;
        let model = self.is_edited.then(|| picture.with_extension("json"));
        if let Some(path) = &model {
            let asked = Asked { error: 1.0, progress: &|_| {} };
            export(path, &self.document, asked).with_context(|| path.display().to_string())?;
        }
        let command = self.command(model.as_deref(), &picture)?;
        let script = format!("#!/bin/sh\n{}\n", words::line(command.clone()));
        output::write(&picture.with_extension("sh"), script.as_bytes())?;
        Ok(Saved { picture, model, command })
    }

    /// The command that writes the picture at rest to `out`, of the model in a file, or of the one that was opened.
    ///
    /// # Errors
    /// Where the defaults cannot be read; they always can.
    pub fn command(&self, model: Option<&Path>, out: &Path) -> Result<Vec<String>> {
        #[derive(Parser)]
        struct Alone {
            #[command(flatten)]
            args: ViewerArgs,
        }
        let usual = Alone::try_parse_from(["view"])?.args;
        let usual: Vec<Words> = usual.drawing.words().into_iter().chain(usual.look.words()).collect();
        let name = model.map_or(self.model.model.clone(), |path| path.display().to_string());
        let model = ModelArgs { model: name, ..self.model.clone() };
        let own = self.look.words().into_iter().chain(self.drawing.words()).filter(|words| !usual.contains(words));
        let start = [vec!["isophote".to_owned(), "render".to_owned()]].into_iter().chain(model.words());
        let options = own.chain(ViewArgs::of(&self.camera, self.viewport).words());
        let end = [words::named("--with", &self.drawer.with()), words::option("--out", out.display())];
        Ok(start.chain(options).chain(end).flatten().collect())
    }

    /// How the picture was painted that was last made of a G-buffer: while something moves, its legend may be of before.
    pub fn painter(&self) -> Option<&Painter> {
        self.painter.as_ref()
    }

    /// The picture is not what is to be shown any more, and what was read of it is elsewhere now.
    fn changed(&mut self) {
        (self.shown, self.at_rest, self.reading) = (Shown::Behind, None, None);
        self.judging.forget();
    }

    fn look_from(&mut self, camera: Camera) {
        if camera != self.camera {
            (self.camera, self.grabbed) = (camera, None);
            self.changed();
        }
    }

    fn length(&self) -> String {
        self.document.unit.as_ref().map_or("unit".to_owned(), |unit| unit.name.clone())
    }

    fn draw_in_full(&mut self) -> Result<()> {
        if self.shown == Shown::AtRest {
            return Ok(());
        }
        let start = Instant::now();
        let buffer =
            self.drawer.gbuffer(scene(&self.document.model, self.camera, self.viewport, &self.drawing), false)?;
        let painter = self.look.painter(&buffer, &self.length(), &self.opened);
        self.picture = Some(painter.painted(&buffer, &self.document.model, &self.camera)?);
        (self.at_rest, self.painter, self.shown) = (Some(Arc::new(buffer)), Some(painter), Shown::AtRest);
        (self.took, self.frames) = (start.elapsed(), self.frames + 1);
        Ok(())
    }

    fn draw_in_haste(&mut self) -> Result<()> {
        let start = Instant::now();
        let side = |pixels: usize| pixels.div_ceil(self.coarseness);
        let viewport = Viewport::new(side(self.viewport.width()), side(self.viewport.height()))?;
        let scene = scene(&self.document.model, self.camera, viewport, &self.drawing);
        let shaded = match self.look.shaded() {
            Some(shading) => self.drawer.shaded(scene, &shading)?,
            None => None,
        };
        self.picture = Some(match shaded {
            Some(picture) => picture,
            None => {
                let buffer = self.drawer.gbuffer(scene, true)?;
                let painter = self.painter.insert(self.look.painter(&buffer, &self.length(), &self.opened));
                painter.painted(&buffer, &self.document.model, &self.camera)?
            }
        });
        (self.took, self.frames) = (start.elapsed(), self.frames + 1);
        self.coarseness = match self.took {
            took if took > SLOW => (2 * self.coarseness).min(COARSEST),
            took if took < SLOW / 4 => (self.coarseness / 2).max(1),
            _ => self.coarseness,
        };
        Ok(())
    }
}

/// The scene of a session, at so many pixels.
fn scene<'m>(model: &'m Model, camera: Camera, viewport: Viewport, drawing: &DrawingArgs) -> Scene<'m> {
    Scene { model, camera, viewport, plan: drawing.plan() }
}

/// The path itself, or the first of X-1.png, X-2.png … that is free.
fn free(path: &Path) -> PathBuf {
    let numbered = |k: usize| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        path.with_file_name(format!("{stem}-{k}.png"))
    };
    let mut candidates = std::iter::once(path.to_owned()).chain((1..).map(numbered));
    candidates.find(|candidate| !candidate.exists()).expect("the numbers do not end")
}
