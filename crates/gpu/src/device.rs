//! Adapters and the device opened on one of them; every call to wgpu that can fail goes through [`Device::guarded`].

use crate::GpuError;
use crate::grid::Grid;
use crate::mark::Mark;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

/// The longest wait for submitted work: a software adapter at 16384² pixels stays below it, a hung shader does not.
const GREATEST_WAIT: Duration = Duration::from_secs(600);

/// Bytes a pixel of the G-buffer: four targets of 16.
pub(crate) const GBUFFER_BYTES: u32 = 64;

/// What makes the adapter's programs of WGSL.
pub const COMPILER: &str = "naga";

/// What kind of machine an adapter is, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdapterKind {
    /// A GPU with its own memory.
    Discrete,
    /// A GPU that shares the processor's memory.
    Integrated,
    /// A GPU seen through a hypervisor.
    Virtual,
    /// Not said.
    Other,
    /// The processor.
    Software,
}

/// What an adapter says of itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdapterInfo {
    /// Its name, as the driver spells it.
    pub name: String,
    /// PCI number of its maker, or the driver's own.
    pub vendor: u32,
    /// What kind of machine it is.
    pub kind: AdapterKind,
    /// Name of its driver.
    pub driver: String,
    /// Version of its driver, in the driver's words.
    pub driver_info: String,
    /// The API that it is reached through: `vulkan`, `metal`, `dx12`.
    pub backend: String,
}

impl AdapterInfo {
    fn of(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        Self {
            name: info.name,
            vendor: info.vendor,
            kind: match info.device_type {
                wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
                wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
                wgpu::DeviceType::VirtualGpu => AdapterKind::Virtual,
                wgpu::DeviceType::Other => AdapterKind::Other,
                wgpu::DeviceType::Cpu => AdapterKind::Software,
            },
            driver: info.driver,
            driver_info: info.driver_info,
            backend: info.backend.to_str().to_owned(),
        }
    }
}

/// The widest atomics that a kernel may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Atomics {
    /// Greatest and least of 64 bits.
    Bits64,
    /// All that WebGPU promises.
    Bits32,
}

/// Features of adapters with [`Atomics::Bits64`].
const WIDE_ATOMICS: wgpu::Features = wgpu::Features::SHADER_INT64.union(wgpu::Features::SHADER_INT64_ATOMIC_MIN_MAX);

/// Whose commands a device takes.
enum Of<'f> {
    /// Those of this program.
    Ours,
    /// Those of this program, which wgpu writes down in a folder.
    Recorded(&'f Path),
    /// Those of a file.
    Foreign,
}

/// All adapters of this machine, best kind first, in the driver's order within a kind.
pub fn adapters() -> Vec<AdapterInfo> {
    enumerate(&Of::Ours).into_iter().map(|(info, _)| info).collect()
}

fn enumerate(of: &Of) -> Vec<(AdapterInfo, wgpu::Adapter)> {
    let backends = wgpu::Backends::PRIMARY;
    // A frame would begin with a kernel that looks through its indirect calls, and an upload that says where they are. Ours have
    // the ranges of indices that the host gave them, no first instance and no buffer a step of instances; however many instances
    // a kernel asks for, they are legal. D3D12 needs that kernel for more than this.
    let checks = cfg!(windows) || matches!(of, Of::Foreign);
    let unchecked = if checks { wgpu::InstanceFlags::empty() } else { wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL };
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        flags: wgpu::InstanceFlags::default().difference(unchecked),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut adapters: Vec<_> = pollster::block_on(instance.enumerate_adapters(backends))
        .into_iter()
        .map(|adapter| (AdapterInfo::of(&adapter), adapter))
        .collect();
    adapters.sort_by_key(|(info, _)| info.kind);
    adapters
}

