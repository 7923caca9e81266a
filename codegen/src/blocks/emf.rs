//! Functions of the rotor angle: flux tables behind the modelled EMF, and the proportional
//! reference (semantics, steps 6 and 8 and the section on tables).

use super::Lowering;
use super::number::round_half_up;
use super::rotor::Rotor;
use crate::design::emf::Parabolas;
use crate::design::vectors::SECTOR_CURRENT;
use crate::diagnostics::engineering;
use crate::interface::{FormatEntry, Rounding};
use crate::ir::{Exact, Expr, Lut, Named, Periodic, Phases, Real, named};
use crate::spec::{Spec, proportional_current, zero_sum_integral};

/// A third of a turn: phase b lags phase a by it.
const THIRD_TURN: i64 = 1_431_655_765;
/// Fraction bits of the proportional reference's table: its values stay below 4.
pub const SHAPE_BITS: u32 = 28;

/// A periodic function as tables of parabola coefficients.
#[derive(Clone, Copy, Debug)]
struct PeriodicTable<'b> {
    coefficients: [Lut<'b>; 3],
    segments: u32,
}

/// The flux linkage table and its fraction bits.
#[derive(Clone, Copy, Debug)]
struct FluxModel<'b> {
    table: PeriodicTable<'b>,
    frac_bits: u32,
    /// Largest plausible EMF, words of voltage: a power of two.
    limit: i64,
}

/// Index of the quasi-square reference's corner table.
#[derive(Clone, Copy, Debug)]
pub enum Corner<'b> {
    /// A sector, 0 to 6.
    Sector(Expr<'b>),
    /// A Hall code.
    HallCode(Expr<'b>),
}

/// Mean EMF of phases a and b over the target and the present period.
#[derive(Clone, Copy, Debug)]
pub struct ModelledEmf<'b> {
    /// Over the target period, in which the new command takes effect.
    pub target: Phases<'b>,
    /// Over the period that begins now.
    pub present: Phases<'b>,
}

impl<'b> PeriodicTable<'b> {
    fn new(
        l: &Lowering<'b>,
        name: &'static str,
        fit: &Parabolas,
        frac_bits: u32,
        [doc, error]: [&str; 2],
    ) -> Self {
        let scale = f64::from(frac_bits).exp2();
        let segments = fit.coefficients.len() as u32;
        // The constant coefficient, which is needed last, stands last.
        let coefficients = [2, 1, 0].map(|power| {
            let words = fit.coefficients.iter().map(|c| round_half_up(c[power] * scale) as i32);
            let lines = [
                format!("{doc}: coefficient of t^{power} in each of {segments} segments of a turn, t from -1/2 to 1/2."),
                String::new(),
                format!("{frac_bits} fraction bits; the parabolas are at most {error} off."),
            ];
            // Only the table of constant coefficients carries the error bound of the function.
            let periodic = (power == 0).then(|| Periodic {
                misfit: Real::of(fit.error * scale),
                slope: Real::of(fit.steepest() * f64::from(segments) * scale),
            });
            let exact = (Exact::Within(1), periodic);
            l.b.rounded_table(&format!("{name}_c{power}"), words.collect(), exact, &lines)
                .in_row(name)
        });
        l.note_format(FormatEntry {
            name: name.to_owned(),
            storage_bits: 32,
            frac_bits: frac_bits as i32,
            rounding: Rounding::RoundHalfUp,
            segments: Some(segments),
            meaning: format!("{doc}; a parabola over each of {segments} segments of a turn"),
        });
        Self {
            coefficients,
            segments,
        }
    }

