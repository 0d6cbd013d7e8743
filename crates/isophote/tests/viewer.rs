//! `view`: what is done in a window, with a display and without, and the command that does the same.

#[path = "viewer/display.rs"]
mod display;
#[path = "viewer/options.rs"]
mod options;

use clap::Parser;
use gbuffer::{GBuffer, Picture};
use glam::DVec2;
use isophote::stage::{Plan, Stage};
use isophote::viewer::{PANEL_WIDTH, Session, Told, ViewerArgs, Window};
use raycast::Caster;
use scene::{Camera, Viewport};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};
use view::Screen;
use view::egui::{Event, Key, Modifiers, PointerButton, Pos2, RawInput};

#[derive(Parser)]
struct Asked {
    #[command(flatten)]
    args: ViewerArgs,
}

fn asked(line: &str) -> ViewerArgs {
    Asked::try_parse_from(std::iter::once("view").chain(line.split_whitespace())).expect("a command line").args
}

/// A folder that cargo gives to tests, empty.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("viewer").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// What the saved command writes, run by the program in the folder where it was saved.
fn drawn_again(folder: &Path, picture: &str) -> Vec<u8> {
    let saved = folder.join(picture);
    let script = std::fs::read_to_string(saved.with_extension("sh")).expect("a script");
    let script =
        script.replace(&format!("--out {}", saved.display()), &format!("--out {}/again.png", folder.display()));
    let programs = Path::new(env!("CARGO_BIN_EXE_isophote")).parent().expect("a folder of programs");
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").expect("a path"));
    let output = Command::new("sh").args(["-euc", &script]).env("PATH", path).output().expect("a shell");
    assert!(output.status.success(), "{script}\n{}", String::from_utf8_lossy(&output.stderr));
    std::fs::read(folder.join("again.png")).expect("the same picture again")
}

/// Draws until nothing moves any more.
fn rested(session: &mut Session) {
    let mut now = Instant::now();
    while let Some(delay) = session.draw(now).expect("a picture") {
        now = Instant::now() + delay;
    }
}

#[test]
fn a_picture_at_rest_is_the_one_that_its_command_draws() {
    let device = gpu::Device::open(None).expect("an adapter, if of software");
    let cases = [
        ("gpu", "teapot --size 96x72 --shade zebra --stripes 9", false),
        ("gpu-exact", "teapot --size 96x72 --technique exact --shade mean --legend --background white", true),
        ("gpu-masks", "plate --size 96x72 --trim texture --path compute --ortho 3 --background transparent", false),
        ("raster", "plate --size 96x72 --with raster --near 0.5 --lens-shift 0.05 0.1", true),
        ("raycast", "teapot --size 96x72 --with raycast --shade highlight --view top", false),
    ];
    for (name, line, is_edited) in cases {
        let folder = folder(name);
        let args = asked(&format!("{line} --out {}/x.png", folder.display()));
        let mut session = Session::new(&args, Some(&device).filter(|_| name.starts_with("gpu"))).expect("a session");
        rested(&mut session);
        session.turn(DVec2::new(9.0, -4.0)).expect("a camera");
        session.draw(Instant::now()).expect("a picture in haste");
        session.pan(DVec2::new(-3.0, 2.0)).expect("a camera");
        session.zoom(DVec2::new(50.0, 30.0), 1.5).expect("a camera");
        session.light(DVec2::new(30.0, 20.0));
        if is_edited {
            let seen = |session: &Session| {
                let point = session.model().surface(session.selected().expect("a face")).points()[5];
                session.camera().project(session.viewport(), point).expect("in front").0
            };
            session.pick([48, 36]).expect("a reading");
            assert!(session.grab(seen(&session)).expect("a picture"), "{name}: there is a control point");
            session.pull(DVec2::new(4.0, -6.0)).expect("an edit");
            session.draw(Instant::now()).expect("a picture in haste");
            session.pull(DVec2::new(1.0, 1.0)).expect("an edit");
            session.release().expect("a reading");
        }
        let saved = session.save().expect("files");
        assert_eq!(saved.model.is_some(), is_edited);
        let bytes = std::fs::read(&saved.picture).expect("a picture");
        assert!(bytes == drawn_again(&folder, "x.png"), "{name}: {:?}", saved.command);
        // What is there stays.
        assert_eq!(session.save().expect("files").picture, folder.join("x-1.png"));
    }
}