/// The best of `adapters` whose name contains `name`, whatever the case.
fn choose<T>(mut adapters: Vec<(AdapterInfo, T)>, name: Option<&str>) -> Result<(AdapterInfo, T), GpuError> {
    if adapters.is_empty() {
        return Err(GpuError::NoAdapter);
    }
    let wanted = name.unwrap_or_default();
    let fits = |info: &AdapterInfo| info.name.to_lowercase().contains(&wanted.to_lowercase());
    match adapters.iter().position(|(info, _)| fits(info)) {
        Some(index) => Ok(adapters.swap_remove(index)),
        None => Err(GpuError::NoSuchAdapter {
            wanted: wanted.to_owned(),
            found: adapters.into_iter().map(|(info, _)| info.name).collect(),
        }),
    }
}

/// An open device.
#[derive(Debug)]
pub struct Device {
    info: AdapterInfo,
    /// The device itself; calls to it go through [`Self::guarded`].
    pub wgpu: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// The limits that it was opened with.
    pub limits: wgpu::Limits,
    /// Why the device was lost, once it was.
    lost: Arc<Mutex<Option<String>>>,
    /// An error that reached no scope.
    stray: Arc<Mutex<Option<String>>>,
    /// Whether what it does is written down.
    pub(crate) records: bool,
    /// The grid of its corners, once measured.
    pub(crate) grid: OnceLock<Option<Grid>>,
}

impl Device {
    /// Opens the adapter whose name contains `name`, whatever the case; without one the best hardware adapter, and
    /// where there is none a software one.
    ///
    /// The device has the adapter's own limits where scenes and viewports may need more than WebGPU promises, and
    /// timestamp queries and atomics of 64 bits where the adapter has them.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`], [`GpuError::NoSuchAdapter`], [`GpuError::Open`]; [`GpuError::Limit`] where the adapter
    /// cannot write a G-buffer's 64 bytes a pixel at once.
    pub fn open(name: Option<&str>) -> Result<Self, GpuError> {
        Self::open_for(name, &Of::Ours)
    }

    /// As [`Self::open`], with WebGPU's own features alone; wgpu writes all that is asked of the device to `folder`, which must
    /// be there.
    pub(crate) fn recording(name: Option<&str>, folder: &Path) -> Result<Self, GpuError> {
        Self::open_for(name, &Of::Recorded(folder))
    }

    /// As [`Self::open`], for commands of a file: indirect calls are looked through before they are run.
    pub(crate) fn for_foreign(name: Option<&str>) -> Result<Self, GpuError> {
        Self::open_for(name, &Of::Foreign)
    }

