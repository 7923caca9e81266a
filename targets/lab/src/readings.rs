//! The drives of `hexagen reproduce`: two readings of each controller of the paper.
//!
//! The build script reads this list, too, and compiles them into the program.

/// Readings of one controller of the paper, as variant texts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Readings {
    /// As printed, as far as a drive can implement it.
    pub literal: &'static str,
    /// The same with the errata of `hexagen::errata` applied.
    pub corrected: &'static str,
}

/// The controllers in the paper's order: (a) to (d) of its figures.
pub const READINGS: [Readings; 4] = [
    Readings {
        literal: "fcs-mpc:off_leg=nominal,emf=estimated,emf_filter=1,delay=0,discretisation=euler,hall_capture=timer",
        corrected: "fcs-mpc:off_leg=physical,emf=model,discretisation=euler,hall_capture=timer",
    },
    Readings {
        literal: "pdcc:reference=quasi_square,saturation=keep_angle,emf=estimated,emf_filter=1,discretisation=euler,hall_capture=timer",
        corrected: "pdcc:saturation=torque_priority,advance=2,emf=model,discretisation=euler,hall_capture=timer",
    },
    Readings {
        literal: "phcc:table=printed,emf=estimated,emf_filter=1,discretisation=euler,hall_capture=timer",
        corrected: "phcc:table=derived,emf=model,discretisation=euler,hall_capture=timer",
    },
    Readings {
        literal: "pi-pwm:reference=quasi_square,feed_forward=off,bandwidth=800Hz,integral_time=0.5ms,discretisation=euler,hall_capture=timer",
        corrected: "pi-pwm:reference=quasi_square,feed_forward=on,bandwidth=1kHz,emf=model,discretisation=euler,hall_capture=timer",
    },
];
