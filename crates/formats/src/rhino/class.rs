//! The classes of objects, by their identifiers in the file.

use super::archive::{Cursor, Fault, Uuid, code};
use crate::document::SurfaceKind;

/// A class of openNURBS.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    Brep,
    NurbsSurface,
    PlaneSurface,
    RevSurface,
    SumSurface,
    Extrusion,
    NurbsCurve,
    LineCurve,
    ArcCurve,
    PolylineCurve,
    PolyCurve,
    InstanceReference,
    InstanceDefinition,
    Layer,
    Material,
    /// One that is not read.
    Other(&'static str),
}

/// What each identifier names. Files that begin with an old name (TL_…) hold the same data as those with the new one.
const CLASSES: &[(u128, Class)] = &[
    (0x60b5dbc5_e660_11d3_bfe4_0010830122f0, Class::Brep),
    (0xf06fc243_a32a_4608_9dd8_a7d2c4ce2a36, Class::Brep),
    (0x2d4cfedb_3e2a_11d4_800e_0010830122f0, Class::Brep),
    (0x0705fdef_3e2a_11d4_800e_0010830122f0, Class::Brep),
    (0x4ed7d4de_e947_11d3_bfe5_0010830122f0, Class::NurbsSurface),
    (0x4760c817_0be3_11d4_bffe_0010830122f0, Class::NurbsSurface),
    (0xfa4fd4b5_1613_11d4_8000_0010830122f0, Class::NurbsSurface),
    (0x4ed7d4df_e947_11d3_bfe5_0010830122f0, Class::PlaneSurface),
    (0xa16220d3_163b_11d4_8000_0010830122f0, Class::RevSurface),
    (0x0a8401b6_4d34_4b99_8615_1b4e723dc4e5, Class::RevSurface),
    (0xc4cd5359_446d_4690_9ff5_29059732472b, Class::SumSurface),
    (0x665f6331_2a66_4cce_81d0_b5eebd9b5417, Class::SumSurface),
    (0x36f53175_72b8_4d47_bf1f_b4e6fc24f4b9, Class::Extrusion),
    (0x4ed7d4dd_e947_11d3_bfe5_0010830122f0, Class::NurbsCurve),
    (0x5eaf1119_0b51_11d4_bffe_0010830122f0, Class::NurbsCurve),
    (0x76a709d5_1550_11d4_8000_0010830122f0, Class::NurbsCurve),
    (0x4ed7d4db_e947_11d3_bfe5_0010830122f0, Class::LineCurve),
    (0xcf33be2a_09b4_11d4_bffb_0010830122f0, Class::ArcCurve),
    (0x4ed7d4e6_e947_11d3_bfe5_0010830122f0, Class::PolylineCurve),
    (0x4ed7d4e0_e947_11d3_bfe5_0010830122f0, Class::PolyCurve),
    (0xef638317_154b_11d4_8000_0010830122f0, Class::PolyCurve),
    (0xf9cfb638_b9d4_4340_87e3_c56e7865d96a, Class::InstanceReference),
    (0x26f8bff6_2618_417f_a158_153d64a94989, Class::InstanceDefinition),
    (0x95809813_e985_11d3_bfe5_0010830122f0, Class::Layer),
    (0x60b5dbbc_e660_11d3_bfe4_0010830122f0, Class::Material),
    (0x4ed7d4d8_e947_11d3_bfe5_0010830122f0, Class::Other("ON_CurveOnSurface")),
    (0x4ed7d4d9_e947_11d3_bfe5_0010830122f0, Class::Other("ON_CurveProxy")),
    (0x4ed7d4e2_e947_11d3_bfe5_0010830122f0, Class::Other("ON_SurfaceProxy")),
    (0x4ed7d4e4_e947_11d3_bfe5_0010830122f0, Class::Other("ON_Mesh")),
    (0xc3101a1d_f157_11d3_bfe7_0010830122f0, Class::Other("ON_Point")),
    (0x2488f347_f8fa_11d3_bfec_0010830122f0, Class::Other("ON_PointCloud")),
    (0xf09ba4d9_455b_42c3_ba3b_e6ccacef853b, Class::Other("ON_SubD")),
];

impl Class {
    pub fn of(uuid: Uuid) -> Self {
        CLASSES.iter().find(|(id, _)| *id == uuid.0).map_or(Self::Other("an unknown class"), |(_, class)| *class)
    }

    /// Its name in openNURBS.
    pub fn name(self) -> &'static str {
        match self {
            Self::Brep => "ON_Brep",
            Self::NurbsSurface => "ON_NurbsSurface",
            Self::PlaneSurface => "ON_PlaneSurface",
            Self::RevSurface => "ON_RevSurface",
            Self::SumSurface => "ON_SumSurface",
            Self::Extrusion => "ON_Extrusion",
            Self::NurbsCurve => "ON_NurbsCurve",
            Self::LineCurve => "ON_LineCurve",
            Self::ArcCurve => "ON_ArcCurve",
            Self::PolylineCurve => "ON_PolylineCurve",
            Self::PolyCurve => "ON_PolyCurve",
            Self::InstanceReference => "ON_InstanceRef",
            Self::InstanceDefinition => "ON_InstanceDefinition",
            Self::Layer => "ON_Layer",
            Self::Material => "ON_Material",
            Self::Other(name) => name,
        }
    }
}

/// An object: its class, and a cursor at the data of that.
#[derive(Debug, Clone)]
pub(super) struct Object<'a> {
    pub class: Class,
    pub uuid: Uuid,
    pub data: Cursor<'a>,
}

impl<'a> Object<'a> {
    /// The object whose chunk begins at the cursor; the cursor moves behind it. User data are read over.
    pub fn read(cursor: &mut Cursor<'a>) -> Result<Self, Fault> {
        let mut content = cursor.content(code::CLASS)?;
        let uuid = content.content(code::CLASS_UUID)?.uuid()?;
        let data = content.content(code::CLASS_DATA)?;
        Ok(Self { class: Class::of(uuid), uuid, data })
    }

    /// What kind of surface it is.
    pub fn surface_kind(&self) -> SurfaceKind {
        match self.class {
            Class::PlaneSurface => SurfaceKind::Plane,
            Class::RevSurface => SurfaceKind::Revolution,
            Class::SumSurface => SurfaceKind::Sum,
            Class::Extrusion => SurfaceKind::Extrusion,
            _ => SurfaceKind::Spline,
        }
    }

    /// How its class is called in messages.
    pub fn kind(&self) -> String {
        match self.class {
            Class::Other("an unknown class") => format!("class {}", self.uuid),
            class => class.name().to_owned(),
        }
    }
}
