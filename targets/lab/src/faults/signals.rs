//! The signals between plant and drive: samples as a broken sensor shows them.

use super::defect::{CurrentDefect, SignalDefect};
use crate::plant::PlantParams;
use hexagen::Sample;

/// Time between two disturbances of a Hall line, second.
const GLITCHES_EVERY: f64 = 20e-3;

/// The path of samples from plant to drive.
#[derive(Clone, Debug)]
pub(super) struct Signals {
    defect: Option<SignalDefect>,
    /// Count of zero current by phase.
    offsets: [f64; 3],
    full_scale: f64,
    ticks_per_period: f64,
    /// Half an electrical turn of the angle sensor, words of its angle; none with Hall sensors.
    half_turn: Option<u32>,
    /// Samples from one disturbance of a Hall line to the next.
    glitch_periods: usize,
    /// Samples since the defect.
    samples: usize,
    /// The last sample, as the drive saw it.
    last: Sample,
    /// Ticks since the last change of the code that the drive sees.
    ticks: f64,
    noise: fastrand::Rng,
}

impl Signals {
    /// Sound signals of a plant; `seed` distinguishes the noise of runs.
    pub(super) fn new(plant: &PlantParams, seed: u64) -> Self {
        let mut offsets = [0.0; 3];
        for (channel, phase) in plant.adc.iter().zip(plant.sensed.iter().copied()) {
            offsets[phase] = channel.offset;
        }
        Self {
            defect: None,
            offsets,
            full_scale: f64::from((1_u32 << plant.adc[0].bits) - 1),
            ticks_per_period: plant.hall_ticks_per_period,
            half_turn: (plant.angle).map(|sensor| (1 << 31) / sensor.turns.unsigned_abs()),
            glitch_periods: ((GLITCHES_EVERY / plant.t_s).round() as usize).max(1),
            samples: 0,
            last: Sample::default(),
            ticks: 0.0,
            noise: fastrand::Rng::with_seed(seed),
        }
    }

    /// From the next sample on this is broken.
    pub(super) fn break_down(&mut self, defect: SignalDefect) {
        self.defect = Some(defect);
    }

    /// The sample that the drive sees.
    pub(super) fn read(&mut self, sample: &Sample) -> Sample {
        let mut counts = sample.adc();
        let mut hall = sample.hall();
        if let Some(defect) = self.defect {
            counts = self.counts(defect, counts);
            hall = self.hall(defect, hall);
            self.samples += 1;
        }
        let ticks = match self.defect {
            Some(SignalDefect::EdgeTimer { ticks }) => ticks,
            _ => self.ticks_of(hall, sample),
        };
        let [adc_a, adc_b, adc_c] = counts;
        let read = match self.half_turn {
            None => Sample::with_hall([adc_a, adc_b], hall).hall_ticks(ticks),
            Some(half) => Sample::with_angle([adc_a, adc_b], self.angle(half, sample)),
        };
        self.last = read.third_current(adc_c);
        self.last
    }

    fn counts(&mut self, defect: SignalDefect, mut counts: [u16; 3]) -> [u16; 3] {
        match defect {
            SignalDefect::Current { phase, defect } => {
                let (count, zero) = (f64::from(counts[phase]), self.offsets[phase]);
                let shown = match defect {
                    CurrentDefect::StuckAtZero => zero,
                    CurrentDefect::StuckAtLast => f64::from(self.last.adc()[phase]),
                    CurrentDefect::StuckAtBottom => 0.0,
                    CurrentDefect::StuckAtTop => self.full_scale,
                    CurrentDefect::Gain(gain) => zero + gain * (count - zero),
                    CurrentDefect::Offset(share) => count + share * self.full_scale,
                    CurrentDefect::Noise(share) => {
                        let uniform = 2.0 * self.noise.f64() - 1.0;
                        count + share * self.full_scale * uniform
                    }
                };
                counts[phase] = shown.round().clamp(0.0, self.full_scale) as u16;
            }
            SignalDefect::CurrentsExchanged([first, second]) => counts.swap(first, second),
            _ => {}
        }
        counts
    }

    fn angle(&self, half_turn: u32, sample: &Sample) -> u32 {
        match self.defect {
            Some(SignalDefect::AngleStuck) => self.last.angle(),
            Some(SignalDefect::AngleJumps) if self.is_disturbed() => {
                sample.angle().wrapping_add(half_turn)
            }
            _ => sample.angle(),
        }
    }

    /// Whether a sample is disturbed by what disturbs one now and then.
    fn is_disturbed(&self) -> bool {
        self.samples.is_multiple_of(self.glitch_periods)
    }

