//! The deadbeat voltage (section 9).

use super::Inputs;
use crate::Error;
use crate::exact::Coefficient;
use crate::model::bit_true::constants::Scale;

/// Coefficients of the deadbeat voltage.
#[derive(Clone, Debug)]
pub struct Deadbeat {
    delayed: bool,
    k_hold: Coefficient,
    k_decay: Coefficient,
}

impl Deadbeat {
    pub fn new(scale: &Scale) -> Result<Self, Error> {
        let (a, b) = (scale.phase.a, scale.phase.b);
        let delayed = scale.variant.delayed();
        let held = if delayed { a * a } else { a };
        Ok(Self {
            delayed,
            k_hold: scale.coefficient("k_hold", scale.ohm * held / b)?,
            k_decay: scale.only_if(delayed, "k_decay", b * scale.resistance)?,
        })
    }

    /// The measured current as a voltage, phases a, b.
    #[inline]
    pub fn held(&self, now: &Inputs) -> [f64; 2] {
        now.i.map(|i| self.k_hold.mul(i))
    }

    /// Phases a, b, not limited.
    #[inline]
    pub fn voltage(&self, now: &Inputs) -> [f64; 2] {
        let held = self.held(now);
        [0, 1].map(|x| {
            let held = now.j[x] - held[x];
            if self.delayed {
                held + self.k_decay.mul(now.v_now[x] - now.e_now[x]) + now.e[x] + now.e_now[x]
                    - now.v_now[x]
            } else {
                held + now.e[x]
            }
        })
    }
}
