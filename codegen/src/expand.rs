//! The macro's way through the pipeline: tokens in, tokens out, errors as `compile_error!`.
//!
//! On errors the type still appears in its empty shape, with every method and constant, so that
//! the compiler reports what is wrong with the specification and nothing that follows from it.

use crate::diagnostics::Diagnostics;
use crate::emit::rust::{Surface, emit_rust, module_name};
use crate::interface::Interface;
use crate::ir::{Function, FunctionBuilder, Interval, Program, verify};
use crate::pipeline::{Generated, generate};
use crate::spec::ast::Value;
use crate::spec::{MacroInput, MotorFile, SpecAst, check, parse_macro, parse_toml};
use proc_macro2::{Ident, TokenStream};
use quote::{ToTokens, quote};
use std::path::Path;

/// Expands `controller! { pub HubDrive { … } }`; motor files are found under `root`, the folder of
/// the crate that makes the call.
pub fn expand_controller(tokens: TokenStream, root: &Path) -> TokenStream {
    let input = match parse_macro(tokens) {
        Ok(input) => input,
        Err(errors) => return errors.to_compile_errors(&TokenStream::new()),
    };
    let surface = surface(&input);
    match generate_input(&input, root) {
        Ok(Generated { graph, interface }) => {
            let tracking = input.motor_file.iter().map(track);
            let code = emit_rust(&graph, &interface, &surface);
            quote!(#code #(#tracking)*)
        }
        Err(errors) => {
            let errors = errors.to_compile_errors(&input.anchor());
            let tracking = input
                .motor_file
                .iter()
                .filter(|file| root.join(file.path.value()).is_file())
                .map(track);
            let shape = empty_shape(&input.ast, &surface);
            quote!(#errors #shape #(#tracking)*)
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

fn generate_input(input: &MacroInput, root: &Path) -> Result<Generated, Diagnostics> {
    let ast = input.load(root)?;
    let (spec, origins) = check(&ast)?;
    generate(&spec, &origins)
}

fn surface(input: &MacroInput) -> Surface {
    let (docs, others): (Vec<_>, Vec<_>) = input
        .attributes
        .iter()
        .partition(|attribute| attribute.path().is_ident("doc"));
    Surface {
        name: input.name.clone(),
        visibility: input.visibility.to_token_stream(),
        attributes: quote!(#(#others)*),
        type_attributes: quote!(#(#docs)*),
    }
}

/// Makes the compiler rebuild the crate when the motor file changes. The path stays relative to
/// the crate, so that the output is the same wherever it lies.
fn track(file: &MotorFile) -> TokenStream {
    let path = &file.path;
    quote! {
        const _: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/", #path));
    }
}

/// The type without a controller in it: its step turns all legs off.
fn empty_shape(ast: &SpecAst, surface: &Surface) -> TokenStream {
    let is = |section: &crate::spec::ast::Section, field: &str, word: &str| {
        section
            .field(field)
            .is_some_and(|field| matches!(&field.value, Value::Word(given) if given == word))
    };
    let timer_capture = is(&ast.controller, "hall_capture", "timer");
    let measured_bus = is(&ast.inverter, "v_bus", "measured");
    let interface = Interface {
        type_name: surface.name.to_string(),
        doc: vec!["Not generated: the specification has errors.".to_owned()],
        header: vec!["Empty shape of a drive whose specification has errors.".to_owned()],
        timer_capture,
        measured_bus,
        ..exemplary_interface()
    };
    match verify(empty_program(&interface)) {
        Ok(graph) => emit_rust(&graph, &interface, surface),
        // Cannot happen; the errors themselves are reported in any case.
        Err(_) => TokenStream::new(),
    }
}

/// An interface with every constant that a drive has; their values are those of another motor and
/// are never seen, since the crate does not compile.
fn exemplary_interface() -> Interface {
    let generated = parse_toml(include_str!("example.toml"), "example.toml").and_then(|ast| {
        let (spec, origins) = check(&ast)?;
        generate(&spec, &origins)
    });
    match generated {
        Ok(Generated { interface, .. }) => interface,
        Err(_) => Interface {
            type_name: String::new(),
            doc: vec![],
            header: vec![],
            spec_toml: String::new(),
            formats: vec![],
            constants: vec![],
            timer_capture: false,
            measured_bus: false,
            calibration_samples: 1,
            precharge_periods: 0,
        },
    }
}

/// Inputs and setters of a drive, and nothing between them.
fn empty_program(interface: &Interface) -> Program {
    let mut program = Program::new(&interface.type_name);
    program.param("j", 0, Interval::point(0), "No set-point.");
    let mut step = Function::new("step", &["All legs off."]);
    let inputs: &[&str] = if interface.timer_capture {
        &["_adc_a", "_adc_b", "_hall", "_hall_ticks"]
    } else {
        &["_adc_a", "_adc_b", "_hall"]
    };
    for name in inputs {
        step.inputs.push(crate::ir::Input {
            name: (*name).to_owned(),
            interval: Interval::new(0, i64::from(u16::MAX)),
            doc: String::new(),
        });
    }
    program.step = step;
    let setters: &[&str] = if interface.measured_bus {
        &["set_current", "set_torque", "set_bus"]
    } else {
        &["set_current", "set_torque"]
    };
    for name in setters {
        let setter = FunctionBuilder::new(&mut program, name, &["Does nothing."]).finish();
        program.setters.push(setter);
    }
    program
}
