//! Extrusions: profiles in a plane, moved along a line, with flat ends that may be mitred and capped.

use super::archive::{Cursor, Fault, code};
use super::body::{Body, Remark};
use super::class::Object;
use super::curve::{Curve, joined, pieces};
use super::sheet::Sheet;
use crate::document::SurfaceKind;
use crate::spline::area;
use glam::{DMat3, DVec2, DVec3, DVec4};
use scene::{Face, Loop, Trim};

/// The least cosine of the angle by which an end may be mitred (openNURBS, `ON_Extrusion::m_Nz_min`).
const LEAST_COSINE: f64 = 1.0 / 64.0;

/// An extrusion of the file.
pub(super) struct Extrusion {
    at: usize,
    /// The outer profile, then the inner ones; each is pieces that follow each other.
    profiles: Vec<Vec<Curve>>,
    /// Where the profiles' plane is at the start and at the end.
    ends: [End; 2],
    path_domain: [f64; 2],
    is_transposed: bool,
    is_capped: [bool; 2],
}

/// A plane at an end of the path: (x, y) ↦ origin + axes (x, y, 0).
#[derive(Clone, Copy)]
struct End {
    origin: DVec3,
    axes: DMat3,
}

impl End {
    fn place(&self, p: DVec4) -> DVec4 {
        (self.origin * p.w + self.axes * DVec3::new(p.x, p.y, 0.0)).extend(p.w)
    }
}

impl Extrusion {
    pub fn read(object: &Object) -> Result<Self, Fault> {
        let mut data = object.data.clone().content(code::ANONYMOUS)?;
        let minor = data.version(1)?;
        let at = data.at();
        let profile = Object::read(&mut data)?;
        let [from, to] = [data.point()?, data.point()?];
        let shares = [data.f64()?, data.f64()?];
        let up = data.point()?;
        let is_mitred = [data.u8()? != 0, data.u8()? != 0];
        let normals = [data.point()?, data.point()?];
        let path_domain = data.interval()?;
        let is_transposed = data.u8()? != 0;
        let count = if minor >= 1 { data.i32()? } else { 1 };
        let is_capped = if minor >= 2 { [data.u8()? != 0, data.u8()? != 0] } else { [false; 2] };
        let (Some(along), Some(y)) = ((to - from).try_normalize(), up.try_normalize()) else {
            return data.fault("its path or its up vector has no direction");
        };
        let Some(x) = y.cross(along).try_normalize() else { return data.fault("its up vector runs along its path") };
        let frame = DMat3::from_cols(x, along.cross(x), along);
        let end = |k: usize| End {
            origin: from + (to - from) * shares[k],
            axes: if is_mitred[k] { frame * mitre(normals[k]) } else { frame },
        };
        let profiles = profiles(&profile, count, &data)?;
        Ok(Self { at, profiles, ends: [end(0), end(1)], path_domain, is_transposed, is_capped })
    }

    /// The outer wall as one surface.
    pub fn wall(&self, tolerance: f64) -> Result<Sheet, Fault> {
        self.side(&joined(self.profiles[0].clone(), tolerance, self.at)?)
    }

    fn side(&self, curve: &Curve) -> Result<Sheet, Fault> {
        let ends = self.ends.map(|end| move |p| end.place(p));
        let sheet = Sheet::ruled(curve, ends, self.path_domain, self.at)?;
        if self.is_transposed { sheet.transposed(self.at) } else { Ok(sheet) }
    }

