//! Alternatives for the same interrupt, to compare costs: the four controllers written directly
//! from their equations, in `f32` and in `I16F16`, and the crates `foc` and `idsp`.
//!
//! All are for the paper's motor (48 V, 50 us, 12 bits over 40 A, a timer of 1800 counts) and use
//! the recorded inputs of the drives. None has a supervisor.

mod crates;
mod naive;
mod paper;
mod real;

pub use crates::{FocLoop, IdspLoop};
pub use naive::{FcsMpc, Pdcc, Phcc, PiPwm};
pub use real::Real;

use hexagen::{Legs, Sample};

/// A controller for comparison.
pub trait Peer {
    /// Initial state, 20 A demanded.
    fn new() -> Self;
    /// One control period.
    fn step(&mut self, sample: &Sample) -> Legs;
}

/// The list of a firmware's peers: `symbol: Type;` makes a step function and a row.
#[macro_export]
macro_rules! peers {
    ($($symbol:ident: $type:ty;)*) => {
        $(
            /// One control period of the peer.
            #[unsafe(no_mangle)]
            pub extern "C" fn $symbol(
                peer: &mut $type,
                adc_a: u16,
                adc_b: u16,
                hall: u8,
                hall_ticks: u16,
            ) -> u64 {
                let sample = $crate::hexagen::Sample::with_hall([adc_a, adc_b], hall);
                $crate::peers::Peer::step(peer, &sample.hall_ticks(hall_ticks)).to_bits()
            }
        )*

        /// All peers of this firmware.
        pub static PEERS: $crate::Drives = &[$($crate::Listed {
            symbol: stringify!($symbol),
            motor: "trivedi-keshri-660w.toml",
            kind: "pdcc",
            options: "",
            size: size_of::<$type>(),
            state_names: [&[]; 2],
            spec: "",
            replay: |link, task| $crate::session::replay_peer($crate::StepFn::Bits($symbol), link, task),
        },)*];
    };
}
