//! What a drive saw and knew when it tripped, kept until it is reset.

use crate::control::State;
use crate::{Control, Fault, Sample, Supervisor};
use core::sync::atomic::{AtomicI32, Ordering, compiler_fence};

/// The control period in which a drive tripped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Trip {
    /// What tripped it.
    pub fault: Fault,
    /// What that period sampled.
    pub sample: Sample,
    /// Set-point word of the current, as a step reads it: of the generated law's own unit.
    pub current: i32,
    /// Set-point word of the speed; 0 without a speed loop.
    pub speed: i32,
    /// Words of the bus voltage that was told; 0 with `v_bus: fixed`.
    pub bus: [i32; 2],
}

/// Words of the supervisor, as it left them in the period of the trip.
const SUPERVISOR: usize = Supervisor::NAMES.len();

/// Places of the words that a law keeps.
pub trait Places: core::fmt::Debug + Send + Sync + 'static {
    /// All 0.
    const EMPTY: Self;
    /// The places in the order of [`State::NAMES`].
    fn places(&self) -> &[AtomicI32];
}

impl<const N: usize> Places for [AtomicI32; N] {
    const EMPTY: Self = [const { AtomicI32::new(0) }; N];

    #[inline]
    fn places(&self) -> &[AtomicI32] {
        self
    }
}

/// Where the period of a trip is kept. The control loop alone writes.
#[derive(Debug)]
pub(crate) struct TripRecord<C: Control> {
    /// Odd: a trip is kept, the same one as long as the number stays.
    number: AtomicI32,
    fault: AtomicI32,
    adc: [AtomicI32; 3],
    hall: AtomicI32,
    hall_ticks: AtomicI32,
    angle: AtomicI32,
    current: AtomicI32,
    speed: AtomicI32,
    bus: [AtomicI32; 2],
    supervisor: [AtomicI32; SUPERVISOR],
    law: <C::State as State>::Kept,
}

impl<C: Control> TripRecord<C> {
    pub(crate) const fn new() -> Self {
        const fn empty<const N: usize>() -> [AtomicI32; N] {
            [const { AtomicI32::new(0) }; N]
        }
        Self {
            number: AtomicI32::new(0),
            fault: AtomicI32::new(0),
            adc: empty(),
            hall: AtomicI32::new(0),
            hall_ticks: AtomicI32::new(0),
            angle: AtomicI32::new(0),
            current: AtomicI32::new(0),
            speed: AtomicI32::new(0),
            bus: empty(),
            supervisor: empty(),
            law: <C::State as State>::Kept::EMPTY,
        }
    }

    /// Keeps a period; the law's words are those with which it began.
    pub(crate) fn keep(&self, trip: &Trip, supervisor: &Supervisor, law: &C::State) {
        self.forget();
        let Trip {
            fault,
            sample,
            current,
            speed,
            bus,
        } = *trip;
        store(&self.fault, fault as i32);
        let [adc_a, adc_b, adc_c] = sample.adc;
        store_all(&self.adc, &[adc_a.into(), adc_b.into(), adc_c.into()]);
        store(&self.hall, sample.hall.into());
        store(&self.hall_ticks, sample.hall_ticks.into());
        store(&self.angle, sample.angle.cast_signed());
        store(&self.current, current);
        store(&self.speed, speed);
        store_all(&self.bus, &bus);
        store_all(&self.supervisor, &supervisor.words());
        law.keep(&self.law);
        compiler_fence(Ordering::Release);
        store(&self.number, load(&self.number).wrapping_add(1));
    }

    /// Keeps nothing any more.
    pub(crate) fn forget(&self) {
        let number = load(&self.number);
        if number & 1 != 0 {
            store(&self.number, number.wrapping_add(1));
        }
        compiler_fence(Ordering::Release);
    }

    /// The period that is kept, and its words at the front of `words`, as many as fit; none where it
    /// is replaced meanwhile.
    pub(crate) fn read(&self, words: &mut [i32]) -> Option<Trip> {
        self.read_while(|| {
            let kept = self.supervisor.iter().chain(self.law.places());
            for (word, place) in words.iter_mut().zip(kept) {
                *word = load(place);
            }
        })
    }

    /// As [`read`](Self::read), with what is to be done between the first and the last access.
    fn read_while(&self, read_words: impl FnOnce()) -> Option<Trip> {
        let number = load(&self.number);
        if number & 1 == 0 {
            return None;
        }
        compiler_fence(Ordering::Acquire);
        let [adc_a, adc_b, adc_c] = &self.adc;
        let sample = Sample {
            adc: [load(adc_a) as u16, load(adc_b) as u16, load(adc_c) as u16],
            hall: load(&self.hall) as u8,
            hall_ticks: load(&self.hall_ticks) as u16,
            angle: load(&self.angle).cast_unsigned(),
        };
        let fault = Fault::from_number(load(&self.fault));
        let (current, speed) = (load(&self.current), load(&self.speed));
        let [first, second] = &self.bus;
        let bus = [load(first), load(second)];
        read_words();
        compiler_fence(Ordering::Acquire);
        if load(&self.number) != number {
            return None;
        }
        fault.map(|fault| Trip {
            fault,
            sample,
            current,
            speed,
            bus,
        })
    }
}

