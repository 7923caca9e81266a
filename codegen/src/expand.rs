//! Expansion of the macros: tokens in, tokens out, errors as `compile_error!`, warnings as compiler
//! warnings.
//!
//! Macros write constants by value, which compiles faster; files by name. Macros also refer to what
//! documents the fields, for editors. They differ in nothing else.
//!
//! On errors the type is emitted as an empty shape with every method and constant, so that the
//! compiler reports the errors of the specification only.

use crate::diagnostics::{Anchors, Diagnostic, Diagnostics};
use crate::emit::module_name;
use crate::emit::rust::{Surface, emit_rust, write_rust};
use crate::field_items::references;
use crate::interface::Interface;
use crate::pipeline::{Generated, generate, warnings};
use crate::spec::ast::Value;
use crate::spec::{MacroInput, SpecAst, check, parse_macro, parse_toml};
use crate::stopwatch::Part;
use proc_macro2::{Ident, TokenStream};
use quote::{ToTokens, quote};
use std::path::Path;

/// Expands `controller! { pub HubDrive { … } }`; motor files are found under `root`, the folder of
/// the crate that makes the call.
pub fn expand_controller(tokens: TokenStream, root: &Path) -> TokenStream {
    let input = match Part::Parsing.timed(|| parse_macro(tokens)) {
        Ok(input) => input,
        Err(errors) => return errors.to_compile_errors(&Anchors::default()),
    };
    let surface = surface(&input);
    let (mut files, anchors) = (vec![], input.anchors());
    let generated = generate_input(&input, root, &mut files);
    let fields = references(&input.ast, &surface.attributes);
    let tracking = files.iter().map(|file| track(file));
    match generated {
        Ok((Generated { graph, interface }, warnings)) => {
            let name = surface.name.to_string();
            // A documented constant costs more compile time than its value at every use.
            let graph = graph.without_constant_names();
            let code = Part::Emission.timed(|| write_rust(&graph, &interface, &name));
            // In a macro the compiler itself parses the text.
            let code = code.into_tokens(&surface);
            let warnings = warnings
                .iter()
                .map(|warning| warning.to_compile_warning(&anchors));
            quote!(#code #fields #(#warnings)* #(#tracking)*)
        }
        Err(errors) => {
            let errors = errors.to_compile_errors(&anchors);
            let shape = empty_shape(&input.ast, &surface);
            quote!(#errors #shape #fields #(#tracking)*)
        }
    }
}

/// Expands `verify!(HubDrive, …)`: one test per drive.
pub fn expand_verify(tokens: TokenStream) -> TokenStream {
    use syn::parse::Parser;
    let list = syn::punctuated::Punctuated::<syn::TypePath, syn::Token![,]>::parse_terminated;
    let drives = match list.parse2(tokens) {
        Ok(drives) => drives,
        Err(error) => return error.to_compile_error(),
    };
    let tests = drives.iter().filter_map(|drive| {
        let name = &drive.path.segments.last()?.ident;
        let test = Ident::new(
            &format!("{}_is_bit_true", module_name(&name.to_string())),
            name.span(),
        );
        Some(quote! {
            #[test]
            fn #test() {
                ::hexagen_reference::assert_bit_true::<#drive>();
            }
        })
    });
    quote!(#(#tests)*)
}

fn generate_input(
    input: &MacroInput,
    root: &Path,
    files: &mut Vec<String>,
) -> Result<(Generated, Vec<Diagnostic>), Diagnostics> {
    let (spec, origins) = Part::Parsing.timed(|| check(&input.load(root, files)?))?;
    let generated = generate(&spec, &origins)?;
    let warnings = warnings(&spec, &origins, &generated.interface.times);
    Ok((generated, warnings))
}

fn surface(input: &MacroInput) -> Surface {
    let (docs, others): (Vec<_>, Vec<_>) = input
        .attributes
        .iter()
        .partition(|attribute| attribute.path().is_ident("doc"));
    // What follows is a paragraph of its own.
    let end = (!docs.is_empty()).then(|| quote!(#[doc = ""]));
    Surface {
        name: input.name.clone(),
        visibility: input.visibility.to_token_stream(),
        attributes: quote!(#(#others)*),
        type_attributes: quote!(#(#docs)* #end),
    }
}

/// Makes the compiler rebuild the crate when a motor's or board's file changes. The path is relative
/// to the crate, so that the output does not depend on the crate's place.
fn track(path: &str) -> TokenStream {
    quote! {
        const _: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/", #path));
    }
}

/// The type under the given name, with every trait and constant of its options: the example's
/// drive, which never runs, since the crate does not compile.
fn empty_shape(ast: &SpecAst, surface: &Surface) -> TokenStream {
    let is = |section: &crate::spec::ast::Section, field: &str, word: &str| {
        section
            .field(field)
            .is_some_and(|field| matches!(&field.value, Value::Word(given) if given == word))
    };
    let mut text = include_str!("example.toml").to_owned();
    let mut add = |section: &str, lines: &str| {
        text = text.replacen(section, &format!("{section}\n{lines}"), 1);
    };
    if is(&ast.controller, "hall_capture", "timer") {
        add("[controller]", "hall_capture = \"timer\"");
    }
    if is(&ast.controller, "speed_loop", "on") {
        add("[controller]", "speed_loop = true");
        add("[motor]", "inertia = \"1e-4 kg m2\"");
    }
    if is(&ast.inverter, "v_bus", "measured") {
        let lines = "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"80 V\"";
        add("[inverter]", lines);
    }
    let generated = parse_toml(&text, "example.toml").and_then(|ast| {
        let (spec, origins) = check(&ast)?;
        generate(&spec, &origins)
    });
    match generated {
        Ok(Generated { graph, interface }) => {
            let interface = Interface {
                type_name: surface.name.to_string(),
                doc: vec!["Not generated: the specification has errors.".to_owned()],
                header: vec![],
                ..interface
            };
            let given = &surface.type_attributes;
            let surface = Surface {
                // The name may be invalid.
                type_attributes: quote!(#given #[allow(non_camel_case_types)]),
                ..surface.clone()
            };
            emit_rust(&graph, &interface, &surface)
        }
        // Cannot happen; the errors themselves are reported in any case.
        Err(_) => TokenStream::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::{expand_controller, expand_verify, parse_macro, references};
    use crate::emit::rust::format_rust;
    use crate::{Builder, pipeline};
    use proc_macro2::{Group, TokenStream, TokenTree};
    use quote::{ToTokens, quote};
    use std::collections::HashMap;
    use std::path::Path;

    fn hub(bus: &TokenStream, options: &TokenStream) -> TokenStream {
        quote! {
            pub HubDrive {
                motor: { description: "Trivedi-Keshri 48 V 660 W",
                    pole_pairs: 4, resistance: 135 mohm per_phase, inductance: 0.22 mH per_phase,
                    winding: star, back_emf: 0.1648 V/(rad/s) line_to_line peak, emf_shape: trapezoidal,
                    rated_current: 20 A, rated_torque: 3.3 Nm, rated_speed: 2000 rpm },
                inverter: { bus_voltage: #bus, f_pwm: 20 kHz, timer_clock: 72 MHz, adc_bits: 12,
                    adc_range: 40 A, current_sensing: in_phase,
                    hall_timer_clock: 1 MHz },
                controller: pdcc { #options },
            }
        }
    }

    fn expanded(bus: &TokenStream, options: &TokenStream) -> String {
        format_rust(&expand_controller(hub(bus, options), Path::new("")))
    }

    /// A file's tokens with its private constants by value, as from [`expand_controller`].
    fn with_constants_by_value(file: &str) -> String {
        let mut file = syn::parse_file(file).expect("a Rust file");
        let mut values = HashMap::new();
        for item in &mut file.items {
            let syn::Item::Const(syn::ItemConst { expr, .. }) = item else {
                continue;
            };
            let syn::Expr::Block(syn::ExprBlock { block, .. }) = &mut **expr else {
                continue;
            };
            block.stmts.retain(|statement| match statement {
                syn::Stmt::Item(syn::Item::Const(constant)) => {
                    let value = constant.expr.to_token_stream();
                    values.insert(constant.ident.to_string(), value).is_some()
                }
                _ => true,
            });
        }
        assert!(!values.is_empty(), "no constant in the file");
        format_rust(&replaced(file.to_token_stream(), &values))
    }

    /// Replaces constants by their values, except at definitions: associated constants have the
    /// same names.
    fn replaced(tokens: TokenStream, values: &HashMap<String, TokenStream>) -> TokenStream {
        let mut is_definition = false;
        let replace = |token: TokenTree| {
            let is_defined = std::mem::take(&mut is_definition);
            match token {
                TokenTree::Ident(ident) => {
                    is_definition = ident == "const";
                    let value = values.get(&ident.to_string()).filter(|_| !is_defined);
                    value.cloned().unwrap_or_else(|| ident.into_token_stream())
                }
                TokenTree::Group(group) => {
                    let inner = replaced(group.stream(), values);
                    Group::new(group.delimiter(), inner).into_token_stream()
                }
                token => token.into(),
            }
        };
        tokens.into_iter().map(replace).collect()
    }

    #[test]
    fn macro_and_build_script_differ_in_constants_and_references_to_fields_alone() {
        let folder = std::env::temp_dir().join(format!("hexagen-same-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        std::fs::write(folder.join("hub.toml"), include_str!("example.toml"))
            .expect("a motor file");
        let written = Builder::new()
            .root(&folder)
            .out_dir(&folder)
            .motor("hub.toml")
            .controller("pdcc:emf=model,advance=2")
            .name("HubDrive")
            .generate()
            .expect("the example generates");
        let file = std::fs::read_to_string(&written[0].files[0]).expect("the file is there");
        std::fs::remove_dir_all(&folder).expect("the folder is ours");
        let options = quote!(emf: model, advance: 2);
        // What editors show for the fields of a macro call; no field is in the file.
        let call = parse_macro(hub(&quote!(48 V), &options)).expect("parses");
        let fields = references(&call.ast, &TokenStream::new());
        let file = with_constants_by_value(&file) + "\n" + &format_rust(&fields);
        assert_eq!(file, expanded(&quote!(48 V), &options));
    }

    #[test]
    fn an_erroneous_specification_keeps_the_shape_of_its_type() {
        let right = expanded(&quote!(48 V), &quote!(hall_capture: timer));
        let wrong = expanded(&quote!(48 ohm), &quote!(hall_capture: timer));
        assert_eq!(wrong.matches("compile_error!").count(), 1);
        // The signatures of the public interface, constants without their values.
        let surface = |text: &str| -> Vec<String> {
            let public = |line: &&str| line.trim_start().starts_with("pub ");
            let text = text
                .replace("(\n            ", "(")
                .replace(",\n            ", ", ");
            text.lines()
                .filter(public)
                .map(|line| {
                    line.split(" = ")
                        .next()
                        .unwrap_or(line)
                        .replace(['_', ','], "")
                })
                .collect()
        };
        assert_eq!(surface(&right), surface(&wrong));
    }

    #[test]
    fn expansion_is_deterministic_and_tells_no_place() {
        let options = quote!(modulation: pair);
        let text = expanded(&quote!(48 V), &options);
        assert_eq!(text, expanded(&quote!(48 V), &options));
        assert!(
            !text.contains(env!("CARGO_MANIFEST_DIR")),
            "an absolute path leaks"
        );
    }

    #[test]
    fn files_are_tracked_by_their_places_in_the_crate() {
        let folder = std::env::temp_dir().join(format!("hexagen-track-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        std::fs::write(folder.join("hub.toml"), include_str!("example.toml"))
            .expect("a motor file");
        std::fs::write(
            folder.join("mine.toml"),
            "[inverter]\ndead_time = \"500 ns\"\n",
        )
        .expect("a board's file");
        let expand = |name: &TokenStream| {
            let call =
                quote!(pub #name { motor: "hub.toml", board: "mine.toml", controller: pdcc });
            expand_controller(call, &folder).to_string()
        };
        let text = expand(&quote!(Hub));
        let again = expand(&quote!(Hub));
        std::fs::remove_dir_all(&folder).expect("the folder is ours");
        assert_eq!(text, again);
        assert!(!text.contains("compile_error"), "{text}");
        for file in ["hub.toml", "mine.toml"] {
            let tracking = quote!(include_str!(
                concat!(env!("CARGO_MANIFEST_DIR"), "/", #file)
            ))
            .to_string();
            assert!(text.contains(&tracking), "no tracking of {file}");
        }
        assert!(
            !text.contains(&*folder.to_string_lossy()),
            "an absolute path leaks"
        );
    }

    #[test]
    fn an_absolute_path_is_not_tracked() {
        let file =
            std::env::temp_dir().join(format!("hexagen-absolute-{}.toml", std::process::id()));
        std::fs::write(&file, include_str!("example.toml")).expect("a motor file");
        let path = file.to_string_lossy().into_owned();
        let text = expand_controller(
            quote!(pub Hub { motor: #path, controller: pdcc }),
            &std::env::temp_dir(),
        );
        std::fs::remove_file(&file).expect("the file is ours");
        let text = text.to_string();
        assert!(
            text.contains("HX0108") && !text.contains("include_str"),
            "{text}"
        );
    }

    #[test]
    fn the_example_of_the_empty_shape_generates() {
        let ast =
            crate::spec::parse_toml(include_str!("example.toml"), "example.toml").expect("parses");
        let (spec, origins) = crate::spec::check(&ast).expect("passes the checks");
        pipeline::generate(&spec, &origins).expect("generates");
    }

    #[test]
    fn verify_makes_a_test_per_drive() {
        let text = expand_verify(quote!(HubDrive, motors::Front)).to_string();
        assert!(
            text.contains("fn hub_drive_is_bit_true") && text.contains("fn front_is_bit_true"),
            "{text}"
        );
        assert!(
            expand_verify(quote!(3))
                .to_string()
                .contains("compile_error")
        );
    }
}
