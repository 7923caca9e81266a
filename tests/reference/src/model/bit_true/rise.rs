//! Rise of the speed between Hall edges (section 4).

use super::scale::Scale;
use crate::Error;
use crate::exact::{Coefficient, Shift, Word, lesser, pow2, within};
use crate::model::hall::{HallClock, HallTiming, RISE};

/// Rise of the speed from the last turn to the coming sector.
#[derive(Clone, Copy, Debug)]
pub struct Rise<W> {
    /// Of eight times the change of half a turn's time and twice the rate, with S bits less.
    change: Shift,
    limit: f64,
    factor: Coefficient<W>,
    whole: Shift,
}

impl<W: Word> Rise<W> {
    pub fn new(scale: &Scale, clock: &HallClock) -> Result<Self, Error> {
        let greatest = 6.0 * clock.age_max * (pow2(32) / clock.rev_min);
        let shift = (greatest.log2().floor() - 30.0).max(2.0);
        Ok(Self {
            change: Shift::new(shift as u32 + 1),
            limit: pow2(32 - shift as i32),
            factor: scale.coefficient("k_rise", RISE * pow2(shift as i32 - 3))?,
            whole: Shift::new(32),
        })
    }

    /// An angle at the last turn's speed, at the coming sector's.
    #[inline]
    pub fn risen(&self, angle: W, rise: W, most: W) -> W {
        lesser(angle + self.whole.floor_product(angle, rise), most)
    }

    #[inline]
    pub fn at(&self, timing: &HallTiming<W>, rate: W) -> W {
        let eighths = within(timing.shortened() * 8.0, -timing.rev, timing.rev);
        let change = self.change.floor_product(eighths, rate * 2.0 + 1.0);
        self.factor.mul(within(change, -self.limit, self.limit))
    }
}
