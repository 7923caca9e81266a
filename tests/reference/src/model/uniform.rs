//! The deadbeat voltage in one saturating 16-bit format of SI units, the same for every motor, as
//! with a fixed-point library that knows no motor: a comparison for the generated formats.
//!
//! Three pulsed legs, estimated EMF, delay 1, no advance (sections 6, 8 and 9). Every operation
//! rounds to the format and saturates.

use super::sector::{CORNER_A, CORNER_B};
use super::trace::{PhysicalState, Trace};
use super::variant::Variant;
use crate::emf_motion::EmfMotion;
use crate::{DiscretePhase, Error, Modulation, Reference, Spec};

/// One format for everything: 16 bits, with this many fraction bits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Format {
    /// 2^frac_bits.
    scale: f64,
}

impl Format {
    /// The nearest number of the format, ties up; saturates.
    fn round(self, x: f64) -> f64 {
        (x * self.scale + 0.5).floor().clamp(-32_768.0, 32_767.0) / self.scale
    }

    fn product(self, x: f64, y: f64) -> f64 {
        self.round(x * y)
    }
}

/// The deadbeat law of one motor in the common format.
#[derive(Clone, Debug)]
pub struct Uniform {
    format: Format,
    k: f64,
    k_hold: f64,
    resistance: f64,
    decay: f64,
    filter: f64,
    motion: EmfMotion,
    v_largest: f64,
}

impl Uniform {
    /// The law with its coefficients in the format with this many fraction bits; `None` for a drive
    /// with another law.
    ///
    /// # Errors
    /// If the specification is inconsistent.
    pub fn new(spec: &Spec, frac_bits: i32) -> Result<Option<Self>, Error> {
        let (variant, options) = (Variant::new(spec), spec.loop_options());
        let pulses_all = matches!(&spec.controller, crate::Controller::Pdcc(pdcc) if pdcc.modulation == Modulation::ThreePhase);
        if !(pulses_all
            && variant.estimated()
            && variant.delayed()
            && options.advance == 0.0
            && options.reference == Reference::QuasiSquare)
        {
            return Ok(None);
        }
        let DiscretePhase { a, b } = DiscretePhase::new(spec);
        let format = Format {
            scale: f64::from(frac_bits).exp2(),
        };
        Ok(Some(Self {
            format,
            k: format.round(1.0 / b),
            k_hold: format.round(a * a / b),
            resistance: format.round((1.0 - a) / b),
            decay: format.round(1.0 - a),
            filter: format.round(options.emf_filter),
            motion: EmfMotion::new(spec)?,
            v_largest: spec.inverter.v_bus_max()?,
        }))
    }

    /// The largest number of a motor in the format: its bus voltage, the current range of its ADCs,
    /// and the coefficients of the law. (The deadbeat voltage itself may saturate.)
    ///
    /// # Errors
    /// If the specification is inconsistent.
    pub fn largest(spec: &Spec) -> Result<f64, Error> {
        let inverter = &spec.inverter;
        let full = f64::from((1_u32 << inverter.adc_bits) - 1);
        let offset = f64::from(inverter.adc_offset.first());
        let current = offset.max(full - offset) * inverter.adc_gain.first().abs();
        let stiffness = 1.0 / DiscretePhase::new(spec).b;
        Ok(inverter.v_bus_max()?.max(current).max(stiffness))
    }

    /// The deadbeat voltage of phases a, b, volt: from the state before a step, the step's
    /// measurements, and the set-point in ampere.
    pub fn voltage(&self, before: &PhysicalState, measured: &Trace, set_point: f64) -> [f64; 2] {
        let q = self.format;
        let sector = measured.sector_eff;
        let corner = [CORNER_A[sector], CORNER_B[sector]];
        let both = |of: &dyn Fn(usize) -> f64| [of(0), of(1)];
        let i = measured.i.map(|i| q.round(i));
        let i_prev = before.i_prev.map(|i| q.round(i));
        let v_prev = before.v_prev.map(|v| q.round(v));
        let v_now = before.v_cmd.map(|v| q.round(v));
        let e_prev = before.e_prev.map(|e| q.round(e));
        let seen = both(&|x| {
            let rise = q.product(self.k, q.round(i[x] - i_prev[x]));
            let drop = q.product(self.resistance, i_prev[x]);
            q.round(q.round(v_prev[x] - rise) - drop)
        });
        let e_past = both(&|x| {
            let news = q.round(seen[x] - e_prev[x]);
            let e = q.round(e_prev[x] + q.product(self.filter, news));
            e.clamp(-self.v_largest, self.v_largest)
        });
        let [once, twice] = self.motions(corner, e_past);
        let e_now = both(&|x| q.round(e_past[x] + once[x]));
        let e = both(&|x| q.round(e_past[x] + twice[x]));
        let i_ref = q.round(set_point);
        both(&|x| {
            let wanted = q.product(self.k, corner[x] * i_ref);
            let held = q.product(self.k_hold, i[x]);
            let left = q.product(self.decay, q.round(v_now[x] - e_now[x]));
            let open = q.round(q.round(wanted - held) + left);
            q.round(q.round(open + q.round(e[x] + e_now[x])) - v_now[x])
        })
    }

    /// Motions of the EMF in one period and in two. Their coefficient is below the resolution of a
    /// format for voltages, so only the results are rounded here, in favour of the format.
    fn motions(&self, [p, q]: [f64; 2], [e_a, e_b]: [f64; 2]) -> [[f64; 2]; 2] {
        let limit = self.motion.line_limit.min(self.v_largest);
        let [line_a, line_b] = [2.0 * p + q, p + 2.0 * q];
        let line = (line_a * e_a + line_b * e_b).clamp(-limit, limit);
        let turn = self.motion.per_product * line;
        let rounded = |volts: [f64; 2]| volts.map(|volts| self.format.round(volts));
        if self.motion.turns {
            [1.0, 2.0].map(|periods| {
                let turn = periods * turn;
                // The axes of a and b are not at right angles: across and back is -3 times the
                // distance.
                rounded([
                    -turn * (e_a + 2.0 * e_b) - 1.5 * turn * turn * e_a,
                    turn * (2.0 * e_a + e_b) - 1.5 * turn * turn * e_b,
                ])
            })
        } else {
            let once = rounded([-line_b * line * turn, line_a * line * turn]);
            [once, once.map(|volts| 2.0 * volts)]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Format;

    #[test]
    fn numbers_are_rounded_to_the_format_and_saturate() {
        let q = Format { scale: 64.0 };
        for (x, rounded) in [
            (0.0, 0.0),
            (1.0 / 128.0, 1.0 / 64.0),
            (-1.0 / 128.0, 0.0),
            (511.99, 511.984_375),
            (1e6, 511.984_375),
            (-1e6, -512.0),
        ] {
            assert_eq!(q.round(x), rounded, "{x}");
        }
        assert_eq!(q.product(3.0, 0.135), 26.0 / 64.0);
    }
}
