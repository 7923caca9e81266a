//! Front end: a controller variant of the command line, `pdcc:modulation=pair,advance=1.5`.

use super::ast::{Field, Section, SpecAst, Value};
use super::value::parse_value;
use crate::diagnostics::{Collector, Diagnostics, Location, catalogue};

/// Lays a controller variant over the controller of `ast`. Values carry their units attached
/// (`commutation_threshold=0.5A`); a controller of another kind replaces the whole controller.
///
/// # Errors
/// If the text has not the shape `name:key=value,key=value`. Unreadable values are kept in the
/// tree and come with [`super::check`].
pub fn apply_variant(ast: &mut SpecAst, variant: &str) -> Result<(), Diagnostics> {
    let mut errors = Collector::new();
    let at = |offset: usize| Location::Variant {
        text: variant.to_owned(),
        column: variant.get(..offset).unwrap_or(variant).chars().count() + 1,
    };
    let (kind, options) = variant.split_once(':').unwrap_or((variant, ""));
    let mut section = Section {
        location: Some(at(0)),
        ..Section::default()
    };
    match parse_value("kind", kind, &at(0)) {
        Value::Word(word) => section.fields.push(Field {
            name: "kind".to_owned(),
            name_location: at(0),
            value: Value::Word(word),
            location: at(0),
            assumed: None,
        }),
        _ => errors.push(catalogue::variant_syntax(&at(0), kind)),
    }
    let mut start = kind.len() + 1;
    for option in options.split(',').filter(|_| !options.is_empty()) {
        match option.split_once('=') {
            Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
                let location = at(start + name.len() + 1);
                let name = name.trim();
                section.fields.push(Field {
                    name: name.to_owned(),
                    name_location: at(start),
                    value: parse_value(name, value, &location),
                    location,
                    assumed: None,
                });
            }
            _ => errors.push(catalogue::variant_syntax(&at(start), option)),
        }
        start += option.len() + 1;
    }
    errors.into_result(())?;
    ast.controller.overlay_controller(section);
    Ok(())
}