    /// The function's value at an angle: c0 + t (c1 + t c2).
    fn at(&self, name: &str, angle: Expr<'b>) -> Expr<'b> {
        let [c2, c1, c0] = self.coefficients;
        let segment = angle.angle_index(self.segments);
        let segment = segment.named(&format!("{name}_segment"));
        let t = angle.angle_fraction(self.segments);
        let t = t.named(&format!("{name}_t"));
        let slope = c1.at(segment) + t.mul_floor(c2.at(segment), 32);
        (c0.at(segment) + t.mul_floor(slope, 32)).named(name)
    }
}

/// The angle of phase b, which lags that of phase a.
fn lagging<'b>(l: &Lowering<'b>, name: &str, theta: Expr<'b>) -> Expr<'b> {
    let exact = Exact::Number(Real::of(f64::from(32).exp2() / 3.0));
    let doc = "A third of a turn: phase b lags phase a by it.";
    let third = l.rounded_number("third_turn", THIRD_TURN, exact, doc);
    theta.angle_sub(third).named(name)
}

/// Angle `periods` control periods ahead, for `periods` 0, 1 or 2.
fn ahead<'b>(name: &str, rotor: &Rotor<'b>, periods: u32) -> Expr<'b> {
    let step = match periods {
        0 => return rotor.theta,
        1 => rotor.step_angle,
        _ => rotor.step_angle << 1,
    };
    rotor.theta.angle_add(step).named(name)
}

impl<'b> FluxModel<'b> {
    /// Prepares the flux table; its scale is the finest at which differences fit a word.
    fn new(l: &Lowering<'b>, e_limit: f64) -> Self {
        let (motor, inverter) = (&l.spec.motor, &l.spec.inverter);
        let shape = motor.emf_shape;
        let volts = motor.emf_constant
            / (f64::from(motor.pole_pairs) * inverter.t_s)
            / l.scale.volt_per_count;
        let unit = Parabolas::fit(|theta| zero_sum_integral(shape, theta), 1e-5);
        let scaled = unit.coefficients.iter().map(|c| c.map(|x| x * volts));
        let fit = Parabolas {
            coefficients: scaled.collect(),
            error: unit.error * volts,
        };
        // The sum of two values and a slope must fit a word: 2^29 for each.
        let frac_bits = (29.0 - fit.magnitude().log2()).floor().clamp(0.0, 28.0) as u32;
        if frac_bits < l.scale.voltage_bits {
            l.misfit("flux");
        }
        let doc = "Flux linkage of phase a over the period, in timer counts of bus voltage, over the electrical angle";
        let error = format!(
            "{:.1e} timer counts of voltage ({})",
            fit.error,
            engineering(fit.error * l.scale.volt_per_count, "V")
        );
        Self {
            table: PeriodicTable::new(l, "flux", &fit, frac_bits, [doc, &error]),
            frac_bits,
            limit: l.volts_word(e_limit),
        }
    }

    /// Flux linkage of phases a and b at an angle; `when` names it.
    fn at(&self, l: &Lowering<'b>, when: &str, theta: Expr<'b>) -> Phases<'b> {
        let theta_b = lagging(l, &format!("theta_{when}_b"), theta);
        Phases([
            self.table.at(&format!("flux_{when}_a"), theta),
            self.table.at(&format!("flux_{when}_b"), theta_b),
        ])
    }

    /// The mean EMF between two flux linkages.
    fn emf(&self, l: &Lowering<'b>, start: Phases<'b>, end: Phases<'b>) -> Phases<'b> {
        let doc = "Largest plausible EMF: one and a half times that of the greatest speed, up to the next power of two of timer counts";
        let change = end - start;
        let volts = match self.frac_bits.checked_sub(l.scale.voltage_bits) {
            None | Some(0) => change,
            Some(shift) => change >> shift,
        };
        let low = || l.voltage("e_model_min", -self.limit, doc);
        let high = || l.voltage("e_model_max", self.limit - 1, doc);
        volts.map(|volts| volts.clamp(low(), high()))
    }

    /// Flux linkage at the start of the target period, and the mean EMF over it.
    fn target(&self, l: &Lowering<'b>, rotor: &Rotor<'b>, delay: u32) -> [Phases<'b>; 2] {
        let start = ahead("theta_start", rotor, delay);
        let end = ahead("theta_end", rotor, delay + 1);
        let at_start = self.at(l, "start", start);
        let at_end = self.at(l, "end", end);
        [at_start, self.emf(l, at_start, at_end)]
    }
}

