//! `Verdict`: what the judge says of G-buffers.

use crate::json;
use compare::Verdict as Answer;
use isophote::compare::SavedComparison;
use pyo3::prelude::*;

/// What the judge says: `agrees`, and `line` in words. Of the pair with the most differing pixels: `covered`, `differ`, `cause`.
#[pyclass(frozen, module = "isophote")]
pub struct Verdict(SavedComparison);

impl From<SavedComparison> for Verdict {
    fn from(comparison: SavedComparison) -> Self {
        Self(comparison)
    }
}

impl Verdict {
    /// The pair that is told of, and its number: of as many differing pixels the first.
    fn worst(&self) -> Option<(usize, &compare::PairReport)> {
        let pairs = self.0.pairs.iter().enumerate();
        pairs.max_by_key(|(k, pair)| (pair.differing(), std::cmp::Reverse(*k)))
    }
}

#[pymethods]
impl Verdict {
    /// Whether all pairs agree that show anything, and some does: the exit code would be 0.
    #[getter]
    fn agrees(&self) -> bool {
        self.exit_code() == 0
    }

    /// That of `isophote compare`: 0, 1 or 2.
    #[getter]
    fn exit_code(&self) -> u8 {
        self.0.exit_code()
    }

    /// The last line of `isophote compare`.
    #[getter]
    fn line(&self) -> String {
        self.0.line()
    }

    /// Pixels that either of the two shows.
    #[getter]
    fn covered(&self) -> usize {
        self.worst().map_or(0, |(_, pair)| pair.covered)
    }

    /// Pixels that differ.
    #[getter]
    fn differ(&self) -> usize {
        self.worst().map_or(0, |(_, pair)| pair.differing())
    }

    /// The one fault that explains the picture, else the most frequent cause; None where nothing differs.
    #[getter]
    fn cause(&self) -> Option<String> {
        let (k, pair) = self.worst().filter(|(_, pair)| pair.verdict == Answer::Differ)?;
        let diagnosis = self.0.diagnoses.get(k).and_then(Option::as_ref).map(ToString::to_string);
        diagnosis.or_else(|| pair.main_cause().map(|cause| cause.label().to_owned()))
    }

    /// Each pair as `isophote compare --format json` has it: counts, causes, the worst pixels.
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0.pairs)
    }

    fn __bool__(&self) -> bool {
        self.agrees()
    }

    fn __repr__(&self) -> String {
        format!("Verdict({:?})", self.line())
    }
}
