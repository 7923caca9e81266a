//! ADC counts to phase currents, Hall code to sector (semantics, steps 1 and 2).

use super::Lowering;
use crate::ir::{Comparison, Interval, StateId, Value};

/// What was sampled, and whether it says anything.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// ADC counts of phases a and b as they came.
    pub adc: [Value; 2],
    /// The Hall code; 7 for more, which no sensors give.
    pub hall: Value,
    /// Sector that it names, 0 for an invalid code.
    pub sector: Value,
    /// Flag: a converter is at an end of its range, as far as the trip level does not tell: count 0 or the largest, or
    /// only more than that. None where no count can be.
    pub out_of_range: Option<Value>,
    /// Flag: the Hall code is invalid.
    pub no_hall: Value,
}

/// Phase currents of this sample, in words of current.
#[derive(Clone, Copy, Debug)]
pub struct Currents {
    /// ADC counts of phases a and b, limited to the converter's range.
    pub counts: [Value; 2],
    /// Currents of phases a, b, c.
    pub phases: [Value; 3],
}

/// Sector and edge of this sample.
#[derive(Clone, Copy, Debug)]
pub struct Hall {
    /// Sector in force: the last valid one where the code is invalid; 0 before the first.
    pub sector: Value,
    /// Sector of the last sample.
    pub sector_prev: Value,
    /// The state word of that.
    pub sector_prev_word: StateId,
    /// Flag: the sector is not the last sample's, which may have had none.
    pub changed: Value,
    /// Flag: the sector changed.
    pub edge: Value,
}

const ADC_MAX: &str = "Largest count of the phase-current converters.";

impl Lowering<'_> {
    /// The sample, and whether it is one to control by.
    pub fn read_sample(&mut self) -> Sample {
        self.b.stage(
            "read_sample",
            &[
                "Whether the sample says anything: a converter at an end of its range (count 0, the largest, or more) and an invalid",
                "Hall code (000, 111 and above) trip the drive. Counts that say a current above the trip level are not looked at here.",
            ],
        );
        let word = Interval::new(0, i64::from(u16::MAX));
        let adc = [
            self.b
                .input("adc_a", word, "Phase-a current into the motor, ADC count."),
            self.b
                .input("adc_b", word, "Phase-b current into the motor, ADC count."),
        ];
        let out_of_range = if !self.trip_tells_ends() {
            let at_end = self.at_end(adc);
            Some(self.b.name("out_of_range", at_end))
        } else if self.spec.inverter.adc_bits < 16 {
            let beyond = adc.map(|count| {
                let limit = self.adc_max();
                self.b.compare(Comparison::Less, limit, count)
            });
            let beyond = self.b.or(beyond[0], beyond[1]);
            Some(self.b.name("out_of_range", beyond))
        } else {
            None
        };
        let hall = self.b.input(
            "hall",
            Interval::new(0, 255),
            "Hall code, Ha in bit 2; sectors and forward direction in the type's documentation.",
        );
        let greatest = self.b.literal(7);
        let hall = self.b.min(hall, greatest);
        self.b.name("hall_code", hall);
        let sectors = self.hall_sectors();
        let decode = self.b.program.column(
            "hall",
            "hall_sector",
            sectors.to_vec(),
            &["Sector 1 to 6 of a Hall code; 0 for the codes that cannot be.".to_owned()],
        );
        let sector = self.b.lookup(decode, hall);
        self.b.name("sector_seen", sector);
        let zero = self.zero();
        let no_hall = self.b.compare(Comparison::Equal, sector, zero);
        self.b.name("no_hall", no_hall);
        Sample {
            adc,
            hall,
            sector,
            out_of_range,
            no_hall,
        }
    }

    /// Sector 1 to 6 by Hall code; 0 for the codes that cannot be.
    pub(super) fn hall_sectors(&self) -> [i32; 8] {
        let mut sectors = [0; 8];
        for (sector, &code) in (1..).zip(&self.spec.motor.hall_codes) {
            sectors[usize::from(code & 7)] = sector;
        }
        sectors
    }

    /// Whether a converter at an end of its range says a current above the trip level, whatever its offset.
    fn trip_tells_ends(&self) -> bool {
        self.ampere_word(self.spec.inverter.trip_current) < self.current_at_ends()
    }

    /// Flag: a count is 0, the largest, or more.
    pub fn at_end(&mut self, adc: [Value; 2]) -> Value {
        let ends = adc.map(|count| {
            let zero = self.zero();
            let bottom = self.b.compare(Comparison::Equal, count, zero);
            let limit = self.adc_max();
            let ceiling = self.b.compare(Comparison::LessEqual, limit, count);
            self.b.or(bottom, ceiling)
        });
        self.b.or(ends[0], ends[1])
    }

    fn adc_max(&mut self) -> Value {
        let top = (1 << self.spec.inverter.adc_bits) - 1;
        self.number("adc_max", top, ADC_MAX)
    }

    /// Currents from ADC counts and the offset words.
    pub fn measure(&mut self, sample: &Sample, offsets: [StateId; 2]) -> Currents {
        let inverter = &self.spec.inverter;
        let (bits, inverted) = (inverter.adc_bits, inverter.adc_gain < 0.0);
        let shift = self.scale.current_bits;
        self.b.stage(
            "measure_currents",
            &["Phase currents from ADC counts less offset; the third from Kirchhoff's law."],
        );
        let counts = if bits == 16 {
            sample.adc
        } else {
            let names = ["count_a", "count_b"];
            [0, 1].map(|x| {
                let limit = self.adc_max();
                let count = self.b.min(sample.adc[x], limit);
                self.b.name(names[x], count)
            })
        };
        let names = ["i_a", "i_b"];
        let [a, b] = [0, 1].map(|x| {
            let offset = self.b.state(offsets[x]);
            let scaled = self.b.shift_left(counts[x], shift);
            let current = if inverted {
                self.b.sub(offset, scaled)
            } else {
                self.b.sub(scaled, offset)
            };
            self.b.name(names[x], current)
        });
        let c = self.third_phase("i_c", a, b);
        Currents {
            counts,
            phases: [a, b, c],
        }
    }

    /// Sector and edge.
    pub fn find_sector(&mut self, sample: &Sample, word: StateId) -> Hall {
        self.b.stage(
            "find_sector",
            &["Sector from the Hall code; at rest an invalid code keeps the last sector."],
        );
        let sector_prev = self.b.state(word);
        let sector = self.b.select(sample.no_hall, sector_prev, sample.sector);
        self.b.name("sector", sector);
        let [changed, edge] = self.compare_sectors(sector, sector_prev);
        self.b.name("sector_changed", changed);
        self.b.name("edge", edge);
        Hall {
            sector,
            sector_prev,
            sector_prev_word: word,
            changed,
            edge,
        }
    }

    /// Flags, added to the open stage: the sector is not the last sample's, which may have had none (0); and it is another.
    pub(super) fn compare_sectors(&mut self, sector: Value, sector_prev: Value) -> [Value; 2] {
        let different = self.b.compare(Comparison::NotEqual, sector, sector_prev);
        let zero = self.zero();
        let known = self.b.compare(Comparison::NotEqual, sector_prev, zero);
        [different, self.b.and(different, known)]
    }
}
