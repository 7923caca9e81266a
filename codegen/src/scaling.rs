//! The choice of formats: the finest scale at which every value of the program fits its word.
//!
//! Currents take the largest number of fraction bits that the ADC's range allows; voltages the
//! largest whose program passes verification with coefficients and products that fit. Products of
//! 32-bit words must fit their upper word, unless no scale allows that.

use crate::at_once::at_once;
use crate::blocks::Scale;
use crate::interface::FormatEntry;
use crate::ir::{Function, Op, Program, VerifiedGraph, Violation, verify};
use crate::spec::InverterSpec;
use crate::stopwatch::Part;

/// A program lowered at a scale, before verification.
#[derive(Debug)]
pub struct Lowered {
    /// The program.
    pub program: Program,
    /// Format table.
    pub formats: Vec<FormatEntry>,
    /// Coefficients and constants too large for their word at this scale.
    pub misfits: Vec<String>,
    /// 32-bit coefficients whose products need more than the upper word, one instruction of most
    /// cores.
    pub long_products: Vec<&'static str>,
}

/// A verified program with its formats.
#[derive(Debug)]
pub struct Scaled {
    /// The program.
    pub graph: VerifiedGraph,
    /// Format table.
    pub formats: Vec<FormatEntry>,
    /// The scale.
    pub scale: Scale,
}

/// Why no scale fits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unscalable {
    /// The signal needs more bits than the word has even at the coarsest scale.
    TooNarrow {
        /// Signal or coefficient.
        signal: String,
        /// Bits that it needs, if known.
        bits: Option<u32>,
    },
    /// An invariant other than a range is broken: a bug of the generator.
    Broken(Vec<Violation>),
}

/// Largest number of voltage fraction bits that is tried.
const FINEST_VOLTAGE: u32 = 20;

/// First two trials: most motors' drives have 12 or 15.
const FIRST_VOLTAGES: (u32, u32) = (12, 16);

/// Searches the finest scale for `lower`. A program that fits at a scale fits at every coarser one.
///
/// # Errors
/// [`Unscalable`] if the coarsest scale does not fit: voltages with one fraction bit, currents with
/// none.
pub fn choose_scale(
    inverter: &InverterSpec,
    word: u32,
    lower: impl Fn(Scale) -> Lowered + Sync,
) -> Result<Scaled, Unscalable> {
    // i_c = -(i_a + i_b) and differences of two currents need one bit more than a current; with
    // 16-bit words currents themselves must fit the word as factors.
    let spare = if word == 16 { 15 } else { 30 };
    let most_bits = u32::checked_sub(spare, inverter.adc_bits);
    let fits = |bits: &u32| currents_fit(inverter, word, *bits);
    let Some(current_bits) = most_bits.and_then(|most| (0..=most).rev().find(fits)) else {
        return Err(Unscalable::TooNarrow {
            signal: "phase currents".to_owned(),
            bits: Some(inverter.adc_bits + 1),
        });
    };
    let of_voltages = |voltage_bits| Scale {
        word,
        current_bits,
        voltage_bits,
        ampere_per_count: inverter.adc_gain.abs(),
        volt_per_count: inverter.v_bus / f64::from(inverter.timer_period),
    };
    let finest = if word == 16 { 12 } else { FINEST_VOLTAGE };
    let short = finest_of(finest, |bits| {
        fit(of_voltages(bits), lower(of_voltages(bits)), true)
    });
    match short {
        Err(Unscalable::TooNarrow { .. }) => finest_of(finest, |bits| {
            fit(of_voltages(bits), lower(of_voltages(bits)), false)
        }),
        found => found,
    }
}

/// Whether currents with so many fraction bits fit: as factors with 16-bit words, else the sum of all that are measured,
/// or of two.
fn currents_fit(inverter: &InverterSpec, word: u32, fraction_bits: u32) -> bool {
    let [low, high] = inverter.current_range(fraction_bits);
    let most = high.max(-low);
    if word == 16 {
        most <= i64::from(i16::MAX)
    } else {
        most * inverter.sensors().len() as i64 <= i64::from(i32::MAX)
    }
}

