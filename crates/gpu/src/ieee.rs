//! A program whose arithmetic on floats is IEEE 754's, whatever a compiler and an adapter make of WGSL's operators: sums and
//! products rounded once each, in the order in which they are written, quotients and roots rounded correctly, numbers below the
//! least normal one kept. So a program returns the bits that its twin in Rust does.
//!
//! naga reads the program, [`function`] puts calls of the functions of `shaders/raster/ieee.wgsl` in the place of its operators,
//! and naga writes WGSL again, so that each host gets the same text. A program must have `raster/strict.wgsl` among its parts.

mod calls;
mod function;

use crate::GpuError;
use calls::Calls;
use naga::Module;
use naga::back::wgsl::WriterFlags;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

/// What the operators are made of.
const ARITHMETIC: &str = include_str!("../../../shaders/raster/ieee.wgsl");

/// The greatest float as naga writes it, with as few digits as lead back to it: more than it is, which Tint refuses.
const SHORTEST_GREATEST: &str = "340282350000000000000000000000000000000f";

/// The same in full.
const GREATEST: &str = "340282346638528859811704183484516925440f";

/// What is asked of an adapter beside integers: the functions in which its own operators on floats stay, each behind a barrier or, in
/// `guessed`, corrected.
const OWN: [&str; 5] = ["ieee_sum", "ieee_product", "hundred_up", "hundred_down", "guessed"];

/// What a pipeline of a strict program takes: whether it computes subnormal numbers, or raises them.
pub fn constants(subnormals: bool) -> [(&'static str, f64); 1] {
    [("COMPUTES_SUBNORMALS", f64::from(u8::from(subnormals)))]
}

/// The same program in IEEE 754's arithmetic. It must have a function `raise_subnormal`, and its pipelines take [`constants`].
///
/// # Errors
/// [`GpuError::Shader`] where the program is illegal, or holds an operation that has no strict form.
pub fn strict(source: &str) -> Result<String, GpuError> {
    rewritten(source).map_err(|message| GpuError::Shader { program: "strict".to_owned(), entry: "source", message })
}

fn rewritten(source: &str) -> Result<String, String> {
    // Functions stand behind those that they call, also where something is put in later.
    let whole = format!("{ARITHMETIC}{source}");
    let mut module = naga::front::wgsl::parse_str(&whole).map_err(|error| error.emit_to_string(&whole))?;
    let info = checked(&module, &whole)?;
    let calls = Calls::of(&module);
    let handles: Vec<_> = module.functions.iter().map(|(handle, _)| handle).collect();
    for handle in handles {
        let old = module.functions[handle].clone();
        if !old.name.as_deref().is_some_and(|name| OWN.contains(&name)) {
            module.functions[handle] = function::strict(&old, &info[handle], &mut module, &calls)?;
        }
    }
    for i in 0..module.entry_points.len() {
        let old = module.entry_points[i].function.clone();
        module.entry_points[i].function = function::strict(&old, info.get_entry_point(i), &mut module, &calls)?;
    }
    let info = checked(&module, &whole)?;
    let written = naga::back::wgsl::write_string(&module, &info, WriterFlags::empty());
    Ok(written.map_err(|error| error.to_string())?.replace(SHORTEST_GREATEST, GREATEST))
}

fn checked(module: &Module, source: &str) -> Result<ModuleInfo, String> {
    let found = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(module);
    found.map_err(|error| error.emit_to_string(source))
}