    /// A face for each piece of each profile, and the caps. A capped extrusion shows its outside, and its inside where it is
    /// transposed, as openNURBS makes it.
    pub fn body(&self, tolerance: f64) -> Body {
        let mut body = Body::default();
        let mut add = |part: &str, kind: SurfaceKind, face: Result<(Sheet, Face), Fault>| match face {
            Ok((sheet, face)) => {
                body.kinds.push(kind);
                body.faces.push(Face { surface: body.surfaces.len(), tolerance, ..face });
                body.surfaces.push(sheet.surface);
            }
            Err(fault) => body.remarks.push(Remark::left_out(part, fault)),
        };
        let is_capped = self.is_capped.contains(&true);
        let areas: Vec<f64> = self.profiles.iter().map(|profile| area(&trims(profile)).unwrap_or(0.0)).collect();
        // Material is on the left of an outer profile that runs counter-clockwise, and of an inner one that runs the other way.
        let is_wrong = |k: usize| if k == 0 { areas[k] < 0.0 } else { areas[k] > 0.0 };
        for (k, profile) in self.profiles.iter().enumerate() {
            for piece in profile {
                let reversed = is_capped && is_wrong(k);
                add(
                    "a wall",
                    SurfaceKind::Extrusion,
                    self.side(piece).map(|sheet| (sheet, Face { reversed, ..Face::whole(0) })),
                );
            }
        }
        for (k, name) in ["the cap at the start", "the cap at the end"].into_iter().enumerate() {
            if self.is_capped[k] {
                let boundary = |(k, profile): (usize, &Vec<Curve>)| {
                    let mut trims = trims(profile);
                    if is_wrong(k) {
                        trims.reverse();
                        trims.iter_mut().for_each(|trim| trim.reversed = true);
                    }
                    Loop { outer: k == 0, trims }
                };
                let loops = self.profiles.iter().enumerate().map(boundary).collect();
                add(
                    name,
                    SurfaceKind::Plane,
                    self.cap(k).map(|sheet| {
                        (sheet, Face { reversed: (k == 0) ^ self.is_transposed, loops, ..Face::whole(0) })
                    }),
                );
            }
        }
        body
    }

    /// The plane of an end over the box of the outer profile, with the profile's coordinates as parameters.
    fn cap(&self, k: usize) -> Result<Sheet, Fault> {
        let points = || self.profiles[0].iter().flat_map(|piece| piece.spline.plane_points());
        let low = points().fold(DVec2::INFINITY, DVec2::min);
        let high = points().fold(DVec2::NEG_INFINITY, DVec2::max);
        let sides = [[low.x, high.x], [low.y, high.y]];
        let corner = |[i, j]: [usize; 2]| self.ends[k].place(DVec4::new(sides[0][i], sides[1][j], 0.0, 1.0)).truncate();
        Sheet::flat(sides, corner, self.at)
    }
}

fn trims(profile: &[Curve]) -> Vec<Trim> {
    profile.iter().map(|piece| piece.spline.trim()).collect()
}

/// The profiles of an extrusion: the segments of its polycurve where there are several.
fn profiles(profile: &Object, count: i32, data: &Cursor) -> Result<Vec<Vec<Curve>>, Fault> {
    let all = pieces(profile)?;
    if count == 1 {
        return Ok(vec![all]);
    }
    // Each profile is closed, and a new one begins where one has come back to its start.
    let mut profiles: Vec<Vec<Curve>> = vec![];
    let mut open: Vec<Curve> = vec![];
    for piece in all {
        open.push(piece);
        let start = open[0].spline.plane_points().next();
        let end = open[open.len() - 1].spline.plane_points().last();
        if start.zip(end).is_some_and(|(a, b)| a.distance(b) <= 1e-9 * (a.length() + b.length())) {
            profiles.push(std::mem::take(&mut open));
        }
    }
    if open.is_empty() && i32::try_from(profiles.len()) == Ok(count) {
        return Ok(profiles);
    }
    data.fault(format!("it states {count} profiles, and its curve has {} closed ones", profiles.len()))
}

/// Lets the profile climb the plane of a normal, so that it still projects to itself along the path.
fn mitre(normal: DVec3) -> DMat3 {
    let Some(normal) = normal.try_normalize().filter(|n| n.z > LEAST_COSINE) else { return DMat3::IDENTITY };
    let climb = |n: f64| -n / normal.z;
    DMat3::from_cols(DVec3::new(1.0, 0.0, climb(normal.x)), DVec3::new(0.0, 1.0, climb(normal.y)), DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mitred_profile_lies_in_its_plane_and_projects_to_itself() {
        let normal = DVec3::new(0.3, -0.2, 0.8);
        let matrix = mitre(normal);
        for p in [DVec3::new(1.0, 0.0, 0.0), DVec3::new(-0.5, 2.0, 0.0)] {
            let q = matrix * p;
            assert!(q.dot(normal).abs() < 1e-15, "{q}");
            assert_eq!((q.x, q.y), (p.x, p.y));
        }
        assert_eq!(mitre(DVec3::new(1.0, 0.0, 0.001)), DMat3::IDENTITY, "as openNURBS has it");
    }
}
