//! The common mode of three pulsed legs (sections 10 and 11).

use crate::exact::{Coefficient, Word, greater, lesser, word};
use crate::model::bit_true::constants::{Constants, Scale};
use crate::{CommonMode, Error, Spec};

/// Policy and largest compare value.
#[derive(Clone, Debug)]
pub struct CommonModeRule<W> {
    mode: CommonMode,
    /// TOP, counts.
    pub top: f64,
    reach: Reach<W>,
}

/// V_REACH.
#[derive(Clone, Debug)]
enum Reach<W> {
    Bus,
    Word(f64),
    Share(Coefficient<W>),
}

impl<W: Word> CommonModeRule<W> {
    pub fn new(spec: &Spec, mode: CommonMode, scale: &Scale) -> Result<Self, Error> {
        let inverter = &spec.inverter;
        let (period, top) = (inverter.timer_period, inverter.largest_compare()?);
        let counts = match mode {
            CommonMode::Centred => 2.0 * f64::from(top) - f64::from(period),
            CommonMode::Readable | CommonMode::ClampedLow => f64::from(top),
        };
        let reach = if top == period {
            Reach::Bus
        } else if inverter.bus_sense()?.is_none() {
            Reach::Word(counts * scale.two_v)
        } else {
            Reach::Share(scale.coefficient("k_reach", counts / f64::from(period))?)
        };
        Ok(Self {
            mode,
            top: f64::from(top),
            reach,
        })
    }

    /// V_REACH at this bus.
    #[inline]
    pub fn reach(&self, v_bus: W) -> W {
        match &self.reach {
            Reach::Bus => v_bus,
            Reach::Word(reach) => word(*reach),
            Reach::Share(k_reach) => k_reach.mul(v_bus),
        }
    }

    /// What voltages of zero middle are lifted by.
    #[inline]
    pub fn lift(&self, k: &Constants<W>, pulses: [W; 3]) -> W {
        let [a, b, c] = pulses;
        match self.mode {
            CommonMode::Centred => word(k.half),
            CommonMode::Readable => {
                let top: W = word(self.top * 2.0 * k.half_count);
                lesser(word(k.half), top - greater(greater(a, b), c))
            }
            CommonMode::ClampedLow => -lesser(lesser(a, b), c),
        }
    }
}
