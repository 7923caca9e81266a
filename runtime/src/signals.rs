//! Signals of one control period, on request. The test for a request takes instructions in every
//! period; without the feature `signals` there is none of it.

use crate::Checked;
use crate::arith::Word;
use crate::control::{Observation, Unit, Units};
use core::sync::atomic::{AtomicI32, Ordering, compiler_fence};
use fixed::types::I16F16;

/// Measurements, estimates and command of one control period, in SI units and rpm.
///
/// Numbers saturate at +-32768. Feature `defmt` formats them in whole mA, mV and rpm, rounded down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Signals {
    /// Currents of phases a, b, c into the motor at the beginning of the period, ampere.
    pub currents: [I16F16; 3],
    /// Mean terminal voltages of the command (with `delay: 1` in effect in the next period), volt
    /// against the negative rail at the nominal bus; `None` for a leg that is off. Of `Intervals`: time in
    /// which a leg is off counts as 0.
    pub voltages: [Option<I16F16>; 3],
    /// Estimated EMF of phases a, b, c in the period in which the command takes effect (PHCC: in
    /// the current one), volt; `None` if the law estimates none.
    pub emf: Option<[I16F16; 3]>,
    /// Speed in rpm, forward positive, 0 while unknown; `None` if the law does not measure it.
    pub speed: Option<I16F16>,
    /// Sector 1 to 6.
    pub sector: u8,
}

/// Integers, because a logger may keep interrupts off for the length of a frame: decimal fractions
/// would be converted in it.
#[cfg(feature = "defmt")]
impl defmt::Format for Signals {
    fn format(&self, to: defmt::Formatter<'_>) {
        let Self {
            currents,
            voltages,
            emf,
            speed,
            sector,
        } = self;
        defmt::write!(
            to,
            "currents {} mA, voltages {} mV, emf {} mV, speed {} rpm, sector {=u8}",
            currents.map(milli),
            voltages.map(|voltage| voltage.map(milli)),
            emf.map(|emf| emf.map(milli)),
            speed.map(I16F16::to_num::<i32>),
            *sector
        );
    }
}

/// Thousandths, rounded down.
#[cfg(any(feature = "defmt", test))]
fn milli(value: I16F16) -> i32 {
    let thousandths = i64::from(value.to_bits()).wrapping_mul(1000);
    thousandths.wrapping_shr(I16F16::FRAC_NBITS) as i32
}

impl Unit {
    /// A word of this unit; saturates.
    fn of(self, word: Word) -> I16F16 {
        let Self { factor, shift } = self;
        let product = i64::from(factor).wrapping_mul(i64::from(word.0));
        let bits = product.wrapping_shr(shift);
        let bits = bits.clamp(i64::from(i32::MIN), i64::from(i32::MAX));
        I16F16::from_bits(bits as i32)
    }

    /// Three phase values of zero sum, from those of phases a and b.
    fn of_phases(self, [a, b]: [Word; 2]) -> [I16F16; 3] {
        [a, b, -(a + b)].map(|word| self.of(word))
    }
}

/// Words of a period's signals, as passed by the control loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PeriodWords {
    pub currents: [Word; 2],
    pub hall: Word,
    /// Timer counts for which the upper switches are on; `None` for a leg that is off.
    pub on: [Option<u16>; 3],
    pub observation: Observation,
}

impl PeriodWords {
    pub(crate) fn signals(&self, units: &Units) -> Signals {
        let Units {
            ampere,
            volt,
            volt_per_count,
            rpm,
            sectors,
        } = units;
        let Observation { emf, speed } = self.observation;
        let voltage = |on: u16| volt_per_count.of(on.into());
        Signals {
            currents: ampere.of_phases(self.currents),
            voltages: self.on.map(|on| on.map(voltage)),
            emf: emf.map(|emf| volt.of_phases(emf)),
            speed: speed.map(|speed| rpm.of(speed)),
            sector: sectors[self.hall.0 as usize & 7],
        }
    }

    const NONE: i32 = i32::MIN;

    fn to_words(self) -> [i32; WORDS] {
        let [i_a, i_b] = self.currents.map(|word| word.0);
        let [on_a, on_b, on_c] = self.on.map(|on| on.map_or(Self::NONE, i32::from));
        let Observation { emf, speed } = self.observation;
        let [e_a, e_b] = emf.map_or([Self::NONE; 2], |emf| emf.map(|word| word.0));
        let speed = speed.map_or(Self::NONE, |word| word.0);
        [i_a, i_b, self.hall.0, on_a, on_b, on_c, e_a, e_b, speed]
    }

