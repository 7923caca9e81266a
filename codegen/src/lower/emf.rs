//! Functions of the rotor angle: flux tables behind the modelled EMF, and the proportional reference
//! (semantics, steps 6 and 8 and the section on tables).

use super::Lowering;
use super::number::round_half_up;
use super::rotor::Rotor;
use crate::design::emf::{Parabolas, proportional_current, zero_sum_integral};
use crate::diagnostics::engineering;
use crate::interface::{FormatEntry, Rounding};
use crate::ir::{Exact, Interval, Periodic, Real, TableId, Value};

/// A third of a turn: phase b lags phase a by it.
const THIRD_TURN: i64 = 1_431_655_765;
/// Fraction bits of the proportional reference's table: its values stay below 4.
const SHAPE_BITS: u32 = 28;

/// A periodic function as tables of parabola coefficients.
#[derive(Clone, Copy, Debug)]
struct PeriodicTable {
    coefficients: [TableId; 3],
    segments: u32,
}

/// The flux linkage table and its fraction bits.
#[derive(Clone, Copy, Debug)]
pub struct FluxModel {
    table: PeriodicTable,
    frac_bits: u32,
}

/// What says where the quasi-square reference stands.
#[derive(Clone, Copy, Debug)]
pub enum Corner {
    /// A sector, 0 to 6.
    Sector(Value),
    /// A Hall code.
    HallCode(Value),
}

/// Mean EMF of phases a and b over two periods.
#[derive(Clone, Copy, Debug)]
pub struct ModelledEmf {
    /// Over the period in which the new command takes effect.
    pub target: [Value; 2],
    /// Over the period that begins now.
    pub present: [Value; 2],
}

