//! Free-form surfaces of Wavefront's `.obj`, as exact rational splines with their trims.
//!
//! ```text
//! v -1 -1 0 0.5                        x y z weight
//! vp 0.2 0.8                           u v weight, of a trim
//! cstype rat bspline                   or bezier; rat where weights count
//! deg 2 2
//! curv2 1 2 3 4 1                      a curve in (u, v)
//! parm u 0 0 1 2 3 4 4
//! end
//! surf 0 1 0 1 1 2 3 4 5 6 7 8 9       the range, and the points, fastest along u
//! parm u 0 0 0 1 1 1
//! parm v 0 0 0 1 1 1
//! trim 0 4 1                           from, to, curve: the outer boundary; hole: inner ones
//! end
//! ```
//!
//! The rest is as in appendix B1 of *The Advanced Visualizer* (Alias|Wavefront, version 3.0): `\` continues a line, `#` begins a
//! comment, numbers below 0 count from the last point or curve. `parm` of a B-spline gives all n + p + 1 knots, that of a Bézier
//! the ends of its pieces. `surf` may state less than the knots' domain; then the face ends there.
//!
//! The bases cardinal, taylor and bmatrix are not converted: their elements are left out with the line of `cstype`. Polygons,
//! lines, points and curves in space are not drawn. Each such thing is a note with its line; many of one kind are one note. An
//! element with a wrong number costs itself. The file states no unit and no tolerance.

mod element;
mod reader;
mod statements;

use crate::document::Document;
use crate::error::FormatError;
use crate::format::Format;
use reader::Reader;
use statements::Statements;

/// Words with which files begin, and no file of another format.
const FIRST_WORDS: &[&str] = &["v", "vp", "vt", "vn", "g", "o", "s", "mtllib", "usemtl", "cstype", "deg"];

/// The format.
pub struct Obj;

impl Format for Obj {
    fn name(&self) -> &'static str {
        "OBJ"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["obj"]
    }

    fn start(&self) -> &'static str {
        "starts with a statement such as \"v 0 0 0\""
    }

    fn sniff(&self, head: &[u8]) -> bool {
        let first = Statements::new(head).next();
        let word = first.as_ref().and_then(|statement| statement.text.split_whitespace().next());
        word.is_some_and(|word| FIRST_WORDS.contains(&word))
    }

    /// # Errors
    /// [`Cause::Kind`](crate::Cause::Kind) where nothing in it can be drawn, [`Cause::Scene`](crate::Cause::Scene) where no face has a
    /// region.
    fn read(&self, bytes: &[u8], file: &str) -> Result<Document, FormatError> {
        let mut reader = Reader::default();
        Statements::new(bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes))
            .for_each(|statement| reader.statement(&statement));
        reader.finish(file)
    }
}