/// The finest of 1 to `high` voltage bits that fits.
fn finest_of(
    mut high: u32,
    fit: impl Fn(u32) -> Result<Scaled, Unscalable> + Sync,
) -> Result<Scaled, Unscalable> {
    let mut low = 1;
    let mut finest = Err(Unscalable::TooNarrow {
        signal: "voltages".to_owned(),
        bits: None,
    });
    while low <= high {
        // Two trials in parallel divide the range in three.
        let third = (high - low) / 3;
        let (coarse, fine) = match (low, high) {
            (1, FINEST_VOLTAGE) => FIRST_VOLTAGES,
            _ => (low + third, high - third),
        };
        let (fitted_coarse, fitted_fine) = if coarse < fine {
            let (coarse, fine) = at_once(|| fit(coarse), || fit(fine));
            (Some(coarse), fine)
        } else {
            (None, fit(fine))
        };
        let mut fits = |bits: u32, fitted| match fitted {
            Ok(scaled) => {
                finest = Ok(scaled);
                low = bits + 1;
                Ok(true)
            }
            Err(broken @ Unscalable::Broken(_)) => Err(broken),
            Err(too_narrow) => {
                // Reports the coarsest scale, the last to fail if none fits.
                if finest.is_err() {
                    finest = Err(too_narrow);
                }
                high = bits - 1;
                Ok(false)
            }
        };
        let fine_fits = fits(fine, fitted_fine)?;
        if let (false, Some(fitted)) = (fine_fits, fitted_coarse) {
            fits(coarse, fitted)?;
        }
    }
    finest
}

/// The verified program if it fits its words at this scale; with `short`, its products their upper
/// word.
fn fit(scale: Scale, lowered: Lowered, short: bool) -> Result<Scaled, Unscalable> {
    let Lowered {
        program,
        formats,
        misfits,
        long_products,
    } = lowered;
    let long = long_products.first().filter(|_| short);
    if let Some(name) = long {
        return Err(Unscalable::TooNarrow {
            signal: format!("the upper word of the product with `{name}`"),
            bits: None,
        });
    }
    if let Some(signal) = misfits.into_iter().next() {
        return Err(Unscalable::TooNarrow {
            signal: format!("coefficient `{signal}`"),
            bits: None,
        });
    }
    let wide = (scale.word == 16).then(|| wide_product(&program)).flatten();
    let graph = Part::ProofRanges
        .timed(|| verify(program.rewritten().pruned()))
        .map_err(|violations| {
            let escape =
                |violation: &Violation| Some((violation.place.clone(), violation.escaped?));
            match violations.iter().find_map(escape) {
                Some((place, interval)) => Unscalable::TooNarrow {
                    signal: format!("`{}`", place.rsplit(": ").next().unwrap_or_default()),
                    bits: Some(interval.bits()),
                },
                None => Unscalable::Broken(violations),
            }
        })?;
    if let Some(signal) = wide {
        return Err(Unscalable::TooNarrow { signal, bits: None });
    }
    Ok(Scaled {
        graph,
        formats,
        scale,
    })
}

/// A product with a 16-bit coefficient on the normal path that does not fit 32 bits.
fn wide_product(program: &Program) -> Option<String> {
    let step: &Function = &program.step;
    let normal = step
        .stages
        .iter()
        .filter(|stage| stage.guard.as_ref().is_none_or(|guard| !guard.rare));
    normal
        .flat_map(|stage| stage.first..stage.end)
        .find_map(|index| {
            let Op::MulRound {
                coefficient,
                signal,
                shift,
            } = step.nodes[index].op
            else {
                return None;
            };
            let Op::Constant(id) = step.node(coefficient).op else {
                return None;
            };
            let constant = &program.constants[id.index()];
            let product = i64::from(constant.raw).abs() * step.node(signal).interval.magnitude()
                + (1 << (shift - 1));
            let bits = 65 - product.leading_zeros();
            // Angles have 64-bit products at any word length; their coefficients exceed 16 bits.
            let sixteen = i64::from(constant.raw).abs() < 1 << 15;
            (sixteen && bits > 32).then(|| format!("the product with `{}`", constant.name))
        })
}