/// Mean EMF of phases a and b over the target period and, with delay 1, over the present one, from
/// differences of flux linkage. `e_limit`: the largest plausible EMF, volt.
pub fn model_emf<'b>(
    l: &Lowering<'b>,
    rotor: &Rotor<'b>,
    delay: u32,
    e_limit: f64,
) -> ModelledEmf<'b> {
    let flux = FluxModel::new(l, e_limit);
    l.b.stage(
        "model_emf",
        &[
            "Mean EMF over the target period (and the present one, for the prediction): the difference of",
            "flux linkage between end and start, which is exact for any shape and needs no speed factor.",
        ],
    );
    let [at_start, e] = flux.target(l, rotor, delay);
    named! {
        let e = e;
    }
    if delay == 0 {
        return ModelledEmf {
            target: e,
            present: e,
        };
    }
    let at_now = flux.at(l, "now", rotor.theta);
    named! {
        let e_now = flux.emf(l, at_now, at_start);
    }
    ModelledEmf {
        target: e,
        present: e_now,
    }
}

/// Mean EMF over the target period alone; phases a and b.
pub fn model_target_emf<'b>(
    l: &Lowering<'b>,
    rotor: &Rotor<'b>,
    delay: u32,
    e_limit: f64,
) -> Phases<'b> {
    let flux = FluxModel::new(l, e_limit);
    l.b.stage(
        "model_emf",
        &[
            "Mean EMF over the target period: the difference of flux linkage between end and start, which is",
            "exact for any shape and needs no speed factor.",
        ],
    );
    let [_, e_model] = flux.target(l, rotor, delay);
    named! {
        let e_model = e_model;
    }
    e_model
}

/// Above this product the error of an EMF is corrected along the EMF's own shape: the unevenness of the shape, times a
/// current over the largest set-point. The current is the one that the EMF of the greatest speed moves in a control period.
/// Below it an EMF constant 20 % off makes at most 4 % of ripple at rated speed (660 W motor: 0.11 and 3.0 %).
const UNEVEN: f64 = 0.15;

/// Whether the EMF's error is corrected along the EMF's own shape, and not along the current parallel to it.
fn is_stretched(spec: &Spec) -> bool {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let emf = motor.emf_constant * inverter.maximum_speed;
    let coarseness = emf * inverter.t_s / (motor.inductance * inverter.max_current);
    motor.emf_shape.unevenness() * coarseness > UNEVEN
}

/// Part by which an EMF is longer than along a [`ProportionalShape`].
#[derive(Clone, Copy, Debug)]
pub struct Stretch<'b> {
    value: Expr<'b>,
    frac_bits: u32,
}

impl<'b> Stretch<'b> {
    /// A component along the EMF, of one along the shape.
    pub fn of(self, along: Expr<'b>) -> Expr<'b> {
        along + along.mul_floor(self.value, self.frac_bits)
    }
}

/// Current per ampere of set-point that is parallel to the EMF.
#[derive(Clone, Copy, Debug)]
pub struct ProportionalShape<'b> {
    table: PeriodicTable<'b>,
    /// Angle at the end of the target period.
    pub theta: Expr<'b>,
    /// The current of phases a and b there.
    pub unit: Phases<'b>,
}

impl<'b> ProportionalShape<'b> {
    /// At the end of the target period; added to the open stage.
    pub fn new(l: &Lowering<'b>, rotor: &Rotor<'b>, delay: u32) -> Self {
        let motor = &l.spec.motor;
        let (shape, ratio) = (
            motor.emf_shape,
            l.spec.torque_constant() / motor.emf_constant,
        );
        let fit = Parabolas::fit(|theta| proportional_current(shape, ratio, theta), 1e-5);
        let doc = "Phase-a current per ampere of set-point that is parallel to the EMF, over the electrical angle";
        let error = format!("{:.1e} A per ampere of set-point", fit.error);
        let table = PeriodicTable::new(l, "shape", &fit, SHAPE_BITS, [doc, &error]);
        let theta = ahead("theta_ref", rotor, delay + 1);
        let theta_b = lagging(l, "theta_ref_b", theta);
        let unit = Phases([table.at("shape_a", theta), table.at("shape_b", theta_b)]);
        Self { table, theta, unit }
    }

