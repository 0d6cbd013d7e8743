//! What a STEP file says around its shape: header, product, units and uncertainty.

use super::text::{Text, real, string};
use formats::Unit;

/// The file's head, up to its instances.
pub(super) fn header(name: &str) -> String {
    format!(
        "ISO-10303-21;\nHEADER;\n\
         FILE_DESCRIPTION(('NURBS surfaces with their trims as PCURVEs, bit for bit'),'2;1');\n\
         FILE_NAME({},'',(''),(''),'isophote {}','isophote','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\n\
         ENDSEC;\nDATA;\n",
        string(name),
        env!("CARGO_PKG_VERSION")
    )
}

/// The file's end, behind its instances.
pub(super) const FOOTER: &str = "ENDSEC;\nEND-ISO-10303-21;\n";

/// What a shape refers to.
pub(super) struct Product {
    /// PRODUCT_DEFINITION_SHAPE.
    pub shape: u64,
    /// The context of what is in space.
    pub space: u64,
    /// The context of curves in parameters.
    pub parameters: u64,
}

/// Adds the product and its contexts, of a model in `unit`, or in millimetres where it has none.
pub(super) fn product(text: &mut Text, name: &str, unit: Option<&Unit>, uncertainty: f64) -> Product {
    let name = string(name);
    let application = text.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')");
    text.add(&format!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{application})"
    ));
    let context = text.add(&format!("PRODUCT_CONTEXT('',#{application},'mechanical')"));
    let product = text.add(&format!("PRODUCT({name},{name},'',(#{context}))"));
    let formation = text.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
    let context = text.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"));
    let definition = text.add(&format!("PRODUCT_DEFINITION('design','',#{formation},#{context})"));
    let shape = text.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
    let length = length(text, unit);
    let angle = text.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
    let solid = text.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
    let uncertainty = text.add(&format!(
        "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#{length},'distance_accuracy_value','confusion accuracy')",
        real(uncertainty)
    ));
    let space = text.add(&format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{uncertainty}))\
         GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid}))REPRESENTATION_CONTEXT('','3D'))"
    ));
    let parameters = text
        .add("(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()REPRESENTATION_CONTEXT('','2D'))");
    Product { shape, space, parameters }
}

/// SI prefixes of metres, by the names that readers of ours give units.
const METRES: [(&str, &str); 7] = [
    ("millimetre", ".MILLI."),
    ("centimetre", ".CENTI."),
    ("decimetre", ".DECI."),
    ("metre", "$"),
    ("kilometre", ".KILO."),
    ("micrometre", ".MICRO."),
    ("nanometre", ".NANO."),
];

fn length(text: &mut Text, unit: Option<&Unit>) -> u64 {
    let mut si = |prefix: &str| text.add(&format!("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({prefix},.METRE.))"));
    let Some(unit) = unit else { return si(".MILLI.") };
    let name = unit.name.to_lowercase();
    if let Some((_, prefix)) = METRES.iter().find(|(own, _)| *own == name) {
        return si(prefix);
    }
    let millimetre = si(".MILLI.");
    let factor = real(unit.millimetres);
    let exponents = text.add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)");
    let measure = text.add(&format!("LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({factor}),#{millimetre})"));
    let name = string(&unit.name.to_uppercase());
    text.add(&format!("(CONVERSION_BASED_UNIT({name},#{measure})LENGTH_UNIT()NAMED_UNIT(#{exponents}))"))
}
