//! The voltage that a command applies, off leg included (section 7).

use super::constants::Constants;
use crate::exact::{Word, halve, within, word};

/// Phase voltages a, b of the terminal voltages `terminal` with leg `off` (0: none, 1 to 3) off,
/// at currents `i` and EMF `e`.
#[inline]
pub fn voltage<W: Word>(
    k: &Constants<W>,
    v_bus: W,
    terminal: &[W; 3],
    off: usize,
    i: &[W; 3],
    e: [W; 2],
) -> [W; 2] {
    let mut t = *terminal;
    if let Some(leg) = off.checked_sub(1).filter(|leg| *leg < 3) {
        let e = [e[0], e[1], -(e[0] + e[1])];
        let driven = halve(t[0] + t[1] + t[2] - t[leg]);
        let floating = driven + e[leg] + halve(e[leg]);
        t[leg] = if i[leg] > k.i_comm {
            word(0.0)
        } else if i[leg] < -k.i_comm {
            v_bus
        } else {
            within(floating, 0.0, v_bus)
        };
    }
    let mean = k.k_third.mul(t[0] + t[1] + t[2]);
    [t[0] - mean, t[1] - mean]
}
