//! What a picture shows, as the controls of a window.

use super::pattern::Pattern;
use super::{Behind, DEFAULT_STRIPES, Look, LookArgs, Range, vector_of};
use crate::words::value_name;
use ::view::egui::{ComboBox, DragValue, Slider, Ui};
use clap::ValueEnum;
use glam::DVec3;

/// Bands of isophotes that a slider offers, degrees: any others can be typed.
const BANDS_DEG: [f64; 2] = [0.5, 30.0];

/// Width of a band unless told, degrees.
const DEFAULT_BANDS_DEG: f64 = 5.0;

/// Stripes that a slider offers.
const STRIPES: [u32; 2] = [2, 64];

/// The light of shading, and that of lamps, unless told: right, up, to the viewer.
const DEFAULT_LIGHT: [f64; 3] = [-0.5, 0.6, 1.0];
const DEFAULT_LAMPS: [f64; 3] = [0.0, 1.0, 1.0];

impl LookArgs {
    /// Shows the controls, with what they do now. Says whether one was changed. `found` is the range of what was last shown.
    pub fn panel(&mut self, ui: &mut Ui, found: Option<[f64; 2]>) -> bool {
        let before = self.words();
        let mut shade = self.shade;
        ComboBox::from_label("shading").selected_text(value_name(&shade)).show_ui(ui, |ui| {
            // What is measured to another version is drawn by `render`.
            for look in Look::value_variants().iter().filter(|look| **look != Look::Deviation) {
                ui.selectable_value(&mut shade, *look, value_name(look));
            }
        });
        if shade != self.shade {
            *self = self.clone().showing(shade);
        }
        if self.goes(&[Look::Isophotes]) {
            let mut bands = self.bands.unwrap_or(DEFAULT_BANDS_DEG);
            let slider = Slider::new(&mut bands, BANDS_DEG[0]..=BANDS_DEG[1]).suffix("°").text("bands");
            if ui.add(slider).changed() {
                self.bands = Some(bands);
            }
        }
        if self.is_striped() {
            let mut stripes = self.stripes.unwrap_or(DEFAULT_STRIPES);
            if ui.add(Slider::new(&mut stripes, STRIPES[0]..=STRIPES[1]).text("stripes")).changed() {
                self.stripes = Some(stripes);
            }
            let mut turn = self.stripe_direction.unwrap_or(0.0);
            if ui.add(Slider::new(&mut turn, -90.0..=90.0).suffix("°").text("turned")).changed() {
                self.stripe_direction = Some(turn);
            }
        }
        if self.goes(&[Look::Zebra]) {
            let mut pattern = self.pattern.unwrap_or(Pattern::Stripes);
            ComboBox::from_label("pattern").selected_text(value_name(&pattern)).show_ui(ui, |ui| {
                for own in Pattern::value_variants() {
                    ui.selectable_value(&mut pattern, *own, value_name(own));
                }
            });
            self.pattern = Some(pattern).filter(|pattern| *pattern != Pattern::Stripes);
        }
        if self.is_lit() {
            let usual = if self.shade == Look::Highlight { DEFAULT_LAMPS } else { DEFAULT_LIGHT };
            direction(ui, "light", &mut self.light, usual);
        }
        if self.goes(&[Look::Draft]) {
            direction(ui, "pull", &mut self.pull, [0.0, 0.0, 1.0]);
        }
        if self.quantity().is_some() {
            self.range_panel(ui, found);
        }
        if self.quantity().is_some() || self.goes(&[Look::Isophotes]) {
            ui.checkbox(&mut self.legend, "legend");
        }
        self.background_panel(ui);
        before != self.words()
    }

    fn range_panel(&mut self, ui: &mut Ui, found: Option<[f64; 2]>) {
        ui.horizontal(|ui| {
            let mut is_auto = !matches!(self.range, Some(Range::Given(_)));
            let [mut low, mut high] = match self.range {
                Some(Range::Given(range)) => range,
                _ => found.unwrap_or([0.0, 1.0]),
            };
            let step = 0.01 * (high - low);
            let toggled = ui.checkbox(&mut is_auto, "range auto").changed();
            let typed = ui.add_enabled(!is_auto, DragValue::new(&mut low).speed(step)).changed()
                | ui.add_enabled(!is_auto, DragValue::new(&mut high).speed(step)).changed();
            if is_auto && toggled {
                self.range = None;
            } else if !is_auto && (toggled || typed) && low < high {
                self.range = Some(Range::Given([low, high]));
            }
        });
    }

    fn background_panel(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let choices = [
                ("usual", None),
                ("white", Some(Behind::Colour([255; 3]))),
                ("black", Some(Behind::Colour([0; 3]))),
                ("none", Some(Behind::Nothing)),
            ];
            ui.label("ground");
            for (name, behind) in choices {
                ui.selectable_value(&mut self.background, behind, name);
            }
        });
    }
}

/// The three numbers of a direction, as they were given or as they are unless told.
fn direction(ui: &mut Ui, name: &str, given: &mut Option<Vec<f64>>, usual: [f64; 3]) {
    ui.horizontal(|ui| {
        ui.label(name);
        let mut numbers = given.as_deref().map_or(DVec3::from_array(usual), vector_of).to_array();
        let changed = numbers
            .iter_mut()
            .fold(false, |changed, x| changed | ui.add(DragValue::new(x).speed(0.01).max_decimals(3)).changed());
        // A direction without a length is none.
        if changed && DVec3::from_array(numbers).try_normalize().is_some() {
            *given = Some(numbers.to_vec());
        }
        if given.is_some() && ui.small_button("reset").clicked() {
            *given = None;
        }
    });
}
