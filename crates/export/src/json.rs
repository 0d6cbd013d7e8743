//! The project's own JSON: the document bit for bit, but for notes on how it was read.

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

    fn prepare<'d>(&self, _: &str, document: &'d Document, _: Asked) -> Result<Ready<'d>, ExportError> {
        let text = formats::json::write_document(document)?;
        let written = Written { faces: document.model.faces().len(), mesh: None, notes: vec![] };
        Ok(Ready { written, fill: Box::new(move |out| out.write_all(text.as_bytes())), beside: None })
    }
}
