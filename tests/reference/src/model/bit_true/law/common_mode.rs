//! The common mode of three pulsed legs (sections 10 and 11).

use super::Inputs;
use crate::exact::{Coefficient, Word, all_three, both, greater, lesser, word};
use crate::model::bit_true::constants::Constants;
use crate::model::bit_true::limit::{self, Limited};
use crate::model::bit_true::scale::Scale;
use crate::{CommonMode, Error, Saturation, Spec};

/// Policy and largest compare value.
#[derive(Clone, Debug)]
pub struct CommonModeRule<W> {
    mode: CommonMode,
    /// TOP, counts.
    pub top: f64,
    /// Largest compare value of the second highest leg, counts.
    second_top: f64,
    reach: Share<W>,
    /// V_SECOND, where the second highest leg's limit is its own.
    second: Option<Share<W>>,
}

/// A part of the bus.
#[derive(Clone, Debug)]
enum Share<W> {
    Bus,
    Word(f64),
    Of(Coefficient<W>),
}

impl<W: Word> CommonModeRule<W> {
    pub fn new(spec: &Spec, mode: CommonMode, scale: &Scale) -> Result<Self, Error> {
        let inverter = &spec.inverter;
        let top = match mode {
            CommonMode::Centred => inverter.largest_compare()?,
            CommonMode::Readable | CommonMode::ClampedLow => inverter.highest_compare()?,
        };
        Self::with_top(spec, mode, top, scale, Some("k_reach"))
    }

    /// That of whole vectors, whose high legs are alike and of which one leg is low throughout.
    pub fn of_vectors(spec: &Spec, scale: &Scale) -> Result<Self, Error> {
        let top = spec.inverter.largest_compare()?;
        Self::with_top(spec, CommonMode::ClampedLow, top, scale, Some("k_reach"))
    }

    /// That of a pair, of which one leg is low throughout; without effect in variants without pairs.
    pub fn of_pair(spec: &Spec, is_used: bool, scale: &Scale) -> Result<Self, Error> {
        let top = spec.inverter.largest_compare()?;
        let name = is_used.then_some("k_line");
        Self::with_top(spec, CommonMode::ClampedLow, top, scale, name)
    }

    /// `k_reach`: name of the coefficient for V_REACH on a measured bus, if it is used.
    fn with_top(
        spec: &Spec,
        mode: CommonMode,
        top: u32,
        scale: &Scale,
        k_reach: Option<&'static str>,
    ) -> Result<Self, Error> {
        let inverter = &spec.inverter;
        let (period, readable) = (inverter.timer_period, inverter.largest_compare()?);
        let counts = match mode {
            CommonMode::Centred => 2.0 * f64::from(top) - f64::from(period),
            CommonMode::Readable | CommonMode::ClampedLow => f64::from(top),
        };
        let is_fixed = inverter.bus_sense()?.is_none();
        let share = |name: &'static str, counts: f64| -> Result<Share<W>, Error> {
            Ok(if is_fixed {
                Share::Word(counts * scale.two_v)
            } else {
                Share::Of(scale.coefficient(name, counts / f64::from(period))?)
            })
        };
        Ok(Self {
            mode,
            top: f64::from(top),
            second_top: f64::from(readable),
            reach: match k_reach {
                Some(name) if top < period => share(name, counts)?,
                _ => Share::Bus,
            },
            second: (readable < top)
                .then(|| share("k_second", f64::from(readable)))
                .transpose()?,
        })
    }

    /// V_REACH at this bus.
    #[inline]
    pub fn reach(&self, v_bus: W) -> W {
        self.reach.at(v_bus)
    }

    /// A voltage within the hexagon of these legs; `e`: the EMF of phases a, b.
    #[inline]
    pub fn limited(&self, now: &Inputs<W>, rule: Saturation, u: [W; 2], e: [W; 2]) -> Limited<W> {
        let limited = limit::limit(rule, now.k, self.reach(now.v_bus), u, e);
        self.readable(now.k, now.v_bus, limited)
    }

    /// Where the highest leg need not be read, the second highest no higher than its sensor can be.
    #[inline]
    fn readable(&self, k: &Constants<W>, v_bus: W, limited: Limited<W>) -> Limited<W> {
        let Some(v_second) = &self.second else {
            return limited;
        };
        let Limited {
            u,
            legs,
            reach,
            spread,
        } = limited;
        let [a, b, c] = legs;
        let (high, low) = (greater(greater(a, b), c), lesser(lesser(a, b), c));
        let second = a + b + c - high - low;
        let most = low + v_second.at(v_bus);
        if second <= most {
            return limited;
        }
        let highest = [0, 1, 2].into_iter().find(|&x| legs[x] == high);
        let lowered = all_three(|x| {
            if Some(x) == highest {
                legs[x]
            } else {
                lesser(legs[x], most)
            }
        });
        let mean = k.k_third.mul(second - most);
        Limited {
            u: both(|x| u[x] - (legs[x] - lowered[x]) + mean),
            legs: lowered,
            reach,
            spread,
        }
    }

    /// What voltages of zero middle are lifted by.
    #[inline]
    pub fn lift(&self, k: &Constants<W>, pulses: [W; 3]) -> W {
        let [a, b, c] = pulses;
        let (high, low) = (greater(greater(a, b), c), lesser(lesser(a, b), c));
        let within_top = |top: f64, leg: W| word::<W>(top * 2.0 * k.half_count) - leg;
        let lift = match self.mode {
            CommonMode::Centred => word(k.half),
            CommonMode::Readable => lesser(word(k.half), within_top(self.top, high)),
            CommonMode::ClampedLow => -low,
        };
        match self.second {
            Some(_) => lesser(lift, within_top(self.second_top, a + b + c - high - low)),
            None => lift,
        }
    }
}

impl<W: Word> Share<W> {
    #[inline]
    fn at(&self, v_bus: W) -> W {
        match self {
            Self::Bus => v_bus,
            Self::Word(volts) => word(*volts),
            Self::Of(share) => share.mul(v_bus),
        }
    }
}
