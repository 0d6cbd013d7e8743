//! The letters of a window: one typeface for words and one for numbers, and none of the pictographs that egui brings along.

use egui::{FontData, FontDefinitions, FontFamily};
use epaint_default_fonts::{HACK_REGULAR, UBUNTU_LIGHT};
use std::sync::Arc;

/// Words are Ubuntu's, numbers Hack's; each has what the other lacks.
pub(crate) fn letters() -> FontDefinitions {
    let [words, numbers] = ["Ubuntu-Light", "Hack"].map(str::to_owned);
    let mut letters = FontDefinitions::empty();
    for (name, bytes) in [(&words, UBUNTU_LIGHT), (&numbers, HACK_REGULAR)] {
        letters.font_data.insert(name.clone(), Arc::new(FontData::from_static(bytes)));
    }
    letters.families.insert(FontFamily::Proportional, vec![words.clone(), numbers.clone()]);
    letters.families.insert(FontFamily::Monospace, vec![numbers, words]);
    letters
}