fn load(place: &AtomicI32) -> i32 {
    place.load(Ordering::Relaxed)
}

fn store(place: &AtomicI32, word: i32) {
    place.store(word, Ordering::Relaxed);
}

// `zip` and `map` of arrays have panic paths in builds that are hardly optimised.
fn store_all(places: &[AtomicI32], words: &[i32]) {
    let mut words = words.iter();
    for place in places {
        if let Some(word) = words.next() {
            store(place, *word);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Ordering, Trip, TripRecord};
    use crate::arith::Word;
    use crate::control::State;
    use crate::supervisor::Supervisor;
    use crate::{
        Checked, Control, Fault, FixedBus, Format, Legs, Limits, Observation, Sample, Unit, Units,
        Words,
    };
    use core::sync::atomic::AtomicI32;

    #[derive(Debug)]
    struct Law;
    struct Kept(i32);

    impl State for Kept {
        const INITIAL: Self = Self(0);
        const NAMES: &'static [&'static str] = &["kept"];
        type Kept = [AtomicI32; 1];
        fn keep(&self, [kept]: &Self::Kept) {
            kept.store(self.0, Ordering::Relaxed);
        }
        fn words(&self, _: &mut [i32]) {}
        fn set_word(&mut self, _: usize, _: i32) {}
    }

    const UNIT: Unit = Unit {
        factor: 1,
        shift: 1,
    };

    impl Control for Law {
        type State = Kept;
        type Rotor = ();
        type Command = Legs;
        type Bus = FixedBus;
        const NAME: &'static str = "Law";
        const SPEC: &'static str = "";
        const FORMATS: &'static [Format] = &[];
        const LIMITS: Limits = Limits {
            adc_max: 4095,
            adc_inverted: false,
            current_bits: 0,
            offset: 2048,
            offsets: [2000, 2100],
            trip: 1900,
            currents: [-2100, 2095],
            calibration_log2: 4,
            precharge_periods: 2,
            stall_periods: 0,
            hall_inverted: 0,
            hall_glitches: 0,
            sectors: 0x0423_6510,
            brake_periods: 0,
            start_periods: 0,
            bus_counts: [0, u16::MAX],
        };
        const UNITS: Units = Units {
            ampere: UNIT,
            volt: UNIT,
            volt_per_count: UNIT,
            rpm: UNIT,
            sectors: [0; 8],
        };
        const SET_POINT: Word = Word(0);
        const BUS: FixedBus = FixedBus;
        fn current(bits: Word) -> Word {
            bits
        }
        fn torque(bits: Word) -> Word {
            bits
        }
        fn track(_: &mut Kept, _: &Checked) {}
        fn rest(_: &mut Kept, _: &Checked, (): ()) {}
        fn step(_: &mut Kept, _: &Words<Self>, _: &Checked, (): (), _: &mut Observation) -> Legs {
            Legs::OFF
        }
    }

    fn trip(number: i32) -> Trip {
        Trip {
            fault: Fault::OverCurrent,
            sample: Sample::with_hall([number as u16; 2], 1).hall_ticks(number as u16),
            current: number,
            speed: number,
            bus: [number; 2],
        }
    }

    /// What interrupts a read: a reset, or a reset and another trip, or nothing.
    #[test]
    fn a_read_gives_one_trip_whole_or_none() {
        let record = TripRecord::<Law>::new();
        let supervisor = Supervisor::new(&Law::LIMITS, &Law::SENSORS);
        let keep = |number| record.keep(&trip(number), &supervisor, &Kept(number));
        let mut words = [0; super::SUPERVISOR + 1];
        assert_eq!(record.read(&mut words), None);
        keep(1);
        assert_eq!(record.read(&mut words), Some(trip(1)));
        assert_eq!((words[5], words[super::SUPERVISOR]), (2048, 1));
        assert_eq!(record.read_while(|| keep(2)), None);
        assert_eq!(record.read(&mut words), Some(trip(2)));
        assert_eq!(words[super::SUPERVISOR], 2);
        assert_eq!(record.read_while(|| record.forget()), None);
        assert_eq!(record.read(&mut words), None);
        // What interrupts the writer finds a number that says so.
        keep(3);
        record.forget();
        assert_eq!(record.read(&mut words), None);
    }
}
