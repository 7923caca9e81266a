//! The procedural macros of hexagen; each forwards to `hexagen-codegen`.

use proc_macro::TokenStream;
use std::env;
use std::path::PathBuf;

/// Emits the current controller of one motor, all coefficients and tables precomputed, as a type
/// for `hexagen::Drive`.
///
/// ```text
/// hexagen::controller! {
///     /// Rear hub drive.
///     pub HubDrive {
///         motor: "motors/hub.toml",
///         inverter: {
///             bus_voltage: 48 V, f_pwm: 20 kHz, timer_clock: 72 MHz, adc_bits: 12, adc_range: 40 A,
///             current_sensing: in_phase,
///         },
///         controller: pdcc { emf: model, advance: 2 },
///     }
/// }
/// ```
///
/// Fields, options and units: `hexagen::specification`. A guide in chapters: `hexagen::guide`.
#[proc_macro]
pub fn controller(tokens: TokenStream) -> TokenStream {
    let root = env::var_os("CARGO_MANIFEST_DIR")
        .map(PathBuf::from)
        .unwrap_or_default();
    hexagen_codegen::expand_controller(tokens.into(), &root).into()
}

/// Tests the crate's own drives bit for bit against the reference model:
/// `hexagen::verify!(HubDrive);` makes a `#[test]` per drive named. Needs `hexagen-reference` among
/// the crate's dev-dependencies.
#[proc_macro]
pub fn verify(tokens: TokenStream) -> TokenStream {
    hexagen_codegen::expand_verify(tokens.into()).into()
}

/// Constants that document the fields of a specification, for editors. Used by the crate `hexagen`.
#[doc(hidden)]
#[proc_macro]
pub fn specification_fields(_: TokenStream) -> TokenStream {
    hexagen_codegen::expand_fields().into()
}

/// Implements `hexagen::State` for a structure of words: names, initial values and access by
/// number. Used by emitted code. The initial value is 0 or the number of `#[initial(…)]`.
#[proc_macro_derive(State, attributes(initial))]
pub fn derive_state(item: TokenStream) -> TokenStream {
    hexagen_codegen::derive_state(item.into()).into()
}