    /// By what part an EMF is longer than along this shape, at its angle; none where that makes little ripple. Added to
    /// the open stage.
    pub fn stretch(&self, l: &Lowering<'b>) -> Option<Stretch<'b>> {
        if !is_stretched(l.spec) {
            return None;
        }
        let shape = l.spec.motor.emf_shape;
        // The mean is a scan over the turn, made once.
        let mean = shape.mean_inverse_square();
        let of = |theta| shape.squared_length(theta) * mean - 1.0;
        let fit = Parabolas::with_segments(&of, self.table.segments);
        // The sum of a value and a slope must fit a word.
        let frac_bits = (30.0 - fit.magnitude().log2()).floor().clamp(0.0, 32.0) as u32;
        let doc = "Part by which the EMF is longer than along the current parallel to it, over the electrical angle";
        let error = format!("{:.1e}", fit.error);
        let table = PeriodicTable::new(l, "stretch", &fit, frac_bits, [doc, &error]);
        Some(Stretch {
            value: table.at("stretch", self.theta),
            frac_bits,
        })
    }

    /// The current of phases a and b at another angle; `when` stands in the names of its values. Added to the open
    /// stage.
    pub fn at(&self, l: &Lowering<'b>, when: &str, theta: Expr<'b>) -> Phases<'b> {
        let theta_b = lagging(l, &format!("theta_{when}_b"), theta);
        Phases([
            self.table.at(&format!("shape_{when}_a"), theta),
            self.table.at(&format!("shape_{when}_b"), theta_b),
        ])
    }
}

/// The words with as many zero bits behind them, at most 32 less those of a shape, as still fit, and the shift that takes
/// both away: with all of them a product with a shape is an upper word. The words have these names.
pub fn lifted<'b, const N: usize>(words: [(&str, Expr<'b>); N]) -> ([Expr<'b>; N], u32) {
    // At a scale that is tried and rejected a word may be longer.
    let spare = words.map(|(_, word)| 32_u32.saturating_sub(word.interval().bits()));
    let bits = spare.into_iter().fold(32 - SHAPE_BITS, u32::min);
    let lifted = words.map(|(name, word)| match bits {
        0 => word,
        _ => (word << bits).named(name),
    });
    (lifted, SHAPE_BITS + bits)
}

/// Reference along a [`ProportionalShape`], as voltage words of phases a and b; added to the open
/// stage.
pub fn proportional_reference<'b>(shape: Phases<'b>, set_point: Expr<'b>) -> Phases<'b> {
    let ([lifted], shift) = lifted([("j_lifted", set_point)]);
    named! {
        let j = shape.map(|shape| lifted.mul_floor(shape, shift));
    }
    j
}

/// Reference at the sector's corner, as voltage words of phases a and b.
pub fn quasi_square_reference<'b>(
    l: &Lowering<'b>,
    at: Corner<'b>,
    set_point: Expr<'b>,
) -> Phases<'b> {
    let (row, index, places, by) = match at {
        Corner::Sector(sector) => ("sector", sector, [1, 2, 3, 4, 5, 6], "in sectors 1 to 6"),
        Corner::HallCode(code) => {
            let codes = l.spec.motor.upright_codes();
            let places = codes.map(|code| usize::from(code & 7));
            ("hall", code, places, "by Hall code")
        }
    };
    let corner = [0, 1].map(|phase| {
        let letter = ["a", "b"][phase];
        let mut signs = vec![0; 8];
        for (place, legs) in places.into_iter().zip(SECTOR_CURRENT) {
            signs[place] = legs[phase];
        }
        let doc = format!(
            "Sign of the phase-{letter} reference {by}: the conducting pair carries (+I, -I)."
        );
        l.b.column(row, &format!("corner_{letter}"), signs, &doc)
    });
    let doc =
        "Reference at the sector's corner, as a voltage: the set-point word with the phase's sign.";
    l.b.stage("reference_quasi_square", &[doc]);
    named! {
        let j = Phases(corner.map(|corner| corner.at(index) * set_point));
    }
    j
}