    fn open_for(name: Option<&str>, of: &Of) -> Result<Self, GpuError> {
        let (info, adapter) = choose(enumerate(of), name)?;
        let has = adapter.limits();
        let mut limits = wgpu::Limits::default().or_worse_values_from(&has);
        limits.max_color_attachment_bytes_per_sample = has.max_color_attachment_bytes_per_sample;
        limits.max_texture_dimension_2d = has.max_texture_dimension_2d;
        limits.max_storage_buffer_binding_size = has.max_storage_buffer_binding_size;
        limits.max_buffer_size = has.max_buffer_size;
        let has = adapter.features();
        let (mut features, mut trace) = (has & wgpu::Features::TIMESTAMP_QUERY, wgpu::Trace::Off);
        match of {
            Of::Ours if has.contains(WIDE_ATOMICS) => features |= WIDE_ATOMICS,
            Of::Ours => {}
            Of::Recorded(folder) => {
                (features, trace) = (wgpu::Features::empty(), wgpu::Trace::Directory((*folder).into()))
            }
            Of::Foreign => features = wgpu::Features::empty(),
        }
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("isophote"),
            required_features: features,
            required_limits: limits.clone(),
            trace,
            ..Default::default()
        };
        let (wgpu, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::Open { adapter: info.name.clone(), reason: error.to_string() })?;
        let lost = Arc::new(Mutex::new(None));
        let stray = Arc::new(Mutex::new(None));
        let slot = lost.clone();
        wgpu.set_device_lost_callback(move |reason, message| {
            let reason = if message.is_empty() { format!("{reason:?}") } else { message };
            fill(&slot, reason);
        });
        let slot = stray.clone();
        wgpu.on_uncaptured_error(Arc::new(move |error| fill(&slot, error.to_string())));
        let records = matches!(of, Of::Recorded(_));
        let device = Self { info, wgpu, queue, limits, lost, stray, records, grid: OnceLock::new() };
        device.fits(
            "a G-buffer",
            "max_color_attachment_bytes_per_sample",
            u64::from(GBUFFER_BYTES),
            u64::from(device.limits.max_color_attachment_bytes_per_sample),
        )?;
        Ok(device)
    }

    /// What the adapter says of itself.
    pub fn info(&self) -> &AdapterInfo {
        &self.info
    }

    /// Whether the device can time its own work.
    pub fn has_timestamps(&self) -> bool {
        self.wgpu.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// The widest atomics that it has.
    pub fn atomics(&self) -> Atomics {
        if self.wgpu.features().contains(WIDE_ATOMICS) { Atomics::Bits64 } else { Atomics::Bits32 }
    }

    /// Nothing where `needed` is within the limit.
    pub fn fits(&self, what: &'static str, limit: &'static str, needed: u64, available: u64) -> Result<(), GpuError> {
        if needed <= available { Ok(()) } else { Err(GpuError::Limit { what, limit, needed, available }) }
    }

    /// Runs calls to wgpu and returns what they return, or the first error that any of them raised.
    pub fn guarded<T>(&self, during: &'static str, calls: impl FnOnce() -> T) -> Result<T, GpuError> {
        use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
        let scopes = [Validation, OutOfMemory, Internal].map(|filter| self.wgpu.push_error_scope(filter));
        let result = calls();
        // The last pushed is popped first; a refusal tells more than what follows from it.
        let [validation, memory, internal] = scopes;
        let internal = pollster::block_on(internal.pop());
        let memory = pollster::block_on(memory.pop());
        let validation = pollster::block_on(validation.pop());
        self.alive(during)?;
        if memory.is_some() {
            return Err(GpuError::OutOfMemory { during });
        }
        match validation.or(internal) {
            Some(error) => {
                // What a lost device makes is invalid, and its refusals hide the cause; only polling brings word of it.
                let _ = self.poll(wgpu::PollType::Poll);
                self.alive(during)?;
                Err(GpuError::Refused { during, message: plain(&error.to_string()) })
            }
            None => Ok(result),
        }
    }

    /// Nothing while the device lives and no error has gone astray.
    pub fn alive(&self, during: &'static str) -> Result<(), GpuError> {
        if let Some(reason) = &*self.lost.lock().unwrap_or_else(PoisonError::into_inner) {
            return Err(GpuError::Lost { during, reason: reason.clone() });
        }
        match self.stray.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(message) => Err(GpuError::Refused { during, message: plain(&message) }),
            None => Ok(()),
        }
    }

    /// Submits commands and returns their place in the queue.
    pub fn submit(
        &self,
        during: &'static str,
        encoder: wgpu::CommandEncoder,
    ) -> Result<wgpu::SubmissionIndex, GpuError> {
        self.guarded(during, || self.queue.submit([encoder.finish()]))
    }

    /// Puts a remark among the commands, where these are written down.
    pub(crate) fn mark(&self, mark: Mark) -> Result<(), GpuError> {
        if !self.records {
            return Ok(());
        }
        let encoder = self.guarded("marking", || {
            let mut encoder = self.wgpu.create_command_encoder(&Default::default());
            encoder.insert_debug_marker(&mark.to_string());
            encoder
        })?;
        self.submit("marking", encoder).map(|_| ())
    }

    /// Waits until a submission, or the latest one, is done.
    pub fn wait(&self, during: &'static str, submission_index: Option<wgpu::SubmissionIndex>) -> Result<(), GpuError> {
        let polled = self.poll(wgpu::PollType::Wait { submission_index, timeout: Some(GREATEST_WAIT) });
        self.alive(during)?;
        match polled {
            Some(Ok(_)) => Ok(()),
            Some(Err(wgpu::PollError::Timeout)) => Err(GpuError::Timeout { during, limit: GREATEST_WAIT }),
            Some(Err(error)) => Err(GpuError::Refused { during, message: error.to_string() }),
            None => Err(GpuError::Lost { during, reason: "polling failed".to_owned() }),
        }
    }

    /// `None` where wgpu panics: its `poll` has no other answer to a device lost meanwhile.
    fn poll(&self, poll: wgpu::PollType) -> Option<Result<wgpu::PollStatus, wgpu::PollError>> {
        catch_unwind(AssertUnwindSafe(|| self.wgpu.poll(poll))).ok()
    }
}