    fn hall(&mut self, defect: SignalDefect, code: u8) -> u8 {
        let is_disturbed = self.is_disturbed();
        match defect {
            SignalDefect::HallStuck { line, is_high } => {
                let bit = 0b100 >> line;
                if is_high { code | bit } else { code & !bit }
            }
            SignalDefect::HallsExchanged => code & 1 | (code & 2) << 1 | (code & 4) >> 1,
            SignalDefect::HallFlips if is_disturbed => code ^ 1 << self.noise.u8(..3),
            SignalDefect::HallOpposite if is_disturbed => code ^ 0b111,
            _ => code,
        }
    }

    /// Ticks since the last edge that the drive could see: a stuck line has none, a disturbed one
    /// has more than the motor.
    fn ticks_of(&mut self, hall: u8, sample: &Sample) -> u16 {
        let of_motor = f64::from(sample.ticks());
        self.ticks = match self.defect {
            None => of_motor,
            Some(_) if hall == self.last.hall() => self.ticks + self.ticks_per_period,
            Some(_) if of_motor <= self.ticks_per_period => of_motor,
            // The code changed without an edge of the motor, somewhere in the last period.
            Some(_) => 0.5 * self.ticks_per_period,
        };
        self.ticks.min(f64::from(u16::MAX)) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signals() -> Signals {
        let plant = PlantParams::ideal(4, 0.135, 0.22e-3, 0.0824, 48.0, 50e-6);
        Signals::new(&plant, 1)
    }

    fn sample(hall: u8, ticks: u16) -> Sample {
        Sample::with_hall([2148, 2000], hall).hall_ticks(ticks)
    }

    fn counts(defect: CurrentDefect) -> [u16; 2] {
        let mut signals = signals();
        signals.read(&Sample::with_hall([2100, 2010], 1));
        signals.break_down(SignalDefect::Current { phase: 0, defect });
        let [a, b, _] = signals.read(&sample(1, 0)).adc();
        [a, b]
    }

    #[test]
    fn a_sensor_shows_what_its_defect_says_and_its_neighbour_the_truth() {
        for (defect, expected) in [
            (CurrentDefect::StuckAtZero, 2048),
            (CurrentDefect::StuckAtLast, 2100),
            (CurrentDefect::StuckAtBottom, 0),
            (CurrentDefect::StuckAtTop, 4095),
            (CurrentDefect::Gain(0.5), 2098),
            (CurrentDefect::Gain(-1.0), 1948),
            (CurrentDefect::Offset(0.1), 2558),
        ] {
            assert_eq!(counts(defect), [expected, 2000], "{defect:?}");
        }
    }

    #[test]
    fn noise_stays_within_its_amplitude_and_uses_it() {
        let mut signals = signals();
        let defect = CurrentDefect::Noise(0.05);
        signals.break_down(SignalDefect::Current { phase: 0, defect });
        let amplitude = 0.05 * 4095.0;
        let errors: Vec<f64> = (0..1000)
            .map(|_| f64::from(signals.read(&sample(1, 0)).adc()[0]) - 2148.0)
            .collect();
        assert!(errors.iter().all(|x| x.abs() <= amplitude + 0.5));
        let far = 0.9 * amplitude;
        assert!(errors.iter().any(|x| *x > far) && errors.iter().any(|x| *x < -far));
    }

    #[test]
    fn a_stuck_line_has_no_edges() {
        let mut signals = signals();
        signals.read(&sample(0b001, 40_000));
        signals.break_down(SignalDefect::HallStuck {
            line: 0,
            is_high: false,
        });
        // 001 to 101: the edge of Ha, which is stuck; then 100, the edge of Hc.
        let seen = [(0b101, 300), (0b101, 2100), (0b100, 900)].map(|(hall, ticks)| {
            let seen = signals.read(&sample(hall, ticks));
            (seen.hall(), seen.ticks())
        });
        assert_eq!(seen, [(0b001, 41_800), (0b001, 43_600), (0b000, 900)]);
    }

    #[test]
    fn a_disturbed_line_is_wrong_for_one_sample_every_20_ms() {
        let mut signals = signals();
        signals.break_down(SignalDefect::HallOpposite);
        let codes: Vec<u8> = (0..801)
            .map(|_| signals.read(&sample(0b001, 0)).hall())
            .collect();
        let wrong: Vec<usize> = (0..801).filter(|&k| codes[k] != 0b001).collect();
        assert_eq!(wrong, [0, 400, 800]);
        assert_eq!(codes[400], 0b110);
    }

    #[test]
    fn exchanged_lines_keep_the_third() {
        let mut signals = signals();
        signals.break_down(SignalDefect::HallsExchanged);
        for (code, seen) in [
            (0b100, 0b010),
            (0b010, 0b100),
            (0b001, 0b001),
            (0b101, 0b011),
        ] {
            assert_eq!(signals.read(&sample(code, 0)).hall(), seen);
        }
    }
}
