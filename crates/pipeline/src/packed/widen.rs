//! From f32 back to f64: what a fragment found, in the model's units.

use super::frame::PackedFrame;
use super::scene::PackedScene;
use crate::fragment::Fragment;
use gbuffer::{Hit, LocalParameters, PrincipalCurvatures};
use glam::{DVec2, DVec3};
use nurbs::{Normal, NormalStatus};
use scene::{FaceId, Ray};

impl PackedScene {
    /// What a fragment of this scene found, widened to the model's units, for the pixel seen along `ray`; of a fragment whose
    /// face has no such spans, parameters that are NaN.
    pub fn hit(&self, fragment: &Fragment, ray: &Ray) -> Hit {
        self.frames()[fragment.face as usize].hit(fragment, ray)
    }
}

impl PackedFrame {
    /// As [`PackedScene::hit`], of the face whose frame it is.
    pub fn hit(&self, fragment: &Fragment, ray: &Ray) -> Hit {
        let position = self.world(fragment.position);
        let regular = fragment.status == NormalStatus::Regular;
        // A GPU may write anything.
        let is_there = (0..2).all(|k| (fragment.span[k] as usize) + 1 < self.breaks[k].len());
        let [k1, k2] = fragment.curvature.map(|k| f64::from(k) / self.scale);
        Hit {
            face: FaceId(fragment.face),
            uv: if is_there { self.uv(fragment.span, fragment.uv) } else { DVec2::NAN },
            local: is_there.then(|| LocalParameters { span: fragment.span, uv: fragment.uv.map(f64::from).into() }),
            t: (position - ray.origin).dot(ray.direction),
            position,
            normal: if regular {
                Normal::Regular(DVec3::from_array(fragment.normal.map(f64::from)))
            } else {
                Normal::Undefined
            },
            curvature: regular.then_some(PrincipalCurvatures { k1, k2 }),
            edge: fragment.edge.map(|[x, y]| DVec2::new(f64::from(x), f64::from(y))),
        }
    }
}
