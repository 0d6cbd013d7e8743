//! The project's own JSON: the model bit for bit; no unit.

use crate::error::ExportError;
use crate::writer::{Asked, Ready, Writer, Written};
use formats::Document;

/// The writer.
pub struct Json;

impl Writer for Json {
    fn name(&self) -> &'static str {
        "JSON"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["json"]
    }

    fn is_tessellated(&self) -> bool {
        false
    }

    fn prepare<'d>(&self, document: &'d Document, _: Asked) -> Result<Ready<'d>, ExportError> {
        let text = formats::json::write(&document.model)?;
        let unit = document.unit.as_ref();
        let notes = unit.map(|unit| format!("the unit, {}, is not written: JSON has no place for it", unit.name));
        let written = Written { faces: document.model.faces().len(), mesh: None, notes: notes.into_iter().collect() };
        Ok(Ready { written, fill: Box::new(move |out| out.write_all(text.as_bytes())) })
    }
}
