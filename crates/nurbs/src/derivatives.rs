//! A point of a surface with its derivatives, as all evaluators give them.

use glam::{DVec3, DVec4};

/// Position and first derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstDerivatives {
    /// S, model units.
    pub s: DVec3,
    /// S_u, model units per unit of u.
    pub su: DVec3,
    /// S_v.
    pub sv: DVec3,
}

/// Position and all derivatives to second order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondDerivatives {
    /// S, model units.
    pub s: DVec3,
    /// S_u.
    pub su: DVec3,
    /// S_v.
    pub sv: DVec3,
    /// S_uu.
    pub suu: DVec3,
    /// S_uv.
    pub suv: DVec3,
    /// S_vv.
    pub svv: DVec3,
}

impl FirstDerivatives {
    /// The quotient rule (Piegl & Tiller, A4.4) on a numerator about `origin`.
    #[inline(always)]
    pub(crate) fn from_homogeneous(origin: DVec3, a: DVec4, a_u: DVec4, a_v: DVec4) -> Self {
        let w = 1.0 / a.w;
        let s = a.truncate() * w;
        Self { s: origin + s, su: (a_u.truncate() - s * a_u.w) * w, sv: (a_v.truncate() - s * a_v.w) * w }
    }
}