#[test]
fn nothing_is_drawn_while_nothing_moves() {
    let mut session = Session::new(&asked("teapot --size 64x48 --with raster"), None).expect("a session");
    assert_eq!(session.draw(Instant::now()).expect("a picture"), None);
    for _ in 0..3 {
        assert_eq!(session.draw(Instant::now()).expect("a picture"), None);
    }
    assert_eq!(session.frames(), 1);
    session.turn(DVec2::new(5.0, 0.0)).expect("a camera");
    let delay = session.draw(Instant::now()).expect("a picture").expect("it is drawn in full later");
    assert_eq!(session.frames(), 2);
    // Too soon, then in time.
    assert!(session.draw(Instant::now()).expect("a picture").is_some() && session.frames() == 2);
    assert_eq!(session.draw(Instant::now() + delay).expect("a picture"), None);
    assert_eq!(session.frames(), 3);
    // A way of nought is none.
    session.pan(DVec2::ZERO).expect("a camera");
    assert_eq!((session.draw(Instant::now()).expect("a picture"), session.frames()), (None, 3));
}

#[test]
fn a_pulled_point_moves_the_surface_and_what_is_read_of_it() {
    let mut session = Session::new(&asked("teapot --size 128x96 --with raster"), None).expect("a session");
    session.pick([50, 50]).expect("a reading");
    assert_eq!(session.reading().map(|reading| &reading.told), Some(&Told::Awaited), "the window goes on");
    rested(&mut session);
    let before = session.reading().expect("a reading").clone();
    let face = session.selected().expect("a face");
    let agrees = |told: &Told| matches!(told, Told::Verdict(verdict) if verdict.cause.is_none());
    assert!(agrees(&before.told), "{before:?}");
    let points = session.model().surface(face).points().to_vec();
    let seen = |point| session.camera().project(session.viewport(), point).expect("in front").0;
    let at = seen(points[5]);
    assert!(session.grab(at).expect("a picture"));
    session.pull(DVec2::new(12.0, 3.0)).expect("an edit");
    session.release().expect("a reading");
    rested(&mut session);
    let after = session.model().surface(face).points();
    assert!(session.is_edited() && after.iter().zip(&points).filter(|(a, b)| a != b).count() == 1);
    let reading = session.reading().expect("it is read anew");
    assert!(reading.hit != before.hit && agrees(&reading.told), "{reading:?}");
    // Where there is none, none is taken, and a pull moves nothing.
    let points = after.to_vec();
    assert!(!session.grab(DVec2::new(1.0, 1.0)).expect("a picture"));
    session.pull(DVec2::new(12.0, 3.0)).expect("nothing");
    assert_eq!(session.model().surface(face).points(), points);
}

#[test]
fn one_ray_says_of_a_pixel_what_all_of_them_do() {
    let model = models::builtin("teapot").expect("built in");
    let viewport = Viewport::new(48, 36).expect("a size");
    let stage = Stage::new(&model, Camera::framing(&model, viewport), viewport, Plan::default()).expect("a stage");
    let (caster, right) = (Caster::new(&model), stage.raster());
    let at = [20, 18];
    assert!(right.get(20, 18).is_some());
    let verdict = stage.against_ray(&caster, &right, at).expect("of this stage");
    assert_eq!((verdict.cause, verdict.unbounded), (None, None), "{}", verdict.detail);
    // The same picture two pixels to the left is another one.
    let row = |y| (0..48).map(|x| right.get((x + 2).min(47), y).copied()).collect();
    let wrong = GBuffer::from_rows(viewport, right.meta().clone(), (0..36).map(row));
    let verdict = stage.against_ray(&caster, &wrong, at).expect("of this stage");
    assert!(verdict.cause.is_some(), "{}", verdict.detail);
}

