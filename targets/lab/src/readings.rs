//! The drives of `hexagen reproduce`: two readings of each controller of the paper, and drives that go beyond it.
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
        literal: "fcs-mpc:off_leg=nominal,emf=held,delay=0,discretisation=euler,hall_capture=timer",
        corrected: "fcs-mpc:off_leg=physical,emf=model,discretisation=euler,hall_capture=timer",
    },
    Readings {
        literal: "pdcc:reference=quasi_square,saturation=keep_angle,modulation=table2,emf=held,discretisation=euler,hall_capture=timer",
        corrected: "pdcc:reference=quasi_square,saturation=nearest,emf=model,discretisation=euler,hall_capture=timer",
    },
    Readings {
        literal: "phcc:table=printed,off_leg=nominal,emf=held,discretisation=euler,hall_capture=timer",
        corrected: "phcc:table=derived,emf=model,discretisation=euler,hall_capture=timer",
    },
    Readings {
        literal: "pi-pwm:reference=quasi_square,saturation=keep_angle,modulation=table2,feed_forward=off,bandwidth=800Hz,integral_time=0.5ms,discretisation=euler,hall_capture=timer",
        corrected: "pi-pwm:reference=quasi_square,saturation=nearest,feed_forward=off,bandwidth=800Hz,integral_time=0.5ms,discretisation=euler,hall_capture=timer",
    },
];

/// A drive that goes beyond the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Improvement {
    /// Symbol of the step function that `cargo xtask cost` counts.
    pub symbol: &'static str,
    /// Its variant text.
    pub variant: &'static str,
    /// What it does otherwise, in a sentence.
    pub about: &'static str,
}

/// Improvements of the paper's methods, and the default drive.
pub const IMPROVEMENTS: [Improvement; 3] = [
    Improvement {
        symbol: "step_trivedi_keshri_660w_pdcc_improved",
        variant: "pdcc:reference=quasi_square,saturation=torque_priority,advance=2,emf=model,discretisation=euler,hall_capture=timer",
        about: "PDCC that keeps the component along the EMF at the voltage limit, and commutates two periods ahead.",
    },
    Improvement {
        symbol: "step_trivedi_keshri_660w_pi_pwm_improved",
        variant: "pi-pwm:reference=quasi_square,saturation=nearest,feed_forward=on,bandwidth=1kHz,emf=model,discretisation=euler,hall_capture=timer",
        about: "PI-PWM with feed-forward of the motor's EMF, 1 kHz, integral time L/R.",
    },
    Improvement {
        symbol: "step_trivedi_keshri_660w_pdcc",
        variant: "pdcc:target=cortex_m4",
        about: "The default drive: PDCC with a current of the EMF's shape in place of the quasi-square one, and an EMF observer.",
    },
];
