//! What techniques by flat triangles share: bounds of derivatives, how coarse triangles have to be, what is in the picture, who is seen on the CPU, and the passes
//! that draw on a GPU, by its rasterizer or by kernels.

pub mod arithmetic;
pub mod borders;
pub mod bounds;
pub mod coarsened;
pub mod compute;
pub mod cpu;
pub mod cut;
pub mod floor;
pub mod frustum;
pub mod gpu;
mod outline;
pub mod patches;
pub mod rounding;

use pipeline::wgsl::Part;

/// What a sample of a flat triangle shows, whoever finds the triangle.
pub const SAMPLE: Part = Part { file: "triangles.wgsl", text: include_str!("../../../shaders/triangles.wgsl") };

/// How much wider than the chord error the skirt of a bounded face is, pixels: what snapping moves its corners by, and what
/// a pixel may be beyond the border and still be covered.
pub const SKIRT_PX: f64 = 1.0 / 16.0;

/// The sine of the least angle under which a face is seen by which its skirt goes on in depth.
pub const STEEPEST: f32 = 1.0 / 16.0;

/// How far beyond the border the parameters of a skirt's corners are, in spans: any number says that they are beyond. A sample that only
/// snapping covers follows a triangle's plane beyond its edge by a 64th of the triangle; of this that is less than f32 resolves.
pub const BEYOND: f32 = 1.0 / 65536.0;

/// The corners of a cell's two triangles, from its first corner on, where a row in v has `columns` corners.
pub fn cell(first: u32, columns: u32) -> [u32; 6] {
    let [a, b, c, d] = [first, first + columns, first + columns + 1, first + 1];
    [a, b, c, a, c, d]
}
