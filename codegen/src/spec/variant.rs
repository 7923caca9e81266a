//! Front end: a controller variant of the command line, `pdcc:modulation=pair,advance=1.5`.

use super::ast::{Field, Section, SpecAst, Value};
use super::fields;
use super::value::parse_value;
use crate::diagnostics::{Collector, Diagnostics, Location, catalogue};

/// Applies a controller variant to the controller of `ast`. Values have their units attached
/// (`commutation_threshold=0.5A`); a controller of another kind replaces the whole controller.
///
/// # Errors
/// If the text does not have the form `name:key=value,key=value`. Unreadable values are kept in the
/// tree and reported by [`super::check`].
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
    match parse_value(fields::field("kind"), kind, &at(0)) {
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
                    value: parse_value(fields::field(name), value, &location),
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

/// The controller of `ast` with its options in the form of [`apply_variant`], in the order in which
/// they were written. A listed switching table is shown, but no variant can give it.
pub fn variant_of(ast: &SpecAst) -> String {
    let written = |field: &Field| {
        let value = field.value.to_string();
        value.split_whitespace().collect::<String>()
    };
    let (kinds, options): (Vec<&Field>, Vec<&Field>) = ast
        .controller
        .fields
        .iter()
        .partition(|field| field.name == "kind");
    let kind = kinds.first().map_or_else(String::new, |kind| written(kind));
    let options: Vec<String> = options
        .iter()
        .map(|option| format!("{}={}", option.name, written(option)))
        .collect();
    if options.is_empty() {
        kind
    } else {
        format!("{kind}:{}", options.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::{apply_variant, variant_of};
    use crate::spec::parse_toml;

    #[test]
    fn a_controller_is_named_as_it_is_given() {
        for variant in [
            "pdcc",
            "pdcc:saturation=nearest,emf=model,advance=1.5",
            "pi-pwm:bandwidth=800Hz,integral_time=0.5ms,word=16",
        ] {
            let mut ast = parse_toml("", "hub.toml").expect("is TOML");
            apply_variant(&mut ast, variant).expect("is a variant");
            assert_eq!(variant_of(&ast), variant);
        }
        let file = "[controller]\nkind = \"pi-pwm\"\nbandwidth = \"800 Hz\"\nword = 16\n";
        let mut ast = parse_toml(file, "hub.toml").expect("is TOML");
        assert_eq!(variant_of(&ast), "pi-pwm:bandwidth=800Hz,word=16");
        // Options that a variant does not name stay those of the file.
        apply_variant(&mut ast, "pi-pwm:word=32").expect("is a variant");
        assert_eq!(variant_of(&ast), "pi-pwm:bandwidth=800Hz,word=32");
    }
}
