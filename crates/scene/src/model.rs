//! A model: surfaces and the faces that use them.

use crate::extent::Extent;
use crate::{Face, FaceId, Note, Region, SceneError};
use nurbs::{Hull, Surface};

/// A named set of faces over surfaces; never empty, and every face's surface exists.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    name: String,
    surfaces: Vec<Surface>,
    faces: Vec<Face>,
    /// The number that each face has in its file.
    numbers: Vec<usize>,
    regions: Vec<Option<Region>>,
    hull: Hull,
    notes: Vec<Note>,
}

impl Model {
    /// A model of the given faces; surfaces that no face uses are kept and not drawn.
    ///
    /// # Errors
    /// [`SceneError::NoFaces`], [`SceneError::NoSuchSurface`], and those of [`Region::new`].
    pub fn new(name: impl Into<String>, surfaces: Vec<Surface>, faces: Vec<Face>) -> Result<Self, SceneError> {
        let model = Self::of_sound_faces(name, surfaces, faces.into_iter().enumerate().collect(), vec![]);
        let model = model.map_err(|error| match error {
            SceneError::NoFaceLeft { mut causes } => causes.swap_remove(0),
            other => other,
        })?;
        let left_out = model.notes.into_iter().find_map(|note| match note {
            Note::FaceLeftOut { cause, .. } => Some(cause),
            _ => None,
        });
        match left_out {
            Some(cause) => Err(cause),
            None => Ok(Self { notes: vec![], ..model }),
        }
    }

    /// A model of those of the given faces, each with the number that it has in its file, whose loops bound a region.
    ///
    /// A face that has none is left out, and [`Self::notes`] says so after the `notes` given here. Several faces may have
    /// one number, as the parts of a face that was cut: then a part in which no loop leaves material is no loss.
    ///
    /// # Errors
    /// [`SceneError::NoFaces`], [`SceneError::NoSuchSurface`], and [`SceneError::NoFaceLeft`] where all are left out.
    pub fn of_sound_faces(
        name: impl Into<String>,
        surfaces: Vec<Surface>,
        faces: Vec<(usize, Face)>,
        mut notes: Vec<Note>,
    ) -> Result<Self, SceneError> {
        if faces.is_empty() {
            return Err(SceneError::NoFaces);
        }
        let count = surfaces.len();
        if let Some((face, Face { surface, .. })) = faces.iter().find(|(_, f)| f.surface >= count) {
            return Err(SceneError::NoSuchSurface { face: *face, surface: *surface, count });
        }
        let extent = faces.iter().map(|(_, face)| from_origin(&surfaces[face.surface])).fold(0.0, f64::max);
        let (mut sound, mut numbers, mut regions, mut causes) = (vec![], vec![], vec![], vec![]);
        let mut known: Option<usize> = None;
        let mut faces = faces.into_iter().peekable();
        while let Some((number, face)) = faces.next() {
            match Region::new(number, &face, &surfaces[face.surface], extent) {
                Ok(region) => {
                    // The parts of a face say the same.
                    if let Some(region) = region.as_ref().filter(|_| known != Some(number)) {
                        notes.extend(notes_of(number, region));
                    }
                    known = Some(number);
                    sound.push(face);
                    numbers.push(number);
                    regions.push(region);
                }
                Err(SceneError::NoMaterial { .. }) if known == Some(number) => {}
                Err(SceneError::NoMaterial { .. }) if faces.peek().is_some_and(|(next, _)| *next == number) => {}
                Err(cause) => causes.push((number, cause)),
            }
        }
        if sound.is_empty() {
            return Err(SceneError::NoFaceLeft { causes: causes.into_iter().map(|(_, cause)| cause).collect() });
        }
        notes.extend(causes.into_iter().map(|(face, cause)| Note::FaceLeftOut { face, cause }));
        let hull = Extent::new(&surfaces, &sound, &regions).hull();
        Ok(Self { name: name.into(), surfaces, faces: sound, numbers, regions, hull, notes })
    }

    /// A model with one whole face a surface.
    ///
    /// # Errors
    /// [`SceneError::NoFaces`] where there is no surface.
    pub fn of_surfaces(name: impl Into<String>, surfaces: Vec<Surface>) -> Result<Self, SceneError> {
        let faces = (0..surfaces.len()).map(Face::whole).collect();
        Self::new(name, surfaces, faces)
    }

    /// The same model with another surface in place of surface `index`, on the same domain: a control point has moved.
    ///
    /// Loops are curves in parameters, so that every region stays as it is.
    ///
    /// # Panics
    /// Where there is no such surface, or the domain is another one.
    pub fn with_surface(&self, index: usize, surface: Surface) -> Self {
        let mut surfaces = self.surfaces.clone();
        surfaces[index] = surface;
        self.with_surfaces(surfaces)
    }

