//! The check of plant parameters.

use super::adc::full_scale;
use super::hall::EVEN_EDGES_DEG;
use super::{AdcChannel, EmfShape, Mechanics, PlantError, PlantParams, Short, Wiring};
use hexagen_codegen::diagnostics::engineering;
use std::collections::BTreeSet;

/// What a check found.
type Checked = Result<(), PlantError>;

fn require(
    ok: bool,
    name: &'static str,
    (value, unit): (f64, &'static str),
    limit: &str,
) -> Checked {
    if ok {
        return Ok(());
    }
    Err(PlantError::Range {
        name,
        value,
        unit,
        limit: limit.to_owned(),
    })
}

fn positive(name: &'static str, value: f64, unit: &'static str) -> Checked {
    let ok = value.is_finite() && value > 0.0;
    require(ok, name, (value, unit), "finite and positive")
}

fn not_negative(name: &'static str, value: f64, unit: &'static str) -> Checked {
    let ok = value.is_finite() && value >= 0.0;
    require(ok, name, (value, unit), "finite and not negative")
}

fn at_least_1(name: &'static str, count: u32) -> Checked {
    require(count > 0, name, (f64::from(count), ""), "at least 1")
}

impl PlantParams {
    /// Checks every field against the range its documentation states.
    ///
    /// # Errors
    /// The first field outside its range.
    pub fn check(&self) -> Result<(), PlantError> {
        self.check_motor()?;
        self.check_inverter()?;
        self.check_channels()?;
        self.check_wiring()?;
        self.check_halls()?;
        self.mechanics.map_or(Ok(()), check_mechanics)
    }

    fn check_motor(&self) -> Checked {
        at_least_1("pole_pairs", self.pole_pairs)?;
        for phase in 0..3 {
            not_negative("resistance", self.resistance[phase], "ohm")?;
            positive("inductance", self.inductance[phase], "H")?;
            not_negative("k_phase", self.k_phase[phase], "V s/rad")?;
        }
        let EmfShape::Trapezoidal { flat_top_deg } = self.shape else {
            return Ok(());
        };
        let in_range = (0.0..=179.0).contains(&flat_top_deg);
        let value = (flat_top_deg, "deg");
        require(in_range, "flat_top_deg", value, "0 to 179 degrees")
    }

    fn check_inverter(&self) -> Checked {
        positive("v_bus", self.v_bus, "V")?;
        positive("t_s", self.t_s, "s")?;
        at_least_1("timer_period", self.timer_period.into())?;
        at_least_1("pwm_per_control", self.pwm_per_control.into())?;
        let period = self.pwm_period();
        let dead_ok = (0.0..period / 2.0).contains(&self.dead_time);
        let limit = format!(
            "from 0 to below half the period of {}",
            engineering(period, "s")
        );
        require(dead_ok, "dead_time", (self.dead_time, "s"), &limit)?;
        not_negative("diode_drop", self.diode_drop, "V")
    }

    /// The channels in the order in which they are sampled.
    fn check_channels(&self) -> Checked {
        let period = self.pwm_period();
        let mut earliest = -period / 2.0;
        for channel in &self.adc {
            check_channel(channel)?;
            let ok = (earliest..period / 2.0).contains(&channel.instant);
            let limit = format!(
                "from {} to below half the period of {}",
                engineering(earliest, "s"),
                engineering(period, "s")
            );
            require(ok, "adc instant", (channel.instant, "s"), &limit)?;
            earliest = channel.instant;
        }
        let phases: BTreeSet<usize> = self.sensed.iter().copied().collect();
        let is_each_once = phases.len() == self.sensed.len() && phases.iter().all(|x| *x < 3);
        let ok = is_each_once && phases.len() >= 2 && phases.len() == self.adc.len();
        let value = (self.sensed.last().map_or(0.0, |x| *x as f64), "");
        let limit = "two or three different phases, 0 to 2, one of each channel";
        require(ok, "sensed", value, limit)
    }

    fn check_wiring(&self) -> Checked {
        let Wiring {
            mut windings,
            open,
            short,
            ..
        } = self.wiring;
        windings.sort_unstable();
        let stray = windings.iter().zip(0..).find(|&(&at, place)| at != place);
        let value = (stray.map_or(0.0, |(&at, _)| at as f64), "");
        let limit = "0, 1 and 2 in any order";
        require(stray.is_none(), "windings", value, limit)?;
        let is_there = |leg: usize| leg < 3 && !open[leg];
        let (ok, leg) = match short {
            None => return Ok(()),
            Some(Short::ToMinus(leg)) => (is_there(leg), leg),
            Some(Short::Legs([x, y])) => (is_there(x) && is_there(y) && x != y, y),
        };
        let limit = "a leg of its own, 0 to 2, whose wire is not open";
        require(ok, "short", (leg as f64, ""), limit)
    }

    fn check_halls(&self) -> Checked {
        for (edge, place) in self.hall_edges_deg.into_iter().zip(EVEN_EDGES_DEG) {
            let ok = (edge - place).abs() < 30.0;
            let limit = format!("within 30 degrees of {place}");
            require(ok, "hall_edges_deg", (edge, "deg"), &limit)?;
        }
        for error in self.hall_error_deg {
            let (ok, value) = (error.abs() < 30.0, (error, "deg"));
            require(
                ok,
                "hall_error_deg",
                value,
                "above -30 and below 30 degrees",
            )?;
        }
        positive("hall_ticks_per_period", self.hall_ticks_per_period, "")?;
        if let Some(angle) = self.angle {
            let (turns, bits) = (f64::from(angle.turns), f64::from(angle.bits));
            require(angle.turns != 0, "angle.turns", (turns, ""), "not 0")?;
            require(
                (1..=32).contains(&angle.bits),
                "angle.bits",
                (bits, ""),
                "1 to 32",
            )?;
        }
        for code in self.hall_codes {
            require(
                (0..=7).contains(&code),
                "hall code",
                (code.into(), ""),
                "0 to 7",
            )?;
        }
        Ok(())
    }
}

fn check_channel(channel: &AdcChannel) -> Checked {
    let bits = (f64::from(channel.bits), "");
    require(
        (1..=16).contains(&channel.bits),
        "adc bits",
        bits,
        "1 to 16",
    )?;
    let gain = channel.amperes_per_count;
    let gain_ok = gain.is_finite() && gain != 0.0;
    require(
        gain_ok,
        "adc amperes_per_count",
        (gain, "A"),
        "finite and not zero",
    )?;
    if let Some(most) = channel.most {
        positive("adc most", most, "A")?;
    }
    let counts = 0.0..=full_scale(channel.bits);
    let limit = format!("from 0 to {} counts", counts.end());
    for (name, value) in [("adc offset", channel.offset), ("adc noise", channel.noise)] {
        require(counts.contains(&value), name, (value, ""), &limit)?;
    }
    Ok(())
}

fn check_mechanics(mechanics: Mechanics) -> Checked {
    positive("inertia", mechanics.inertia, "kg m2")?;
    not_negative("opposing_torque", mechanics.opposing_torque, "Nm")?;
    let external = mechanics.external_torque;
    let value = (external, "Nm");
    require(external.is_finite(), "external_torque", value, "finite")?;
    not_negative("viscous", mechanics.viscous, "Nm s/rad")
}
