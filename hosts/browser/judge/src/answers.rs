//! The browser as an adapter: what it drew is there already.

use crate::request::{Files, Picture};
use anyhow::{Context, Result, bail, ensure};
use files::ReadError;
use gpu::Grid;
use gpu::capsule::{Contents, Host, Played, gbuffer, grid};
use std::io;
use std::path::Path;
use suite::corpus::command_options;
use suite::report::Subject;
use suite::run::{Adapter, DrawError};
use suite::stage::{OnGpu, Stage};

/// The answers to the capsules of one scene.
pub struct Answers {
    /// Who drew.
    pub subject: Subject,
    /// The same as the answers say it.
    pub host: Host,
    /// How far its rasterizer moves corners, pixels; none where no grid was found.
    pub moves_px: Option<f64>,
    /// A picture a case.
    pub pictures: Vec<Picture>,
    /// What they name.
    pub files: Files,
}

impl Adapter for Answers {
    fn subject(&self) -> Subject {
        self.subject.clone()
    }

    fn draw(&mut self, stage: &Stage) -> Result<OnGpu, DrawError> {
        self.drawn(stage).map_err(|error| DrawError::Refused(format!("{error:#}")))
    }
}

impl Answers {
    fn drawn(&self, stage: &Stage) -> Result<OnGpu> {
        // All are of one scene, so of one model: camera, size and plan tell its cases apart.
        let options = command_options(&stage.camera, stage.viewport, stage.plan);
        let picture = self.pictures.iter().find(|picture| picture.options.ends_with(&options));
        let Picture { capsule, answer, failure, .. } = picture.context("the page did not draw it")?;
        let Some(answer) = answer else { bail!("{}", failure.as_deref().unwrap_or("the page gave no answer")) };
        let read = |path: &Path, limit: u64| read(&self.files, path, limit);
        let (contents, played) = (Contents::read_by(capsule, &read)?, Played::read_by(answer, &read)?);
        let drawn_by = &played.answer().host;
        ensure!(*drawn_by == self.host, "it was drawn on {}, not on {}", drawn_by.adapter, self.host.adapter);
        let moves_px = self.moves_px.filter(|_| stage.snaps_corners());
        Ok(OnGpu { gbuffer: gbuffer(&contents, &played)?, shaded: None, moves_px })
    }
}

/// The grid that an answer to [`edges`](gpu::capsule::edges) tells of; none where it tells of none.
///
/// # Errors
/// Where it is no such answer.
pub fn measured(answer: &Path, files: &Files) -> Result<Option<Grid>> {
    Ok(grid(&Played::read_by(answer, &|path: &Path, limit: u64| read(files, path, limit))?)?)
}

fn read(files: &Files, path: &Path, limit: u64) -> Result<Vec<u8>, ReadError> {
    let bytes = files.get(path).ok_or(io::Error::from(io::ErrorKind::NotFound))?;
    if bytes.len() as u64 > limit {
        return Err(ReadError::TooLarge { bytes: bytes.len() as u64, limit });
    }
    Ok(bytes.clone())
}
