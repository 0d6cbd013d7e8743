//! Units and uncertainty of a representation context.

use super::fault::{Fault, fault};
use super::p21::Instances;
use super::text::decode;
use super::value::Parameters;
use crate::document::Unit;

/// How deep units may be converted into others.
const DEEPEST: usize = 8;

/// Why an uncertainty is not taken.
const NO_UNCERTAINTY: &str = "it is no uncertainty of lengths: none is taken";

/// Millimetres.
const METRE: f64 = 1e3;

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
        let Some(entity) = context.and_then(|context| instances.get(context)) else { return units };
        let list = |keyword: &str| {
            let part = entity.part(keyword);
            part.and_then(|part| part.references(0).ok()).unwrap_or_default()
        };
        for unit in list("GLOBAL_UNIT_ASSIGNED_CONTEXT") {
            let Some(found) = instances.get(unit) else {
                units.faults.push(fault(unit, "it is no unit that is known: none is taken"));
                continue;
            };
            if found.is("LENGTH_UNIT") {
                units.length = unit_of(instances, unit, METRE, 0).map(|(name, millimetres)| Unit { name, millimetres });
                if units.length.is_none() {
                    units.faults.push(fault(unit, "it is no unit of length that is known: none is taken"));
                }
            } else if found.is("PLANE_ANGLE_UNIT") {
                let angle = unit_of(instances, unit, 1.0, 0);
                if angle.is_none() {
                    units.faults.push(fault(unit, "it is no unit of angles that is known: radians are taken"));
                }
                units.angle = angle.map_or(1.0, |(_, radians)| radians);
            }
        }
        for measure in list("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT") {
            let Some(entity) = instances.get(measure) else {
                units.faults.push(fault(measure, NO_UNCERTAINTY));
                continue;
            };
            let own = entity.part("UNCERTAINTY_MEASURE_WITH_UNIT").or(entity.part("MEASURE_WITH_UNIT"));
            let own = own.and_then(|own| Some((own.number(0).ok(), own.reference(1).ok()?)));
            let Some((value, unit)) = own.filter(|(_, unit)| instances.get(*unit).is_some_and(|e| e.is("LENGTH_UNIT")))
            else {
                continue;
            };
            let millimetres = unit_of(instances, unit, METRE, 0).map(|(_, millimetres)| millimetres);
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

/// A unit's name, in lower case, and its size, where the SI unit without a prefix has size `base`; `None` where that is not
/// above 0.
fn unit_of(instances: &Instances, number: u64, base: f64, depth: usize) -> Option<(String, f64)> {
    let entity = instances.get(number).filter(|_| depth < DEEPEST)?;
    let (name, size) = if let Some(si) = entity.part("SI_UNIT") {
        let si = if entity.parts.len() == 1 { si.from(1) } else { si };
        prefixed(si, base)?
    } else {
        let own = entity.part("CONVERSION_BASED_UNIT")?;
        let own = if entity.parts.len() == 1 { own.from(1) } else { own };
        let name = decode(own.text(0)?).to_lowercase();
        let factor = instances.get(own.reference(1).ok()?)?;
        let factor = factor.parameters();
        let (_, unit) = unit_of(instances, factor.reference(1).ok()?, base, depth + 1)?;
        (name, factor.number(0).ok()? * unit)
    };
    (0.0 < size && size.is_finite()).then_some((name, size))
}

/// An SI unit with its prefix.
fn prefixed(si: Parameters, base: f64) -> Option<(String, f64)> {
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
    let name = si.word(1)?.to_lowercase();
    let Some(prefix) = si.word(0) else { return Some((name, base)) };
    let (_, size) = PREFIXES.iter().find(|(own, _)| *own == prefix)?;
    Some((format!("{}{name}", prefix.to_lowercase()), base * size))
}