fn fill(slot: &Mutex<Option<String>>, message: String) {
    slot.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(message);
}

/// wgpu's message without the heading that all of them carry.
pub(crate) fn plain(message: &str) -> String {
    message.trim_start_matches("Validation Error").trim_start().trim_start_matches("Caused by:").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SOFTWARE_DRIVER, remedy};

    fn adapter(name: &str, kind: AdapterKind) -> (AdapterInfo, ()) {
        let text = String::new;
        let info = AdapterInfo {
            name: name.to_owned(),
            vendor: 0,
            kind,
            driver: text(),
            driver_info: text(),
            backend: text(),
        };
        (info, ())
    }

    #[test]
    fn without_any_adapter_the_message_tells_how_to_install_one() {
        let error = choose::<()>(vec![], None).unwrap_err();
        assert_eq!(error, GpuError::NoAdapter);
        assert!(error.to_string().contains(&remedy(std::env::consts::OS)), "{error}");
    }

    #[test]
    fn each_platform_is_told_of_its_own_driver() {
        let words =
            [("linux", SOFTWARE_DRIVER), ("macos", "Metal"), ("windows", "Direct3D 12"), ("freebsd", "Vulkan driver")];
        for (platform, word) in words {
            assert!(remedy(platform).contains(word), "{platform}: {}", remedy(platform));
            let is_debian = remedy(platform).contains("apt-get");
            assert_eq!(is_debian, platform == "linux", "{platform}");
        }
    }

    #[test]
    fn an_adapter_is_chosen_by_part_of_its_name_or_else_the_first() {
        let all = || vec![adapter("NVIDIA H200", AdapterKind::Discrete), adapter("llvmpipe", AdapterKind::Software)];
        assert_eq!(choose(all(), None).unwrap().0.name, "NVIDIA H200");
        assert_eq!(choose(all(), Some("LLVM")).unwrap().0.name, "llvmpipe");
        let error = choose(all(), Some("radeon")).unwrap_err();
        assert!(error.to_string().contains("NVIDIA H200, llvmpipe"), "{error}");
    }

    #[test]
    fn hardware_comes_before_software() {
        let mut kinds = [AdapterKind::Software, AdapterKind::Virtual, AdapterKind::Discrete, AdapterKind::Integrated];
        kinds.sort();
        assert_eq!(kinds[0], AdapterKind::Discrete);
        assert_eq!(kinds[3], AdapterKind::Software);
    }
    #[test]
    fn a_lost_device_is_an_error_and_no_panic() {
        let device = Device::open(Some("llvmpipe")).unwrap();
        let buffer = device.storage("before", &[0; 64]).unwrap();
        device.wgpu.destroy();
        let mut out = [0; 64];
        let error = device.read_buffer("reading", &buffer, 0, &mut out).unwrap_err();
        assert!(matches!(error, GpuError::Lost { .. }), "{error}");
        let error = device.storage("after", &[0; 64]).unwrap_err();
        assert!(matches!(error, GpuError::Lost { .. }), "{error}");
    }

    #[test]
    fn a_refusal_is_returned_and_the_device_goes_on() {
        let device = Device::open(Some("llvmpipe")).unwrap();
        let too_large = wgpu::BufferDescriptor {
            label: None,
            size: u64::MAX / 2,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        };
        let error = device.guarded("trying", || device.wgpu.create_buffer(&too_large)).unwrap_err();
        assert!(matches!(error, GpuError::Refused { during: "trying", .. }), "{error}");
        assert!(device.storage("after", &[0; 64]).is_ok());
        // Outside any scope an error waits for the next call.
        drop(device.wgpu.create_buffer(&too_large));
        assert!(matches!(device.storage("later", &[0; 64]), Err(GpuError::Refused { .. })));
        assert!(device.storage("at last", &[0; 64]).is_ok());
    }
}
