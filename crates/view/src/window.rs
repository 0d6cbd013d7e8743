//! The window itself: events in, pixels out, and asleep while nothing moves.

use crate::error::ViewError;
use crate::input::Input;
use crate::screen::Screen;
use egui::Context;
use std::num::NonZeroU32;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::rc::Rc;
use std::time::Instant;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::{Window, WindowId};

/// What winit's X11 client loads when a window is opened.
const KEYBOARD_LIBRARY: &str = "libxkbcommon-x11-0";

/// A display that windows can be opened on.
pub struct Display {
    events: EventLoop<()>,
}

impl Display {
    /// The display of this session: on Linux that of X11, which Wayland's desktops have, too.
    ///
    /// # Errors
    /// [`ViewError::NoDisplay`].
    pub fn open() -> Result<Self, ViewError> {
        if cfg!(target_os = "linux") && std::env::var_os("DISPLAY").is_none_or(|name| name.is_empty()) {
            return Err(ViewError::NoDisplay { reason: "DISPLAY is not set".to_owned() });
        }
        // winit panics where a library or an extension of the server is missing. Nobody else's panic is silenced: there is no
        // other thread yet that could have one.
        let hook = take_hook();
        set_hook(Box::new(|_| {}));
        let opened = catch_unwind(AssertUnwindSafe(EventLoop::new));
        set_hook(hook);
        let reason = match opened {
            Ok(Ok(events)) => return Ok(Self { events }),
            // What winit says before the last colon is where in its source it was said.
            Ok(Err(error)) => error.to_string().rsplit(": ").next().unwrap_or_default().to_owned(),
            Err(panic) => {
                let said = panic.downcast_ref::<String>().cloned();
                let said = said.or_else(|| panic.downcast_ref::<&str>().map(|said| (*said).to_owned()));
                let hint = if cfg!(target_os = "linux") { KEYBOARD_LIBRARY } else { "" };
                format!("{} {hint}", said.unwrap_or_default()).trim().to_owned()
            }
        };
        Err(ViewError::NoDisplay { reason })
    }

    /// Opens a window of `size` pixels and a strip beside them of `beside` points, shows frames of `content` in it, and returns when it
    /// is closed. Between frames it sleeps: until something happens, or until egui is asked for another one
    /// ([`Context::request_repaint_after`]).
    ///
    /// # Errors
    /// [`ViewError::Refused`].
    pub fn show(
        self,
        title: &str,
        size: [usize; 2],
        beside: f32,
        content: &mut dyn FnMut(&Context),
    ) -> Result<(), ViewError> {
        let mut program = Program {
            title,
            size,
            beside,
            content,
            screen: Screen::default(),
            input: Input::default(),
            open: None,
            failure: None,
        };
        self.events.run_app(&mut program).map_err(|error| refused("events", error))?;
        program.failure.map_or(Ok(()), Err)
    }
}

fn refused(what: &'static str, error: impl std::fmt::Display) -> ViewError {
    ViewError::Refused { what, reason: error.to_string() }
}

/// A window that is open.
struct Open {
    window: Rc<Window>,
    surface: softbuffer::Surface<Rc<Window>, Rc<Window>>,
}

impl Open {
    fn new(events: &ActiveEventLoop, title: &str, [width, height]: [usize; 2], beside: f32) -> Result<Self, ViewError> {
        let size =
            |scale: f64| PhysicalSize::new(width as u32 + (f64::from(beside) * scale).round() as u32, height as u32);
        let attributes = Window::default_attributes().with_title(title).with_inner_size(size(1.0));
        let window = events.create_window(attributes).map_err(|error| refused("a window", error))?;
        // Only a window knows how many pixels a point of it has.
        if window.scale_factor() != 1.0 {
            let _ = window.request_inner_size(size(window.scale_factor()));
        }
        let window = Rc::new(window);
        let context = softbuffer::Context::new(window.clone()).map_err(|error| refused("pixels", error))?;
        let surface = softbuffer::Surface::new(&context, window.clone()).map_err(|error| refused("pixels", error))?;
        window.request_redraw();
        Ok(Self { window, surface })
    }
}

/// A window, and what is shown in it.
struct Program<'c> {
    title: &'c str,
    size: [usize; 2],
    beside: f32,
    content: &'c mut dyn FnMut(&Context),
    screen: Screen,
    input: Input,
    open: Option<Open>,
    failure: Option<ViewError>,
}

impl Program<'_> {
    /// Shows a frame, and says how long to sleep.
    fn frame(&mut self, events: &ActiveEventLoop) -> Result<(), ViewError> {
        let Some(Open { window, surface }) = &mut self.open else { return Ok(()) };
        let PhysicalSize { width, height } = window.inner_size();
        // A window that is minimised shows nothing.
        let (Some(columns), Some(rows)) = (NonZeroU32::new(width), NonZeroU32::new(height)) else { return Ok(()) };
        let size = [width as usize, height as usize];
        let shown = self.screen.frame(self.input.take(), size, window.scale_factor() as f32, self.content);
        surface.resize(columns, rows).map_err(|error| refused("its size", error))?;
        let mut buffer = surface.buffer_mut().map_err(|error| refused("pixels", error))?;
        buffer.copy_from_slice(self.screen.canvas().pixels());
        buffer.present().map_err(|error| refused("a frame", error))?;
        if shown.is_over {
            events.exit();
        }
        events.set_control_flow(match shown.again.and_then(|delay| Instant::now().checked_add(delay)) {
            Some(time) => ControlFlow::WaitUntil(time),
            None => ControlFlow::Wait,
        });
        Ok(())
    }

    fn fail(&mut self, events: &ActiveEventLoop, failure: ViewError) {
        self.failure.get_or_insert(failure);
        events.exit();
    }
}

impl ApplicationHandler for Program<'_> {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        match Open::new(events, self.title, self.size, self.beside) {
            Ok(open) => self.open = Some(open),
            Err(failure) => self.fail(events, failure),
        }
    }

    fn new_events(&mut self, events: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(open)) = (cause, &self.open) {
            events.set_control_flow(ControlFlow::Wait);
            open.window.request_redraw();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::RedrawRequested => {
                if let Err(failure) = self.frame(events) {
                    self.fail(events, failure);
                }
            }
            event => {
                let Some(open) = &self.open else { return };
                if self.input.note(&event, open.window.scale_factor() as f32) {
                    open.window.request_redraw();
                }
            }
        }
    }
}
