//! The codes that SASIG-PDQ 2.1 (ISO/PAS 26183) and VDA 4955 give the criteria which a report answers; `docs/continuity.md` says which
//! of them were read where.

use serde::Serialize;

/// A code for each criterion.
#[derive(Debug, Serialize)]
pub struct Codes {
    /// Large face gap.
    pub gap: &'static str,
    /// Non-tangent faces.
    pub angle: &'static str,
    /// Non-smooth faces.
    pub curvature: &'static str,
    /// Free edge.
    pub free: &'static str,
    /// Over-used edge.
    pub non_manifold: &'static str,
    /// Inconsistent face in a shell.
    pub turned: &'static str,
    /// Small radius of curvature of a surface.
    pub radius: &'static str,
    /// Degenerate boundary of a surface.
    pub points: &'static str,
    /// Folded surface.
    pub degenerate_normals: &'static str,
    /// Narrow face.
    pub sliver: &'static str,
}

/// All of them.
pub const CODES: Codes = Codes {
    gap: "G-SH-LG",
    angle: "G-SH-NT",
    curvature: "G-SH-NS",
    free: "G-SH-FR",
    non_manifold: "G-SH-NM",
    turned: "G-SH-IT",
    radius: "G-SU-CR",
    points: "G-SU-DC",
    degenerate_normals: "G-SU-FO",
    sliver: "G-FA-NA",
};