impl Lowering<'_> {
    fn periodic_table(
        &mut self,
        name: &'static str,
        fit: &Parabolas,
        frac_bits: u32,
        [doc, error]: [&str; 2],
    ) -> PeriodicTable {
        let scale = f64::from(frac_bits).exp2();
        let segments = fit.coefficients.len() as u32;
        let coefficients = [0, 1, 2].map(|power| {
            let words = fit.coefficients.iter().map(|c| round_half_up(c[power] * scale) as i32).collect();
            let lines = [
                format!("{doc}: coefficient of t^{power} in each of {segments} segments of a turn, t from 0 to 1."),
                String::new(),
                format!("{frac_bits} fraction bits; the parabolas are at most {error} off."),
            ];
            // The first coefficients stand for the function, the others for its course within a segment.
            let periodic = (power == 0).then(|| Periodic {
                misfit: Real::of(fit.error * scale),
                slope: Real::of(fit.steepest() * f64::from(segments) * scale),
            });
            let exact = (Exact::Within(1), periodic);
            let table = self.b.program.rounded_table(&format!("{name}_c{power}"), words, exact, &lines);
            self.b.program.put_in_row(table, name);
            table
        });
        self.formats.push(FormatEntry {
            name: name.to_owned(),
            storage_bits: 32,
            frac_bits: frac_bits as i32,
            rounding: Rounding::RoundHalfUp,
            segments: Some(segments),
            meaning: format!("{doc}; a parabola over each of {segments} segments of a turn"),
        });
        PeriodicTable {
            coefficients,
            segments,
        }
    }

    fn evaluate(&mut self, name: &str, table: PeriodicTable, angle: Value) -> Value {
        let index = self.b.angle_index(angle, table.segments);
        self.b.name(&format!("{name}_segment"), index);
        let t = self.b.angle_fraction(angle, table.segments);
        self.b.name(&format!("{name}_t"), t);
        let c2 = self.b.lookup(table.coefficients[2], index);
        let slope = self.b.mul(t, c2, 31);
        let c1 = self.b.lookup(table.coefficients[1], index);
        let slope = self.b.add(c1, slope);
        let rise = self.b.mul(t, slope, 31);
        let c0 = self.b.lookup(table.coefficients[0], index);
        let value = self.b.add(c0, rise);
        self.b.name(name, value)
    }

    fn lagging(&mut self, name: &str, theta: Value) -> Value {
        let third = self.rounded_number(
            "third_turn",
            THIRD_TURN,
            Exact::Number(Real::of(f64::from(32).exp2() / 3.0)),
            "A third of a turn: phase b lags phase a by it.",
        );
        let lagged = self.b.angle_sub(theta, third);
        self.b.name(name, lagged)
    }

    /// Angle `periods` control periods ahead of now, for `periods` 0, 1 or 2.
    fn ahead(&mut self, name: &str, rotor: &Rotor, periods: u32) -> Value {
        let step = match periods {
            0 => return rotor.theta,
            1 => rotor.step_angle,
            _ => self.b.shift_left(rotor.step_angle, 1),
        };
        let angle = self.b.angle_add(rotor.theta, step);
        self.b.name(name, angle)
    }

    /// Prepares the flux table; its scale is the finest at which differences fit a word.
    pub fn flux_model(&mut self) -> FluxModel {
        let (motor, inverter) = (&self.spec.motor, &self.spec.inverter);
        let shape = motor.emf_shape;
        let volts = motor.emf_constant
            / (f64::from(motor.pole_pairs) * inverter.t_s)
            / self.scale.volt_per_count;
        let unit = Parabolas::fit(|theta| zero_sum_integral(shape, theta), 1e-5);
        let coefficients = unit
            .coefficients
            .iter()
            .map(|c| c.map(|x| x * volts))
            .collect();
        let fit = Parabolas {
            coefficients,
            error: unit.error * volts,
        };
        // Two values and a slope must fit one word together: 2^29 for each.
        let frac_bits = (29.0 - fit.magnitude().log2()).floor().clamp(0.0, 28.0) as u32;
        let doc = "Flux linkage of phase a over the period, in timer counts of bus voltage, over the electrical angle";
        let error = format!(
            "{:.1e} timer counts of voltage ({})",
            fit.error,
            engineering(fit.error * self.scale.volt_per_count, "V")
        );
        let table = self.periodic_table("flux", &fit, frac_bits, [doc, &error]);
        FluxModel { table, frac_bits }
    }

    /// Mean EMF over the target period and, with delay 1, over the present one, as differences of flux
    /// linkage at their ends; phases a and b.
    pub fn model_emf(
        &mut self,
        flux: FluxModel,
        rotor: &Rotor,
        delay: u32,
        e_limit: f64,
    ) -> ModelledEmf {
        if flux.frac_bits < self.scale.voltage_bits {
            self.misfits.push("flux".to_owned());
        }
        self.b.stage(
            "model_emf",
            &[
                "Mean EMF over the target period (and the present one, for the prediction): the difference of",
                "flux linkage between end and start, which is exact for any shape and needs no speed factor.",
            ],
        );
        let start = self.ahead("theta_start", rotor, delay);
        let end = self.ahead("theta_end", rotor, delay + 1);
        let at_start = self.flux_at(
            ["flux_start_a", "flux_start_b"],
            "theta_start_b",
            flux,
            start,
        );
        let at_end = self.flux_at(["flux_end_a", "flux_end_b"], "theta_end_b", flux, end);
        let target = self.emf_between(["e_a", "e_b"], flux, at_start, at_end, e_limit);
        let present = if delay == 0 {
            target
        } else {
            let at_now = self.flux_at(
                ["flux_now_a", "flux_now_b"],
                "theta_now_b",
                flux,
                rotor.theta,
            );
            self.emf_between(["e_a_now", "e_b_now"], flux, at_now, at_start, e_limit)
        };
        ModelledEmf { target, present }
    }

    fn flux_at(
        &mut self,
        names: [&str; 2],
        lagging: &str,
        flux: FluxModel,
        theta: Value,
    ) -> [Value; 2] {
        let theta_b = self.lagging(lagging, theta);
        [
            self.evaluate(names[0], flux.table, theta),
            self.evaluate(names[1], flux.table, theta_b),
        ]
    }

    fn emf_between(
        &mut self,
        names: [&str; 2],
        flux: FluxModel,
        starts: [Value; 2],
        ends: [Value; 2],
        e_limit: f64,
    ) -> [Value; 2] {
        let bits = self.scale.voltage_bits;
        let limit = self.volts_word(e_limit);
        [0, 1].map(|x| {
            let change = self.b.sub(ends[x], starts[x]);
            let volts = match flux.frac_bits.checked_sub(bits) {
                None | Some(0) => change,
                Some(shift) => self.b.shift_right(change, shift),
            };
            let doc =
                "Largest EMF that is believed, one and a half times that of the greatest speed";
            let e = self.within_volts(volts, "e_max", limit, doc);
            self.b.name(names[x], e)
        })
    }

    /// Reference parallel to the EMF at the end of the target period, as voltage words of phases a and b.
    pub fn proportional_reference(
        &mut self,
        rotor: &Rotor,
        set_point: Value,
        delay: u32,
    ) -> [Value; 2] {
        let motor = &self.spec.motor;
        let (shape, ratio) = (
            motor.emf_shape,
            self.spec.torque_constant() / motor.emf_constant,
        );
        let fit = Parabolas::fit(|theta| proportional_current(shape, ratio, theta), 1e-5);
        let doc = "Phase-a current per ampere of set-point that is parallel to the EMF, over the electrical angle";
        let error = format!("{:.1e} A per ampere of set-point", fit.error);
        let table = self.periodic_table("shape", &fit, SHAPE_BITS, [doc, &error]);
        self.b.stage(
            "reference_proportional",
            &["Reference parallel to the EMF at the end of the target period: constant torque at least copper loss."],
        );
        let theta = self.ahead("theta_ref", rotor, delay + 1);
        let angles = [theta, self.lagging("theta_ref_b", theta)];
        [0, 1].map(|x| {
            let current = self.evaluate(["shape_a", "shape_b"][x], table, angles[x]);
            let volts = self.b.mul(current, set_point, SHAPE_BITS);
            self.b.name(["j_a", "j_b"][x], volts)
        })
    }

    /// Reference at the sector's corner, as voltage words of phases a and b.
    pub fn quasi_square_reference(&mut self, at: Corner, set_point: Value) -> [Value; 2] {
        let (row, index, places, by) = match at {
            Corner::Sector(sector) => ("sector", sector, [1, 2, 3, 4, 5, 6], "in sectors 1 to 6"),
            Corner::HallCode(code) => (
                "hall",
                code,
                self.spec.motor.hall_codes.map(|code| usize::from(code & 7)),
                "by Hall code",
            ),
        };
        let tables = [("corner_a", "a"), ("corner_b", "b")];
        let tables = [0, 1].map(|phase| {
            let (name, letter) = tables[phase];
            let mut signs = vec![0; 8];
            for (place, legs) in places
                .into_iter()
                .zip(crate::design::vectors::SECTOR_CURRENT)
            {
                signs[place] = legs[phase];
            }
            let doc = format!(
                "Sign of the phase-{letter} reference {by}: the conducting pair carries (+I, -I)."
            );
            self.b.program.column(row, name, signs, &[doc])
        });
        self.b.stage("reference_quasi_square", &["Reference at the sector's corner, as a voltage: the set-point word, with the sign that the phase has there."]);
        [0, 1].map(|x| {
            let sign = self.b.lookup(tables[x], index);
            let volts = self.b.mul(sign, set_point, 0);
            self.b.name(["j_a", "j_b"][x], volts)
        })
    }

    /// The interval of a clamped signal, for state declared before the clamp is built.
    pub fn clamped(&self, volts: f64) -> Interval {
        Interval::symmetric(self.volts_word(volts))
    }
}
