//! What can be wrong with a G-buffer file, a shading or a picture.

use scene::SceneError;
use std::io;
use std::path::PathBuf;

/// Why a G-buffer or a picture could not be read, written or made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GBufferError {
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What it said.
        source: io::Error,
    },
    /// The file is not a whole zip archive.
    #[error("{}: not a readable .npz file: {reason}", path.display())]
    Archive {
        /// The file.
        path: PathBuf,
        /// What the zip reader said.
        reason: String,
    },
    /// The archive lacks an array.
    #[error("{}: the array {array:?} is missing", path.display())]
    MissingArray {
        /// The file.
        path: PathBuf,
        /// The array.
        array: &'static str,
    },
    /// The archive has an entry that is none of the arrays: a slip in a name, perhaps.
    #[error("{}: the entry {entry:?} is none of the arrays {known} (each ends in .npy)", path.display())]
    UnknownArray {
        /// The file.
        path: PathBuf,
        /// The entry's name, cut short.
        entry: String,
        /// The arrays that are known.
        known: String,
    },
    /// The entry does not begin as a NumPy array does.
    #[error("{}: the array {array:?} has a malformed header: {reason}", path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// The array.
        array: &'static str,
        /// What is wrong with it.
        reason: String,
    },
    /// The array is stored column by column.
    #[error("{}: the array {array:?} is in Fortran order; store it in C order", path.display())]
    FortranOrder {
        /// The file.
        path: PathBuf,
        /// The array.
        array: &'static str,
    },
    /// The elements have a type that cannot be taken without loss.
    #[error("{}: the array {array:?} has dtype {found:?}, not one of {expected}", path.display())]
    Dtype {
        /// The file.
        path: PathBuf,
        /// The array.
        array: &'static str,
        /// NumPy's name of the type found.
        found: String,
        /// Those that are accepted.
        expected: &'static str,
    },
    /// The array's shape is not that of the picture.
    #[error("{}: the array {array:?} has shape {found:?}, not {expected:?}", path.display())]
    Shape {
        /// The file.
        path: PathBuf,
        /// The array.
        array: &'static str,
        /// The shape found.
        found: Vec<u64>,
        /// The shape that `hit`, or else `face`, asks for.
        expected: Vec<u64>,
    },
    /// The array that tells the picture's size is not one of rows of pixels.
    #[error("{}: the array {array:?} has shape {found:?}, not rows and columns of pixels", path.display())]
    NotRows {
        /// The file.
        path: PathBuf,
        /// The array: `hit`, or `face` where that is absent.
        array: &'static str,
        /// The shape found.
        found: Vec<u64>,
    },
    /// The picture's size, as `hit` or else `face` has it, is not a legal one.
    #[error("{}: {source}", path.display())]
    Size {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: SceneError,
    },
    /// The array's data end early, go on too long, or are damaged.
    #[error("{}: the data of the array {array:?} are damaged: {reason}", path.display())]
    Data {
        /// The file.
        path: PathBuf,
        /// The array.
        array: &'static str,
        /// How.
        reason: String,
    },
    /// An element has a value that it must not have.
    #[error("{}: {array} at pixel ({x}, {y}) is {value}, not {expected}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The array.
        array: &'static str,
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// The value found.
        value: f64,
        /// What would be legal.
        expected: &'static str,
    },
    /// The metadata are not the JSON object that they should be.
    #[error("{}: malformed meta: {reason}", path.display())]
    Meta {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The metadata name another size than the arrays have.
    #[error("{}: meta names {}x{} pixels, the arrays have {}x{}", path.display(), meta[0], meta[1], arrays[0], arrays[1])]
    MetaSize {
        /// The file.
        path: PathBuf,
        /// Width and height in the metadata.
        meta: [usize; 2],
        /// Width and height of the arrays.
        arrays: [usize; 2],
    },
    /// A face's number does not fit the file's 32-bit signed integers.
    #[error("face {face} cannot be written: the file's greatest face number is {}", i32::MAX)]
    FaceTooLarge {
        /// The face.
        face: u32,
    },
    /// A hit is on a face that the model does not have.
    #[error("pixel ({x}, {y}) shows face {face}, but the model has only {count}")]
    NoSuchFace {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// The face.
        face: u32,
        /// Number of faces.
        count: usize,
    },
    /// The isophotes' bands are too narrow or too wide.
    #[error("isophote bands of {degrees} degrees: they must be 2.5 to 90")]
    BandWidth {
        /// The width, degrees.
        degrees: f64,
    },
    /// There are no stripes, or too many to be told apart.
    #[error("{count} stripes: they must be 1 to 1000")]
    Stripes {
        /// How many were asked for.
        count: u32,
    },
    /// A light direction is zero or not finite.
    #[error("the light direction {direction:?} is zero or not finite")]
    Light {
        /// The direction.
        direction: [f64; 3],
    },
    /// A picture has another number of pixels than its sides ask for, or no pixels.
    #[error("a picture of {width}x{height} pixels from {count} colours")]
    PictureSize {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// Number of colours given.
        count: usize,
    },
    /// No picture was given where at least one is needed.
    #[error("there are no pictures to average")]
    NoPictures,
    /// Two pictures to be compared differ in size.
    #[error("a picture of {}x{} pixels beside one of {}x{}", a[0], a[1], b[0], b[1])]
    PictureSizesDiffer {
        /// Width and height of the first.
        a: [usize; 2],
        /// Width and height of the second.
        b: [usize; 2],
    },
    /// A picture is too large for JPEG.
    #[error("{width}x{height} pixels are too many for JPEG, which has 65535 along each side")]
    Jpeg {
        /// Width, pixels.
        width: usize,
        /// Height, pixels.
        height: usize,
    },
    /// The PNG writer refused.
    #[error("{}: {reason}", path.display())]
    Png {
        /// The file.
        path: PathBuf,
        /// What it said.
        reason: String,
    },
}
