//! Units and uncertainty of a representation context.

use super::fault::{Fault, fault};
use super::p21::{Instances, MISSING};
use super::text::decode;
use super::value::Parameters;
use crate::document::Unit;

/// How deep units may be converted into others.
const DEEPEST: usize = 8;

/// Why an uncertainty is not taken.
const NO_UNCERTAINTY: &str = "it is no uncertainty of lengths: none is taken";

/// What is measured: its SI unit without a prefix, as files write it, and the size of that here.
type Measured = (&'static str, f64);

/// In millimetres.
const LENGTH: Measured = ("METRE", 1e3);

/// In radians.
const ANGLE: Measured = ("RADIAN", 1.0);

/// What a representation context says.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Units {
    /// `None` where it names no unit of length.
    pub length: Option<Unit>,
    /// Radians.
    pub angle: f64,
    /// In units of length; 0 where it names none.
    pub uncertainty: f64,
    /// What of it makes no sense, and is taken as if it were not there.
    pub faults: Vec<Fault>,
}

impl Units {
    /// Those of a context; radians and no unit of length where it does not say.
    pub fn of_context(instances: &Instances, context: Option<u64>) -> Self {
        let mut units = Self { length: None, angle: 1.0, uncertainty: 0.0, faults: vec![] };
        let Some(number) = context else { return units };
        let Some(entity) = instances.get(number) else {
            units.faults.push(fault(number, format!("{MISSING}: no unit is taken")));
            return units;
        };
        let list = |keyword: &str, faults: &mut Vec<Fault>| {
            let listed = entity.part(keyword).map_or(Ok(vec![]), |part| part.references(0));
            listed.unwrap_or_else(|cause| {
                faults.push(fault(number, format!("of {keyword} {}: none is taken", cause.why)));
                vec![]
            })
        };
        for unit in list("GLOBAL_UNIT_ASSIGNED_CONTEXT", &mut units.faults) {
            let Some(found) = instances.get(unit) else {
                units.faults.push(fault(unit, "it is no unit that is known: none is taken"));
                continue;
            };
            if found.is("LENGTH_UNIT") {
                let length = unit_of(instances, unit, LENGTH, 0).map(|(name, millimetres)| Unit { name, millimetres });
                if length.is_none() {
                    units.faults.push(fault(unit, "it is no unit of length that is known: none is taken"));
                }
                if length.is_some() && units.length.is_some() && length != units.length {
                    units.faults.push(fault(unit, "its context names another unit of length, too: this one is taken"));
                }
                units.length = length;
            } else if found.is("PLANE_ANGLE_UNIT") {
                let angle = unit_of(instances, unit, ANGLE, 0);
                if angle.is_none() {
                    units.faults.push(fault(unit, "it is no unit of angles that is known: radians are taken"));
                }
                units.angle = angle.map_or(1.0, |(_, radians)| radians);
            }
        }
        if units.length.is_none() && units.faults.is_empty() {
            units.faults.push(fault(number, "it names no unit of length: none is taken"));
        }
        for measure in list("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT", &mut units.faults) {
            let Some(entity) = instances.get(measure) else {
                units.faults.push(fault(measure, NO_UNCERTAINTY));
                continue;
            };
            let own = entity.part("UNCERTAINTY_MEASURE_WITH_UNIT").or(entity.part("MEASURE_WITH_UNIT"));
            let own = own.and_then(|own| Some((own.number(0).ok(), own.reference(1).ok()?)));
            let Some((value, unit)) = own else {
                units.faults.push(fault(measure, NO_UNCERTAINTY));
                continue;
            };
            // Others are of angles.
            if instances.get(unit).is_some_and(|unit| !unit.is("LENGTH_UNIT")) {
                continue;
            }
            let millimetres = unit_of(instances, unit, LENGTH, 0).map(|(_, millimetres)| millimetres);
            let own_unit = units.length.as_ref().map(|length| length.millimetres).or(millimetres);
            let known = value.zip(millimetres).zip(own_unit).map(|((value, own), whole)| value * (own / whole));
            match known.filter(|known| 0.0 <= *known && known.is_finite()) {
                Some(known) => units.uncertainty = units.uncertainty.max(known),
                None => units.faults.push(fault(measure, NO_UNCERTAINTY)),
            }
        }
        units
    }
}

/// A unit's name, in lower case, and its size; `None` where that is not above 0, or it measures something else.
fn unit_of(instances: &Instances, number: u64, measured: Measured, depth: usize) -> Option<(String, f64)> {
    let entity = instances.get(number).filter(|_| depth < DEEPEST)?;
    let (name, size) = if let Some(si) = entity.part("SI_UNIT") {
        let si = if entity.parts.len() == 1 { si.from(1) } else { si };
        prefixed(si, measured)?
    } else {
        let own = entity.part("CONVERSION_BASED_UNIT")?;
        let own = if entity.parts.len() == 1 { own.from(1) } else { own };
        let name = decode(own.text(0)?).to_lowercase();
        let factor = instances.get(own.reference(1).ok()?)?;
        let factor = factor.parameters();
        let (_, unit) = unit_of(instances, factor.reference(1).ok()?, measured, depth + 1)?;
        (name, factor.number(0).ok()? * unit)
    };
    (0.0 < size && size.is_finite()).then_some((name, size))
}

/// An SI unit with its prefix.
fn prefixed(si: Parameters, (unit, base): Measured) -> Option<(String, f64)> {
    const PREFIXES: [(&str, f64); 16] = [
        ("EXA", 1e18),
        ("PETA", 1e15),
        ("TERA", 1e12),
        ("GIGA", 1e9),
        ("MEGA", 1e6),
        ("KILO", 1e3),
        ("HECTO", 1e2),
        ("DECA", 1e1),
        ("DECI", 1e-1),
        ("CENTI", 1e-2),
        ("MILLI", 1e-3),
        ("MICRO", 1e-6),
        ("NANO", 1e-9),
        ("PICO", 1e-12),
        ("FEMTO", 1e-15),
        ("ATTO", 1e-18),
    ];
    let name = si.word(1).filter(|name| *name == unit)?.to_lowercase();
    let Some(prefix) = si.word(0) else { return Some((name, base)) };
    let (_, size) = PREFIXES.iter().find(|(own, _)| *own == prefix)?;
    Some((format!("{}{name}", prefix.to_lowercase()), base * size))
}
