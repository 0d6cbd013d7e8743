//! A model: surfaces and the faces that use them.

use crate::extent::Extent;
use crate::{Face, FaceId, Region, SceneError};
use nurbs::{Hull, Surface};

/// A named set of faces over surfaces; never empty, and every face's surface exists.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    name: String,
    surfaces: Vec<Surface>,
    faces: Vec<Face>,
    regions: Vec<Option<Region>>,
    hull: Hull,
}

impl Model {
    /// A model of the given faces; surfaces that no face uses are kept and not drawn.
    ///
    /// # Errors
    /// [`SceneError::NoFaces`], [`SceneError::NoSuchSurface`], and those of [`Region::new`].
    pub fn new(name: impl Into<String>, surfaces: Vec<Surface>, faces: Vec<Face>) -> Result<Self, SceneError> {
        if faces.is_empty() {
            return Err(SceneError::NoFaces);
        }
        let count = surfaces.len();
        if let Some(face) = faces.iter().position(|f| f.surface >= count) {
            return Err(SceneError::NoSuchSurface { face, surface: faces[face].surface, count });
        }
        let region = |(index, face): (usize, &Face)| Region::new(index, face, &surfaces[face.surface]);
        let regions: Vec<Option<Region>> = faces.iter().enumerate().map(region).collect::<Result<_, _>>()?;
        let hull = Extent::new(&surfaces, &faces, &regions).hull();
        Ok(Self { name: name.into(), surfaces, faces, regions, hull })
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
        assert_eq!(self.surfaces[index].domain(), surface.domain(), "a region is a part of its surface's domain");
        let mut model = self.clone();
        model.surfaces[index] = surface;
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
