//! The functions that stand in the place of operators, by name.

use naga::{Function, Handle, Module};
use std::collections::HashMap;

/// Functions of a module by their names.
pub struct Calls(HashMap<String, Handle<Function>>);

impl Calls {
    /// Those of a module.
    pub fn of(module: &Module) -> Self {
        Self(module.functions.iter().filter_map(|(handle, function)| Some((function.name.clone()?, handle))).collect())
    }

    /// The function that is called in an operator's place.
    ///
    /// # Errors
    /// Where the module has none of that name.
    pub fn get(&self, name: &str) -> Result<Handle<Function>, String> {
        self.0.get(name).copied().ok_or_else(|| format!("a strict program lacks {name}"))
    }
}