/// A window without a display, and the mouse in it.
struct Desk<'d> {
    screen: Screen,
    window: Window<'d>,
    size: [usize; 2],
    time: f64,
}

impl Desk<'_> {
    fn new(args: &ViewerArgs) -> Self {
        let session = Session::new(args, None).expect("a session");
        let size = [session.viewport().width() + PANEL_WIDTH as usize, session.viewport().height()];
        Self { screen: Screen::default(), window: Window::new(session), size, time: 0.0 }
    }

    fn frame(&mut self, events: Vec<Event>) -> view::Shown {
        self.time += 0.05;
        let modifiers = Modifiers::default();
        let input = RawInput { time: Some(self.time), modifiers, events, ..Default::default() };
        self.screen.frame(input, self.size, 1.0, &mut |context| self.window.show(context))
    }

    fn button(&mut self, at: Pos2, pressed: bool) {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::default());
        self.frame(vec![Event::PointerMoved(at), Event::PointerButton { pos: at, button, pressed, modifiers }]);
    }

    fn key(&mut self, key: Key) -> view::Shown {
        let press =
            |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::default() };
        self.frame(vec![press(true), press(false)])
    }

    /// Frames until there is nothing new to show.
    fn rest(&mut self) {
        let started = Instant::now();
        while let Some(delay) = self.frame(vec![]).again {
            assert!(started.elapsed() < Duration::from_secs(60), "it never rests");
            std::thread::sleep(delay.min(Duration::from_millis(200)));
        }
    }

    /// The part of the window that shows the picture.
    fn seen(&self) -> Picture {
        let (whole, viewport) = (self.screen.canvas().picture().expect("pixels"), self.window.session().viewport());
        let rows = (0..viewport.height()).flat_map(|y| (0..viewport.width()).map(move |x| (x, y)));
        let rgb = rows.map(|(x, y)| whole.pixel(x, y)).collect();
        Picture::new(viewport.width(), viewport.height(), rgb).expect("a picture")
    }
}

#[test]
fn a_window_without_a_display_is_turned_read_and_saved() {
    let folder = folder("desk");
    let mut desk = Desk::new(&asked(&format!("teapot --size 320x400 --with raster --out {}/x.png", folder.display())));
    desk.rest();
    let viewport = desk.window.session().viewport();
    assert_eq!([viewport.width(), viewport.height()], [320, 400], "the window opens at the size that is asked for");
    assert_eq!(Some(&desk.seen()), desk.window.session().picture(), "each pixel is the picture's");
    let before = *desk.window.session().camera();
    desk.button(Pos2::new(150.0, 200.0), true);
    desk.frame(vec![Event::PointerMoved(Pos2::new(190.0, 190.0))]);
    desk.button(Pos2::new(190.0, 190.0), false);
    desk.rest();
    let turned = *desk.window.session().camera();
    assert!(turned != before && (turned.eye() - turned.target()).length() > 0.0 && turned.target() == before.target());
    desk.button(Pos2::new(150.0, 200.0), true);
    desk.button(Pos2::new(150.0, 200.0), false);
    assert_eq!(desk.window.session().reading().map(|reading| reading.at), Some([150, 200]));
    desk.rest();
    let told = desk.window.session().reading().map(|reading| &reading.told);
    assert!(matches!(told, Some(Told::Verdict(_))), "it has come without the mouse: {told:?}");
    let frames = desk.window.session().frames();
    assert_eq!(desk.frame(vec![]).again, None);
    assert_eq!(desk.window.session().frames(), frames);
    desk.key(Key::S);
    assert!(std::fs::read(folder.join("x.png")).is_ok_and(|bytes| bytes == drawn_again(&folder, "x.png")));
    assert!(desk.key(Key::Q).is_over);
}
