//! What can go wrong between a scene and its picture.

use std::time::Duration;

/// The line that installs a software Vulkan driver on Debian and its kin.
pub const SOFTWARE_DRIVER: &str = "apt-get install mesa-vulkan-drivers libvulkan1";

/// What helps where no adapter was found, by the platform's name as [`std::env::consts::OS`] has it: Vulkan, Metal or Direct3D 12
/// is what is asked there.
pub fn remedy(platform: &str) -> String {
    match platform {
        "linux" => {
            format!("a software one comes with `{SOFTWARE_DRIVER}`, or what your system calls Mesa's Vulkan drivers")
        }
        "macos" | "ios" => {
            "Metal is asked, which macOS brings on every Mac; a virtual machine needs a paravirtual GPU".to_owned()
        }
        "windows" => "Direct3D 12 and Vulkan are asked; Windows 10 and later bring a software one (WARP)".to_owned(),
        _ => "install a Vulkan driver; Mesa's lavapipe needs no GPU".to_owned(),
    }
}

/// Why the GPU gave no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter at all.
    #[error("no GPU adapter was found; {}", remedy(std::env::consts::OS))]
    NoAdapter,
    /// No adapter of the name asked for.
    #[error("no adapter's name contains {wanted:?}; there are: {}", found.join(", "))]
    NoSuchAdapter {
        /// What was asked for.
        wanted: String,
        /// The names of all adapters, at least one.
        found: Vec<String>,
    },
    /// The adapter is there, but gives no device.
    #[error("{adapter} cannot be opened: {reason}")]
    Open {
        /// The adapter.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// The adapter is too small for what is asked of it.
    #[error("{what} needs {needed} of {limit}, but the adapter has {available}")]
    Limit {
        /// What does not fit.
        what: &'static str,
        /// WebGPU's name of the limit.
        limit: &'static str,
        /// How much it needs; bytes, pixels or a count, as the limit has it.
        needed: u64,
        /// How much there is.
        available: u64,
    },
    /// The adapter's memory does not hold it.
    #[error("the adapter ran out of memory while {during}")]
    OutOfMemory {
        /// What was being done.
        during: &'static str,
    },
    /// A shader does not compile, or does not fit the stages around it.
    #[error("shader {entry} of {program}: {message}")]
    Shader {
        /// The program, as `{:?}` of `pipeline::Program` gives it.
        program: String,
        /// The entry point, or `source` where the text itself is illegal.
        entry: &'static str,
        /// The compiler's message, with the line.
        message: String,
    },
    /// wgpu refused a call: a fault of this crate, not of its input.
    #[error("wgpu refused while {during}: {message}")]
    Refused {
        /// What was being done.
        during: &'static str,
        /// Its message.
        message: String,
    },
    /// The device is gone: the driver crashed, reset, or was taken away.
    #[error("the device was lost while {during}: {reason}")]
    Lost {
        /// What was being done.
        during: &'static str,
        /// What the driver said.
        reason: String,
    },
    /// The device did not finish in time.
    #[error("the device did not finish {during} within {} seconds", limit.as_secs())]
    Timeout {
        /// What was being done.
        during: &'static str,
        /// How long was waited.
        limit: Duration,
    },
    /// Something drawn by another technique than that for which a renderer was made.
    #[error("the renderer draws by technique {expected}, and is given what {found} draws")]
    Technique {
        /// Name of the renderer's technique.
        expected: &'static str,
        /// Name of the other.
        found: &'static str,
    },
    /// A question about the search of a technique that has none.
    #[error("technique {technique} searches for nothing")]
    NothingSearched {
        /// Its name.
        technique: &'static str,
    },
    /// An edit that changes how much there is of something, which needs a new renderer.
    #[error("an edit makes {found} bytes of {what} where there are {expected}; make a new renderer")]
    OtherShape {
        /// Of what.
        what: &'static str,
        /// How many bytes there are.
        expected: usize,
        /// How many there would be.
        found: usize,
    },
    /// Another number of views than of faces.
    #[error("{found} views for a scene of {expected} faces")]
    ViewCount {
        /// Number of faces.
        expected: usize,
        /// Number of views.
        found: usize,
    },
    /// A pixel shows a face that the scene does not have.
    #[error("pixel ({x}, {y}) shows face {face}, but the scene has only {count}")]
    Malformed {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// The face.
        face: u32,
        /// Number of faces.
        count: usize,
    },
    /// A pixel that no fragment wrote does not hold what it was cleared to: the readback is not of this frame.
    #[error("pixel ({x}, {y}) is empty but does not hold the value it was cleared to")]
    NotCleared {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
    },
    /// A probe's answer was not written, or is of another query.
    #[error("query {index} of the probe was not answered")]
    Unanswered {
        /// Which query.
        index: usize,
    },
    /// A probe asks for a face that the scene does not have, or that another program evaluates.
    #[error("query {index} of the probe asks for face {face}, which {program} does not evaluate")]
    ProbeFace {
        /// Which query.
        index: usize,
        /// The face.
        face: u32,
        /// The program.
        program: String,
    },
}
