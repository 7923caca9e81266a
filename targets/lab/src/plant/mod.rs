//! The simulated plant: motor, inverter, Hall sensors and current ADCs (`hexagen::conventions`).
//!
//! The electrical network is piecewise linear; between two events it is solved by its Taylor
//! series, which is exact to rounding. Events are switching edges, ends of dead times, corners of
//! the EMF, current zeros of legs that are off, and floating legs that reach a rail.
//! Speed is fixed, or free with inertia and load (then integrated to second order in the step).
//! Units are SI throughout; angles are electrical radians unless a name says otherwise.

mod adc;
mod check;
mod emf;
mod energy;
mod gates;
mod hall;
mod machine;
mod network;
mod params;
mod roots;
mod segment;
mod short;

pub use energy::{EnergyBalance, EnergyMeter};
pub use gates::{Gate, Gates};
pub use machine::{Observer, Plant, Truth};
pub use params::{
    AdcChannel, AngleSensor, EmfShape, LowSide, Mechanics, PlantError, PlantParams,
    STANDARD_HALL_CODES, Wiring,
};
pub(crate) use segment::integral;
pub use segment::{Segment, Series, TERMS, Terminal};
pub use short::{SHORT_RESISTANCE, Short};

use std::f64::consts::{FRAC_PI_3, TAU};

/// Sector 1 to 6 of an electrical angle in radians: S_k covers `[-30 + 60(k-1), 30 + 60(k-1))`
/// degrees ([`hexagen::conventions`]).
pub fn sector_of(theta_e: f64) -> usize {
    ((theta_e / FRAC_PI_3 + 0.5).rem_euclid(6.0).floor() as usize).min(5) + 1
}

/// Amplitude-invariant Clarke transform (factor 2/3) of three phase quantities: (alpha, beta).
pub fn clarke([a, b, c]: [f64; 3]) -> (f64, f64) {
    ((2.0 * a - b - c) / 3.0, (b - c) / 3.0_f64.sqrt())
}

/// Wraps an angle to `[0, 2 pi)`.
fn wrap(angle: f64) -> f64 {
    // Angles move by less than a turn; a remainder gives the same, more slowly.
    let wrapped = if (0.0..TAU).contains(&angle) {
        angle
    } else if (-TAU..0.0).contains(&angle) {
        angle + TAU
    } else if (TAU..2.0 * TAU).contains(&angle) {
        angle - TAU
    } else {
        angle.rem_euclid(TAU)
    };
    if wrapped < TAU { wrapped } else { 0.0 }
}

/// The greatest integer not above `x`; `|x|` below 2^52. The standard function is a call into the C
/// library on processors without an instruction for it.
fn floor(x: f64) -> f64 {
    let whole = x as i64 as f64;
    if whole > x { whole - 1.0 } else { whole }
}

#[cfg(test)]
mod tests {
    use super::{floor, wrap};
    use std::f64::consts::TAU;

    #[test]
    fn short_cuts_give_the_same_bits() {
        let around = |x: f64| [x.next_down(), x, x.next_up()];
        let values = (-40..=40).flat_map(|k| around(f64::from(k) * TAU / 8.0));
        for angle in values.chain([1e3, -1e3, 1e-300, -1e-300, -0.0]) {
            let wrapped = angle.rem_euclid(TAU);
            let expected = if wrapped < TAU { wrapped } else { 0.0 };
            assert_eq!(wrap(angle), expected, "{angle}");
        }
        for x in (-9..=9).flat_map(|k| around(f64::from(k))) {
            assert_eq!(floor(x), x.floor(), "{x}");
        }
    }
}