    fn from_words([i_a, i_b, hall, on_a, on_b, on_c, e_a, e_b, speed]: [i32; WORDS]) -> Self {
        let some = |word: i32| (word != Self::NONE).then_some(word);
        Self {
            currents: [Word(i_a), Word(i_b)],
            hall: Word(hall),
            on: [on_a, on_b, on_c].map(|on| some(on).map(|on| on as u16)),
            observation: Observation {
                emf: some(e_a).map(|e_a| [Word(e_a), Word(e_b)]),
                speed: some(speed).map(Word),
            },
        }
    }
}

/// Number of words passed.
const WORDS: usize = 9;

/// No request.
const IDLE: i32 = 0;
/// Words of the next controlled period are requested.
const ASKED: i32 = 1;
/// The words are available.
const ANSWERED: i32 = 2;
/// A context is reading the words; one that interrupts it finds nothing to take.
const TAKING: i32 = 3;

/// Passes the words. The control loop writes only while they are requested; the main program writes
/// only while they are not, and reads only after the answer.
#[derive(Debug)]
pub(crate) struct Port {
    turn: AtomicI32,
    words: [AtomicI32; WORDS],
}

impl Port {
    pub(crate) const fn new() -> Self {
        Self {
            turn: AtomicI32::new(IDLE),
            words: [const { AtomicI32::new(0) }; WORDS],
        }
    }

    /// Whether the words of this period are requested.
    #[inline]
    pub(crate) fn is_asked(&self) -> bool {
        self.turn.load(Ordering::Relaxed) == ASKED
    }

    /// Answers a request with the words of this period.
    #[cold]
    #[inline(never)]
    pub(crate) fn answer(&self, seen: Checked, on: [Option<u16>; 3], observation: Observation) {
        let words = PeriodWords {
            currents: [seen.i_a(), seen.i_b()],
            hall: seen.hall(),
            on,
            observation,
        };
        for (place, word) in self.words.iter().zip(words.to_words()) {
            place.store(word, Ordering::Relaxed);
        }
        compiler_fence(Ordering::Release);
        self.turn.store(ANSWERED, Ordering::Relaxed);
    }

    /// The words, if available; else requests them.
    pub(crate) fn take(&self) -> Option<PeriodWords> {
        match self.turn.load(Ordering::Relaxed) {
            ANSWERED => self.turn.store(TAKING, Ordering::Relaxed),
            IDLE => {
                self.turn.store(ASKED, Ordering::Relaxed);
                return None;
            }
            _ => return None,
        }
        compiler_fence(Ordering::Acquire);
        let words = PeriodWords::from_words(core::array::from_fn(|index| {
            self.words
                .get(index)
                .map_or(0, |place| place.load(Ordering::Relaxed))
        }));
        compiler_fence(Ordering::Release);
        self.turn.store(IDLE, Ordering::Relaxed);
        Some(words)
    }
}

#[cfg(test)]
mod tests {
    use super::{Checked, Observation, PeriodWords, Port, Unit, milli};
    use crate::arith::Word;
    use fixed::types::I16F16;

    const WORDS: PeriodWords = PeriodWords {
        currents: [Word(3), Word(-4)],
        hall: Word(5),
        on: [Some(7), None, Some(u16::MAX)],
        observation: Observation {
            emf: Some([Word(-8), Word(9)]),
            speed: None,
        },
    };

    #[test]
    fn requested_words_are_passed_together() {
        let port = Port::new();
        assert!(!port.is_asked());
        assert_eq!(port.take(), None);
        assert!(port.is_asked());
        assert_eq!(port.take(), None);
        let seen = Checked {
            i: WORDS.currents,
            hall: WORDS.hall,
            timing: Word(0),
        };
        port.answer(seen, WORDS.on, WORDS.observation);
        assert!(!port.is_asked());
        assert_eq!(port.take(), Some(WORDS));
        assert!(!port.is_asked());
    }

    #[test]
    fn a_unit_scales_rounds_down_and_saturates() {
        let half = Unit {
            factor: 1,
            shift: 1,
        };
        assert_eq!(half.of(Word(5)), I16F16::from_bits(2));
        assert_eq!(half.of(Word(-5)), I16F16::from_bits(-3));
        let huge = Unit {
            factor: i32::MAX,
            shift: 1,
        };
        assert_eq!(huge.of(Word(i32::MAX)), I16F16::MAX);
        assert_eq!(huge.of(Word(i32::MIN)), I16F16::MIN);
    }

    #[test]
    fn thousandths_are_rounded_down() {
        let rounded = [1.5, -1.5, 0.0009, -0.0001].map(|value| milli(I16F16::from_num(value)));
        assert_eq!(rounded, [1500, -1500, 0, -1]);
        let ends = [I16F16::MAX, I16F16::MIN].map(milli);
        assert_eq!(ends, [32_767_999, -32_768_000]);
    }
}
