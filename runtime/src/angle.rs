//! An angle sensor in place of Hall sensors.

use crate::Sample;

/// What the angle of a [`Sample`] has to do with the electrical angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AngleSensor {
    /// Electrical turns in a turn of the sensor; negative where its angle falls in forward rotation.
    pub turns: i32,
    /// Electrical angle at the sensor's angle 0, 2^32 per turn.
    pub offset: u32,
}

impl AngleSensor {
    /// Hall codes of sectors 1 to 6, four bits each, that of sector 1 lowest: those of a drive without
    /// `hall_codes`.
    pub const CODES: u32 = 0x0032_6451;

    /// Half a sector, rounded up: sector 1 begins there before angle 0.
    const HALF_SECTOR: u32 = 357_913_942;

    /// The sample with the electrical angle, and with the Hall code that sensors would show at it, to a
    /// resolution of 2^-16 of a turn: a [`Supervisor`](crate::Supervisor) knows rotors by their sectors.
    ///
    /// The checked sample gets the angle by [`Checked::with_angle_of`](crate::Checked::with_angle_of).
    ///
    /// A sample with a Hall code other than 0 has no angle: it gets a code that no sensors give, and trips the drive.
    #[inline]
    #[must_use]
    pub const fn resolve(&self, sample: &Sample) -> Sample {
        let turned = sample.angle.wrapping_mul(self.turns as u32);
        let angle = turned.wrapping_add(self.offset);
        // Six sectors, four bits of a code: no overflow, which also a build that is not optimised must see.
        let upper = angle.wrapping_add(Self::HALF_SECTOR) >> 16;
        let sector = upper.wrapping_mul(6) >> 16;
        let hall = if sample.hall == 0 {
            (Self::CODES.wrapping_shr(sector << 2) & 7) as u8
        } else {
            7
        };
        Sample {
            hall,
            angle,
            ..*sample
        }
    }
}

#[cfg(test)]
mod tests {
    use super::AngleSensor;
    use crate::Sample;

    const DEGREE: f64 = 4_294_967_296.0 / 360.0;

    fn resolved(sensor: AngleSensor, degrees: f64) -> Sample {
        let word = (degrees.rem_euclid(360.0) * DEGREE) as u32;
        sensor.resolve(&Sample::with_angle([2048; 2], word))
    }

    #[test]
    fn a_sector_has_the_code_of_sensors_in_their_places() {
        let electrical = AngleSensor {
            turns: 1,
            offset: 0,
        };
        for (sector, code) in [1, 5, 4, 6, 2, 3].into_iter().enumerate() {
            let begins = 60.0 * sector as f64 - 30.0;
            for inside in [0.01, 30.0, 59.99] {
                let sample = resolved(electrical, begins + inside);
                assert_eq!(sample.hall(), code, "{begins} + {inside}");
            }
        }
    }

    #[test]
    fn pole_pairs_direction_and_offset_make_the_electrical_angle() {
        let encoder = AngleSensor {
            turns: -7,
            offset: (20.0 * DEGREE) as u32,
        };
        let near = |sample: Sample, degrees: f64| {
            let wanted = (degrees.rem_euclid(360.0) * DEGREE) as u32;
            let off = sample.angle().wrapping_sub(wanted) as i32;
            assert!(off.abs() < 10, "{off} from {degrees}");
        };
        near(resolved(encoder, 0.0), 20.0);
        near(resolved(encoder, 10.0), -50.0);
        near(resolved(encoder, -60.0), 80.0);
    }

    #[test]
    fn a_hall_code_is_no_angle() {
        let electrical = AngleSensor {
            turns: 1,
            offset: 0,
        };
        let sample = Sample::with_hall([2048; 2], 0b101);
        assert_eq!(electrical.resolve(&sample).hall(), 7);
    }
}
