//! What a picked pixel shows, in words.

use crate::words::number;
use compare::PixelVerdict;
use gbuffer::Hit;
use glam::DVec3;
use nurbs::Normal;
use std::sync::Arc;

/// A pixel that was picked, and what is said of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Column and row.
    pub at: [usize; 2],
    /// What it shows, as the renderer of the window found it.
    pub hit: Option<Hit>,
    /// The name of its face, where the file has one.
    pub name: Option<Arc<str>>,
    /// What a ray says that was cast there; `None` where the window itself shows rays.
    pub verdict: Option<PixelVerdict>,
}

impl Reading {
    /// A line for each thing: what it is, and its numbers.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let [x, y] = self.at;
        let mut lines = vec![("pixel", format!("{x}, {y}"))];
        match &self.hit {
            None => lines.push(("face", "none is here".to_owned())),
            Some(hit) => {
                let name = self.name.as_ref().map_or(String::new(), |name| format!(" {name}"));
                lines.extend([
                    ("face", format!("{}{name}", hit.face.0)),
                    ("u", number(hit.uv.x)),
                    ("v", number(hit.uv.y)),
                    ("point", vector(hit.position)),
                    ("normal", normal(&hit.normal)),
                ]);
                let curvatures = hit.curvature.map(|k| [("k1", k.k1), ("k2", k.k2)]);
                lines.extend(curvatures.into_iter().flatten().map(|(name, k)| (name, format!("{k:.9}"))));
            }
        }
        lines.push(("verdict", self.verdict()));
        lines
    }

    fn verdict(&self) -> String {
        let Some(PixelVerdict { cause, detail, unbounded, .. }) = &self.verdict else {
            return "the ray itself".to_owned();
        };
        match (cause, unbounded) {
            (Some(cause), _) => format!("differs, {}: {detail}", cause.label()),
            (None, Some(reason)) => format!("none, {}: {detail}", reason.label()),
            (None, None) => format!("agrees: {detail}"),
        }
    }
}

/// A line a component.
fn vector(v: DVec3) -> String {
    v.to_array().map(|x| format!("{x:.9}")).join("\n")
}

fn normal(normal: &Normal) -> String {
    match normal {
        Normal::Regular(n) => vector(*n),
        Normal::Limit(n) => format!("{}\n(a limit)", vector(*n)),
        Normal::Undefined => "undefined".to_owned(),
    }
}
