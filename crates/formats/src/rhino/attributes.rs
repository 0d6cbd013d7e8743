//! What an object says of itself beside its shape: name, layer, whether it is shown, and where colour and material come from.

use super::archive::{Cursor, Fault, Uuid};
use crate::document::Colour;

/// What an object says of itself beside its shape.
#[derive(Debug, Clone, Default)]
pub(super) struct Attributes {
    pub id: Option<Uuid>,
    pub name: String,
    pub layer: i32,
    pub is_hidden: bool,
    /// Whether it is a part of a block, and not drawn where it is.
    pub is_in_block: bool,
    /// Whether it is on a page of a layout, not in space.
    pub is_on_page: bool,
    /// Its own colour; whether that counts, its source says.
    pub colour: Option<Colour>,
    pub colour_source: u8,
    /// The number of its own material, below 0 for none; whether that counts, its source says.
    pub material: i32,
    pub material_source: u8,
}

/// Where an object's colour comes from, as numbered in the file.
pub(super) mod colour_source {
    pub const LAYER: u8 = 0;
    pub const OBJECT: u8 = 1;
    pub const MATERIAL: u8 = 2;
    pub const PARENT: u8 = 3;
}

/// Where an object's material comes from, as numbered in the file; 0 is its layer.
pub(super) mod material_source {
    pub const OBJECT: u8 = 1;
    pub const PARENT: u8 = 3;
}

/// How an object is drawn, and with it what a reference places.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    pub colour: Option<Colour>,
    /// The number of its material, below 0 for none.
    pub material: Option<i32>,
}

/// How an object is shown, as numbered in the file: the low four bits of its mode.
mod mode {
    pub const MASK: u8 = 15;
    pub const HIDDEN: u8 = 1;
    pub const IN_BLOCK: u8 = 3;
}

impl Attributes {
    /// Reads them in either of two layouts.
    pub fn read(mut data: Cursor) -> Result<Self, Fault> {
        match data.clone().u8()? >> 4 {
            1 => Self::in_order(&mut data),
            _ => Self::by_items(&mut data),
        }
    }

    /// Before version 50: everything, in order.
    fn in_order(data: &mut Cursor) -> Result<Self, Fault> {
        let minor = data.packed_version(1)?;
        let mut attributes = Self { id: Some(data.uuid()?), layer: data.i32()?, material: -1, ..Self::default() };
        attributes.material = data.i32()?;
        attributes.colour = Some(data.colour()?);
        // An obsolete line style, wire density.
        data.skip(2 * 2 + 2 * 8 + 4)?;
        attributes.set_mode(data.u8()?);
        attributes.colour_source = data.u8()?;
        // Where the line comes from.
        data.skip(1)?;
        attributes.material_source = data.u8()?;
        attributes.name = data.string()?;
        if minor >= 2 {
            // An address, and groups.
            data.string()?;
            data.indices()?;
            attributes.is_hidden |= data.u8()? == 0;
        }
        Ok(attributes)
    }

    /// From version 50 on: items by their number, ascending; those with their usual value are not there.
    fn by_items(data: &mut Cursor) -> Result<Self, Fault> {
        data.packed_version(2)?;
        let mut attributes = Self { id: Some(data.uuid()?), layer: data.i32()?, material: -1, ..Self::default() };
        loop {
            match data.u8()? {
                1 => attributes.name = data.string()?,
                2 => {
                    data.string()?;
                }
                3 | 7 | 10 => {
                    data.skip(4)?;
                }
                4 => attributes.material = data.i32()?,
                6 => attributes.colour = Some(data.colour()?),
                // How it is rendered, in a chunk of its own.
                5 => {
                    data.chunk()?;
                }
                8 => {
                    data.skip(8)?;
                }
                9 | 14 | 15 | 17 => {
                    data.skip(1)?;
                }
                16 => attributes.material_source = data.u8()?,
                13 => attributes.colour_source = data.u8()?,
                11 => attributes.is_hidden |= data.u8()? == 0,
                12 => attributes.set_mode(data.u8()?),
                18 => {
                    data.indices()?;
                }
                19 => attributes.is_on_page = data.u8()? == 1,
                // The end, or items that say nothing of whether it is drawn.
                _ => return Ok(attributes),
            }
        }
    }

    fn set_mode(&mut self, mode: u8) {
        self.is_hidden |= mode & mode::MASK == mode::HIDDEN;
        self.is_in_block |= mode & mode::MASK == mode::IN_BLOCK;
    }
}
