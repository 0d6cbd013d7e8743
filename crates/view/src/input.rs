//! What happens to a window, in egui's words.

use egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, RawInput, Vec2};
use std::time::Instant;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent};
use winit::keyboard;

/// What has happened since the last frame.
pub(crate) struct Input {
    start: Instant,
    events: Vec<Event>,
    modifiers: Modifiers,
    pointer: Pos2,
}

impl Default for Input {
    fn default() -> Self {
        Self { start: Instant::now(), events: vec![], modifiers: Modifiers::default(), pointer: Pos2::ZERO }
    }
}

impl Input {
    /// Notes an event; says whether there may be something new to show.
    pub fn note(&mut self, event: &WindowEvent, pixels_per_point: f32) -> bool {
        let modifiers = self.modifiers;
        match event {
            WindowEvent::CursorMoved { position, .. } => {
                self.pointer = Pos2::new(position.x as f32, position.y as f32) / pixels_per_point;
                self.events.push(Event::PointerMoved(self.pointer));
            }
            WindowEvent::CursorLeft { .. } => self.events.push(Event::PointerGone),
            WindowEvent::MouseInput { state, button, .. } => {
                let Some(button) = pointer_button(*button) else { return false };
                let pressed = *state == ElementState::Pressed;
                self.events.push(Event::PointerButton { pos: self.pointer, button, pressed, modifiers });
            }
            WindowEvent::MouseWheel { delta, .. } => {
                let (unit, delta) = match delta {
                    MouseScrollDelta::LineDelta(x, y) => (MouseWheelUnit::Line, Vec2::new(*x, *y)),
                    MouseScrollDelta::PixelDelta(by) => {
                        (MouseWheelUnit::Point, Vec2::new(by.x as f32, by.y as f32) / pixels_per_point)
                    }
                };
                self.events.push(Event::MouseWheel { unit, delta, modifiers });
            }
            WindowEvent::ModifiersChanged(changed) => {
                let state = changed.state();
                self.modifiers = Modifiers {
                    alt: state.alt_key(),
                    ctrl: state.control_key(),
                    shift: state.shift_key(),
                    mac_cmd: cfg!(target_os = "macos") && state.super_key(),
                    command: if cfg!(target_os = "macos") { state.super_key() } else { state.control_key() },
                };
            }
            WindowEvent::KeyboardInput { event, .. } => self.key(event),
            WindowEvent::Focused(focused) => self.events.push(Event::WindowFocused(*focused)),
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => {}
            _ => return false,
        }
        true
    }

    /// All since the last call.
    pub fn take(&mut self) -> RawInput {
        RawInput {
            time: Some(self.start.elapsed().as_secs_f64()),
            modifiers: self.modifiers,
            events: std::mem::take(&mut self.events),
            ..Default::default()
        }
    }

    fn key(&mut self, event: &KeyEvent) {
        let pressed = event.state == ElementState::Pressed;
        let name = match &event.logical_key {
            keyboard::Key::Named(named) => format!("{named:?}"),
            keyboard::Key::Character(text) => text.to_uppercase(),
            _ => String::new(),
        };
        if let Some(key) = Key::from_name(&name) {
            let modifiers = self.modifiers;
            self.events.push(Event::Key { key, physical_key: None, pressed, repeat: event.repeat, modifiers });
        }
        let typed = event.text.as_ref().filter(|text| pressed && !text.chars().any(char::is_control));
        if let Some(text) = typed.filter(|_| !self.modifiers.ctrl && !self.modifiers.command) {
            self.events.push(Event::Text(text.to_string()));
        }
    }
}

fn pointer_button(button: MouseButton) -> Option<PointerButton> {
    match button {
        MouseButton::Left => Some(PointerButton::Primary),
        MouseButton::Right => Some(PointerButton::Secondary),
        MouseButton::Middle => Some(PointerButton::Middle),
        _ => None,
    }
}