    /// The same model with other surfaces in place of all, each on the same domain.
    ///
    /// # Panics
    /// Where there are more or fewer surfaces, or one has another domain.
    pub fn with_surfaces(&self, surfaces: Vec<Surface>) -> Self {
        assert_eq!(self.surfaces.len(), surfaces.len(), "a surface for each");
        for (own, other) in self.surfaces.iter().zip(&surfaces) {
            assert_eq!(own.domain(), other.domain(), "a region is a part of its surface's domain");
        }
        let mut model = Self { surfaces, ..self.clone() };
        model.hull = model.extent().hull();
        model
    }

    /// The model's name, for titles and file names.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// All surfaces.
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// All faces, in order of [`FaceId`].
    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// What of its file is not drawn as it stands there; empty for a model that was not read from one.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// The number that a face has in its file: another one where faces before it were left out or cut.
    ///
    /// # Panics
    /// Where `id` is not one of this model's faces.
    pub fn number_in_file(&self, id: FaceId) -> usize {
        self.numbers[id.0 as usize]
    }

    /// The surface of a face.
    ///
    /// # Panics
    /// Where `id` is not one of this model's faces.
    pub fn surface(&self, id: FaceId) -> &Surface {
        &self.surfaces[self.faces[id.0 as usize].surface]
    }

    /// The trimmed part of a face's domain; `None` where it has no loops and is its whole surface.
    ///
    /// # Panics
    /// Where `id` is not one of this model's faces.
    pub fn region(&self, id: FaceId) -> Option<&Region> {
        self.regions[id.0 as usize].as_ref()
    }

    /// The region of a face that has less material than its whole surface; `None` for all others.
    ///
    /// # Panics
    /// Where `id` is not one of this model's faces.
    pub fn trimmed_region(&self, id: FaceId) -> Option<&Region> {
        self.region(id).filter(|region| !region.is_whole())
    }

    /// Whether any face carries trim loops.
    pub fn is_trimmed(&self) -> bool {
        self.faces.iter().any(|f| !f.loops.is_empty())
    }

    /// A box that holds all that is seen of all faces, at most 0.1 % of its extent too large on any side.
    pub fn hull(&self) -> Hull {
        self.hull
    }

    /// How far what is seen reaches along any direction.
    pub(crate) fn extent(&self) -> Extent<'_> {
        Extent::new(&self.surfaces, &self.faces, &self.regions)
    }

    /// A 64-bit FNV-1a hash of all that is drawn (degrees, knots, points, weights, orientations, loops), as
    /// hexadecimal.
    ///
    /// It names the model in a G-buffer's metadata; it is the same on every machine.
    pub fn hash(&self) -> String {
        let mut hash = 0xcbf2_9ce4_8422_2325u64;
        let mut add = |bits: u64| {
            for byte in bits.to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        };
        // A surface of thousands of faces counts once: after that, by the first face that it is of.
        let mut first_face: Vec<Option<usize>> = vec![None; self.surfaces.len()];
        for (id, face) in self.faces.iter().enumerate() {
            let surface = &self.surfaces[face.surface];
            add(u64::from(face.reversed));
            if let Some(first) = first_face[face.surface] {
                add(first as u64);
            } else {
                first_face[face.surface] = Some(id);
                for direction in [nurbs::Direction::U, nurbs::Direction::V] {
                    let knots = surface.knots(direction);
                    add(knots.degree() as u64);
                    knots.knots().iter().for_each(|k| add(k.to_bits()));
                }
                surface.points().iter().flat_map(|p| p.to_array()).for_each(|x| add(x.to_bits()));
                surface.weights().unwrap_or_default().iter().for_each(|w| add(w.to_bits()));
            }
            for boundary in &face.loops {
                add(boundary.trims.len() as u64);
                for trim in &boundary.trims {
                    add(trim.knots.degree() as u64);
                    add(u64::from(trim.reversed));
                    trim.knots.knots().iter().for_each(|k| add(k.to_bits()));
                    trim.points.iter().flat_map(|p| p.to_array()).for_each(|x| add(x.to_bits()));
                    trim.weights.as_deref().unwrap_or_default().iter().for_each(|w| add(w.to_bits()));
                }
            }
        }
        format!("{hash:016x}")
    }
}

/// The greatest distance of a surface's control box from the origin, along any axis.
fn from_origin(surface: &Surface) -> f64 {
    let hull = surface.hull();
    hull.min.abs().max(hull.max.abs()).max_element()
}

fn notes_of(face: usize, region: &Region) -> Vec<Note> {
    let repairs = region.repairs();
    let dropped = repairs.dropped.iter().map(|&boundary| Note::LoopDropped { face, boundary });
    dropped.chain(repairs.wide_gaps.iter().map(|gap| Note::WideGap { face, gap: gap.clone() })).collect()
}
