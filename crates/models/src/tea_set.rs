//! Newell's tea set, as the files of `testdata/models` have it.

use crate::construction::embedded;
use scene::Model;

/// 32 patches; z up, the spout along +x.
pub(crate) fn teapot() -> Model {
    embedded(include_str!("../../../testdata/models/teapot.json"))
}

/// 26 patches; y up.
pub(crate) fn teacup() -> Model {
    embedded(include_str!("../../../testdata/models/teacup.json"))
}

/// 16 patches; z up, the handle along −y.
pub(crate) fn teaspoon() -> Model {
    embedded(include_str!("../../../testdata/models/teaspoon.json"))
}
