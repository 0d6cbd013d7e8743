//! Materials of an archive, as far as they colour surfaces.

use super::archive::{Cursor, Fault, code};
use super::class::{Class, Object};
use crate::document::Colour;

/// What is written of a component from version 60 on: identifier, index and name. The bits are openNURBS'.
const ID_INDEX_NAME: i32 = 13;

/// A material.
pub(super) struct Material {
    /// By which layers and objects name it.
    pub index: i32,
    /// Of its diffuse light.
    pub colour: Colour,
}

impl Material {
    /// Reads a record; `place` is the material's number in its table, which counts where the record states none.
    pub fn read(mut record: Cursor, place: usize) -> Result<Self, Fault> {
        let object = Object::read(&mut record)?;
        let mut data = object.data.clone();
        if object.class != Class::Material {
            return data.fault(format!("{} stands where a material should", object.kind()));
        }
        let is_packed = data.next_code() != Some(code::ANONYMOUS);
        let mut index = i32::try_from(place).unwrap_or(i32::MAX);
        // Before version 4 it begins with the colours.
        if is_packed && data.clone().u8()? >> 4 == 1 {
            data.packed_version(1)?;
        } else {
            if is_packed {
                data.packed_version(2)?;
            }
            data = data.content(code::ANONYMOUS)?;
            data.version(1)?;
            if is_packed {
                data.uuid()?;
                index = data.i32()?;
                data.string()?;
            } else {
                let mut common = data.content(code::ANONYMOUS)?;
                common.version(1)?;
                let parts = common.i32()?;
                if parts != ID_INDEX_NAME {
                    return common.fault(format!("it has parts {parts}, where {ID_INDEX_NAME} are known"));
                }
                common.uuid()?;
                index = common.i32()?;
            }
            // A plug-in.
            data.uuid()?;
        }
        // Of ambient light.
        data.colour()?;
        Ok(Self { index, colour: data.colour()? })
    }
}
