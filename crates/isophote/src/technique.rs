//! Techniques on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use techniques::Technique;

/// The default technique's name.
pub fn default() -> &'static str {
    techniques::ALL[0].name()
}

/// Takes a technique by its name.
pub fn parser() -> impl TypedValueParser<Value = &'static dyn Technique> {
    let value = |technique: &&dyn Technique| PossibleValue::new(technique.name()).help(technique.about());
    let named = |name: String| techniques::named(&name).expect("only their names are possible");
    PossibleValuesParser::new(techniques::ALL.iter().map(value)).map(named)
}
