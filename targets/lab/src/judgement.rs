//! Whether and how well a drive will work: the verdict of `hexagen check` and of a report.
//!
//! The drive runs on the simulated motor slowly, at rated speed, and there at the least bus voltage where
//! one is stated.

use crate::closed_loop::Trip;
use crate::engine::Prepared;
use crate::motors::greatest_ripple;
use crate::plant::PlantError;
use crate::text::significant;
use crate::times::Time;
use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::spec::Envelope;
use hexagen_codegen::spec::{BusSource, RotorSensing, Spec};
use hexagen_codegen::timing::StepTime;
use serde::Serialize;

/// Speeds of the runs over the rated one.
const SPEEDS: [f64; 2] = [0.2, 1.0];

/// Least torque at rated speed of a drive that works, percent; with a limit of the bus current, which is
/// meant to cut it, half.
const LEAST_TORQUE: f64 = 90.0;
const LEAST_LIMITED: f64 = 50.0;

/// Greatest ripple of a drive that works, peak to peak in percent of the mean.
const GREATEST_RIPPLE: f64 = 50.0;

/// Whether a limit of the bus current cuts the torque: the mean current is near it, ampere.
pub fn limit_acts(most: f64, current: f64) -> bool {
    current >= 0.9 * most
}

/// Torque against the demand that counts as braking, percent of it.
const BRAKES: f64 = 1.0;

/// Least part of the demanded torque that counts as all of it, percent. `limit`, which looks for the speed
/// where the torque ends, takes 97 %.
const HELD: f64 = 99.0;

/// A speed just below the rated one, over that.
const JUST_BELOW: f64 = 0.985;

/// Torque that two runs may differ by and count as alike, percent of the demand.
const ALIKE: f64 = 2.0;

/// Fewest ADC counts of the rated current for a smooth current.
const COUNTS: f64 = 200.0;

/// Part of the inverter's voltage from which on a rating takes all of it.
const FULL_BUS: f64 = 0.97;

/// Least part of the bus that a rating takes; below it the EMF constant or the speed is likely wrong.
const LEAST_OF_BUS: f64 = 0.2;

/// Part of the control period from which on a step leaves too little of it for anything else, percent.
const FULL: f64 = 90.0;

/// A run at one speed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Mechanical speed, rpm.
    pub rpm: f64,
    /// Bus voltage, volt.
    pub bus_v: f64,
    /// Mean torque over the demanded one, percent; none for a drive that trips.
    pub torque_pct: Option<f64>,
    /// Ripple of the torque, peak to peak in percent of its mean.
    pub ripple_pp_pct: Option<f64>,
    /// Mean current drawn from the bus, ampere; negative: returned.
    pub bus_current_a: Option<f64>,
    /// Turn-ons per switch and second, mean of the six, hertz.
    pub switching_hz: Option<f64>,
    /// Trip.
    pub tripped: Option<Trip>,
}

/// An option that a rule chose.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chosen {
    /// Option.
    pub option: &'static str,
    /// Value.
    pub value: String,
    /// Why.
    pub reason: &'static str,
}

/// What was found about a drive.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// Name of the motor.
    pub motor: String,
    /// Controller variant.
    pub controller: String,
    /// Whether it neither trips on its nominal bus nor loses much of its torque up to rated speed, and its
    /// step in control ends within the period on the core that is named.
    pub works: bool,
    /// The verdict in words.
    pub verdict: String,
    /// Demanded torque, Nm.
    pub torque_nm: f64,
    /// Peak of a phase current at that torque, ampere.
    pub peak_a: f64,
    /// Torque of `max_current`, Nm.
    pub greatest_torque_nm: f64,
    /// Speed up to which the bus drives its whole current, rpm; none where it does not at standstill.
    pub greatest_torque_rpm: Option<f64>,
    /// Greatest voltage between two legs that the demanded torque takes at rated speed, volt.
    pub rating_v: f64,
    /// Greatest voltage that the inverter makes between two legs, volt.
    pub reach_v: f64,
    /// Speed up to which the bus drives the whole current of the demanded torque, rpm.
    pub envelope_rpm: f64,
    /// Bus voltage that the EMF is compared with, volt: the file's `bus_min`, else the nominal one.
    pub emf_bus_v: f64,
    /// Speed from which on the EMF between two terminals exceeds it, rpm.
    pub emf_bus_rpm: f64,
    /// The stated `over_speed` or, without one, the stated `maximum_speed`, with its name, rpm; none with field weakening.
    #[serde(skip)]
    pub highest_speed: Option<(&'static str, f64)>,
    /// ADC counts of the rated current.
    pub rated_counts: f64,
    /// Greatest current drawn from the bus, ampere, where it is limited.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bus_current_limit_a: Option<f64>,
    /// Greatest current returned to it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub return_current_limit_a: Option<f64>,
    /// Current that the demanded torque returns to the bus in braking at rated speed, ampere, where the drive does not
    /// measure its voltage; none where the windings take all of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unwatched_return_a: Option<f64>,
    /// Voltages of a measured bus at which the drive trips and its braking fades, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bus_levels: Option<String>,
    /// Options that nobody stated, with the value that a rule chose; not those of any number.
    pub chosen: Vec<Chosen>,
    /// Runs: slow, at rated speed, and there at the least bus voltage where `bus_min` is stated.
    pub points: Vec<Point>,
    /// The run at a speed that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asked: Option<Point>,
    /// Time of a step, by chip.
    pub step: Vec<Time>,
    /// Whether a step may take longer than the control period on the core that is named; the runs leave
    /// its time out.
    pub overruns: bool,
    /// Warnings of the generator.
    pub warnings: Vec<String>,
}

impl Judgement {
    /// Runs a drive with its demanded torque.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn of(drive: &Prepared) -> Result<Self, PlantError> {
        let (motor, inverter) = (&drive.spec.motor, &drive.spec.inverter);
        let [slow, rated] = SPEEDS.map(|share| share * motor.rated_speed);
        let mut points = vec![
            at_speed(drive, slow, inverter.v_bus)?,
            at_rating(drive, rated, inverter.v_bus)?,
        ];
        if let Some(least) = drive.least_bus {
            points.push(at_speed(drive, rated, least)?);
        }
        let envelope = Envelope::of(&drive.spec);
        let (torque, greatest) = (drive.demand(), drive.reach());
        let set_point = torque / envelope.torque_constant();
        let rpm = |omega_m: f64| omega_m * 30.0 / std::f64::consts::PI;
        let times = &drive.generated.interface.times;
        let emf_bus_v = drive
            .least_bus
            .map_or(inverter.v_bus, |_| inverter.lowest_bus());
        let per_speed = motor.emf_constant * motor.emf_shape.line_to_line_peak();
        let weakens = drive.spec.controller.common().field_weakening;
        let mut judgement = Self {
            motor: drive.motor.clone(),
            controller: drive.variant.clone(),
            works: true,
            verdict: String::new(),
            torque_nm: torque,
            peak_a: set_point * envelope.emf_shape.current_peak(envelope.reference),
            greatest_torque_nm: greatest,
            greatest_torque_rpm: envelope.speed(greatest).map(rpm),
            rating_v: envelope.bus_voltage(motor.rated_speed, set_point) * envelope.reach,
            reach_v: inverter.v_bus * envelope.reach,
            envelope_rpm: rpm(envelope.speed(torque).unwrap_or(0.0)),
            emf_bus_v,
            emf_bus_rpm: rpm(emf_bus_v / per_speed),
            highest_speed: drive
                .highest_speed
                .filter(|_| !weakens)
                .map(|(field, speed)| (field, rpm(speed))),
            rated_counts: motor.rated_current / inverter.adc_gain.abs(),
            bus_current_limit_a: inverter.bus_currents.drawn,
            return_current_limit_a: inverter.bus_currents.returned,
            unwatched_return_a: unwatched_return(drive)?,
            bus_levels: bus_levels(drive, [emf_bus_v, rpm(emf_bus_v / per_speed)]),
            chosen: chosen(drive),
            points,
            asked: None,
            step: times.iter().map(Time::from).collect(),
            overruns: times.iter().any(StepTime::is_too_long),
            warnings: drive.warnings.clone(),
        };
        (judgement.works, judgement.verdict) = judgement.judge(drive);
        Ok(judgement)
    }

    /// Adds a run at a speed in rpm, on the nominal bus; it does not change the verdict.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn ask(&mut self, drive: &Prepared, rpm: f64) -> Result<(), PlantError> {
        let omega_m = rpm * std::f64::consts::PI / 30.0;
        self.asked = Some(at_speed(drive, omega_m, drive.spec.inverter.v_bus)?);
        Ok(())
    }

    /// The limits of the bus current, where there are any.
    pub fn bus_limits(&self) -> Option<String> {
        let limits = [
            (self.bus_current_limit_a, "drawn from the bus"),
            (self.return_current_limit_a, "returned to it"),
        ];
        let limits = limits.into_iter().filter_map(|(most, way)| {
            let most = engineering(most?, "A");
            Some(format!("{most} {way}"))
        });
        let limits: Vec<String> = limits.collect();
        let currents = (!limits.is_empty()).then(|| format!("at most {}", limits.join(", ")));
        let parts = currents.into_iter().chain(self.bus_levels.clone());
        let parts: Vec<String> = parts.collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    /// The error of a drive that does not work.
    pub fn failure(&self) -> Option<String> {
        (!self.works).then(|| format!("error: {}", self.verdict))
    }

    /// The runs on the nominal bus, and that at the least bus voltage, if there is one.
    pub fn runs(&self) -> (&[Point], &[Point]) {
        self.points.split_at(SPEEDS.len().min(self.points.len()))
    }

    /// The run at rated speed on the nominal bus.
    pub fn rated(&self) -> Option<&Point> {
        let (nominal, _) = self.runs();
        nominal.last()
    }

    fn judge(&self, drive: &Prepared) -> (bool, String) {
        let (nominal, lowest) = self.runs();
        if let Some(trip) = nominal.iter().find_map(|point| point.tripped) {
            let long = drive.spec.long_period().map(|text| format!("; {text}"));
            let long = long.unwrap_or_default();
            return (false, format!("does not work: {trip}{long}"));
        }
        let [slow, rated] = nominal else {
            return (false, "does not work: it was not run".to_owned());
        };
        let times = &drive.generated.interface.times;
        let named = times.iter().find(|time| time.is_named);
        let longest = named.map(longest_step);
        if let Some(in_control) = named.and_then(too_long_in_control) {
            return (false, format!("does not work: {in_control}"));
        }
        let slowly = format!("at {:.0} rpm {}", slow.rpm, self.left(slow));
        let least = match self.bus_current_limit_a {
            Some(_) => LEAST_LIMITED,
            None => LEAST_TORQUE,
        };
        if slow.torque_pct.unwrap_or(0.0) < least {
            return (false, format!("does not work: even {slowly}"));
        }
        let left = format!("at rated speed {}", self.left(rated));
        if rated.torque_pct.unwrap_or(0.0) < least {
            return (false, format!("does not hold its rating: {left}"));
        }
        if let Some((_, text)) = self
            .rippling(&drive.spec)
            .filter(|(ripple, _)| *ripple > GREATEST_RIPPLE)
        {
            return (false, format!("does not hold its rating: {text}"));
        }
        let returned_most = self.return_current_limit_a;
        // What endangers comes first: of many clauses the last are cut.
        let mut buts: Vec<String> = lowest
            .iter()
            .filter(|point| point.is_braked())
            .filter_map(|point| point.lost_on_bus(returned_most))
            .collect();
        buts.extend(self.emf_beyond_bus());
        if self.torque_nm < HELD / 100.0 * drive.rated_torque() {
            buts.push(format!(
                "`max_current` allows {} of the rated {} only",
                engineering(self.torque_nm, "Nm"),
                engineering(drive.rated_torque(), "Nm")
            ));
        }
        if !slow.is_held() {
            buts.push(slowly);
        }
        if !rated.is_held() {
            buts.push(left);
        }
        buts.extend(
            lowest
                .iter()
                .filter(|point| !point.is_braked())
                .filter_map(|point| point.lost_on_bus(returned_most)),
        );
        buts.extend(self.ripples(&drive.spec));
        if self.rated_counts < COUNTS {
            let counts = significant(self.rated_counts, 3);
            buts.push(format!("rated current is {counts} ADC counts only"));
        }
        let bus = drive.spec.inverter.v_bus;
        if self.rating_v < LEAST_OF_BUS * bus {
            buts.push(format!(
                "the rating takes only {} of the bus of {}: check EMF constant and speed, or take a lower bus",
                engineering(self.rating_v, "V"),
                engineering(bus, "V")
            ));
        }
        buts.extend(longest.flatten());
        if !self.warnings.is_empty() {
            buts.push("see the warnings".to_owned());
        }
        let verdict = if buts.is_empty() {
            "works: it holds its torque at rated speed".to_owned()
        } else {
            format!("works, but {}", buts.join("; "))
        };
        (true, verdict)
    }

    /// What is told of a stated speed beyond that at which the EMF is the bus voltage.
    fn emf_beyond_bus(&self) -> Option<String> {
        let (field, most) = self.highest_speed?;
        (most > self.emf_bus_rpm).then(|| {
            format!(
                "from {} rpm on the EMF exceeds a bus of {} and brakes, whatever is asked, below `{field}` of {} rpm",
                self.emf_bus_rpm.floor(),
                engineering(self.emf_bus_v, "V"),
                most.floor(),
            )
        })
    }

    /// What is told of the greatest ripple on the nominal bus, if it is worth a word.
    pub fn ripples(&self, spec: &Spec) -> Option<String> {
        self.rippling(spec).map(|(_, text)| text)
    }

    /// The greatest ripple on the nominal bus, percent and in words, if it is more than that of a default drive with
    /// edges measured by a timer.
    fn rippling(&self, spec: &Spec) -> Option<(f64, String)> {
        let (nominal, _) = self.runs();
        let ripples = nominal
            .iter()
            .filter_map(|point| Some((point.rpm, point.ripple_pp_pct?)));
        let (rpm, ripple) = ripples.max_by(|(_, one), (_, other)| one.total_cmp(other))?;
        let is_sampled = spec.inverter.rotor_sensing == RotorSensing::SampledHalls;
        let finer = if spec.controller.modulates() && is_sampled {
            " (a timer of the edges, `hall_timer_clock`, may lower it)"
        } else {
            ""
        };
        let text = format!(
            "the torque ripples by {} % at {rpm:.0} rpm{finer}",
            significant(ripple, 2)
        );
        (ripple > greatest_ripple(spec)).then_some((ripple, text))
    }

    /// What is left of the torque at a speed, and what takes the rest.
    fn left(&self, point: &Point) -> String {
        let torque = significant(point.torque_pct.unwrap_or(0.0), 3);
        let is_rated = self.rated() == Some(point);
        let is_full = is_rated && self.rating_v > FULL_BUS * self.reach_v;
        let what = if point.rpm < self.envelope_rpm && !is_full {
            // The bus drives the whole current of the reference between its commutations.
            return format!("{torque} % of the demand, though the bus has room");
        } else if self
            .bus_current_limit_a
            .zip(point.bus_current_a)
            .is_some_and(|(most, drawn)| limit_acts(most, drawn))
        {
            "the limit of the bus current leaves"
        } else {
            "the bus leaves"
        };
        format!("{what} {torque} % of the demand")
    }
}

impl Point {
    /// What is told of a run at the least bus voltage, where it does not hold the torque.
    fn lost_on_bus(&self, returned_most: Option<f64>) -> Option<String> {
        let bus = engineering(self.bus_v, "V");
        match self.torque_pct {
            _ if self.is_held() => None,
            Some(torque) if torque > 0.0 => {
                let torque = significant(torque, 3);
                Some(format!(
                    "on a bus of {bus} it makes {torque} % of the demand at rated speed"
                ))
            }
            Some(torque) if self.is_braked() => {
                let torque = significant(-torque, 3);
                let returned = -self.bus_current_a.unwrap_or(0.0);
                let beyond = returned_most.filter(|most| returned > *most).map(|most| {
                    let most = engineering(most, "A");
                    format!(", above `return_current_limit` of {most}")
                });
                Some(format!(
                    "on a bus of {bus} its EMF brakes it at rated speed with {torque} % of the demand, whatever is asked, and returns {}{}",
                    engineering(returned, "A"),
                    beyond.unwrap_or_default()
                ))
            }
            _ => Some(format!("a bus of {bus} does not drive it at rated speed")),
        }
    }

    /// Whether the EMF exceeds the voltage of the bus and brakes.
    fn is_braked(&self) -> bool {
        self.torque_pct.is_some_and(|torque| torque < -BRAKES)
    }

    fn is_held(&self) -> bool {
        self.torque_pct.is_some_and(|torque| torque >= HELD)
    }
}

/// What is told of a step whose longest path takes most of the control period, or more.
fn longest_step(time: &StepTime) -> Option<String> {
    let percent = time.percent_of_period(time.most_cycles() as u32);
    (percent > FULL).then(|| format!("a step may take {percent} % of the period"))
}

/// What is told of a step that in control, not only in start and trips, takes longer than the control period.
fn too_long_in_control(time: &StepTime) -> Option<String> {
    let percent = time.percent_of_period(time.told().control_cycles);
    (percent > 100.0).then(|| format!("a step in control may take {percent} % of the period"))
}

/// A limit of the bus over its nominal voltage within which a battery may come to it.
const NEAR: f64 = 0.1;

/// Current that braking with the demanded torque at rated speed returns to a bus that is not measured, ampere.
fn unwatched_return(drive: &Prepared) -> Result<Option<f64>, PlantError> {
    let inverter = &drive.spec.inverter;
    if inverter.bus != BusSource::Fixed {
        return Ok(None);
    }
    let speed = drive.spec.motor.rated_speed;
    let braking = drive.measure_on_bus(speed, -drive.demand(), inverter.v_bus)?;
    let returned = braking.figures.bus_current_a.map(|drawn| -drawn);
    Ok(returned.filter(|returned| *returned > 0.0 && braking.tripped.is_none()))
}

/// Where the drive trips by the voltage of a measured bus, and where its braking fades. Limits near the nominal voltage
/// that nobody stated are told as such. `emf`: a voltage in volt, and the speed in rpm at which the EMF reaches it.
fn bus_levels(drive: &Prepared, emf: [f64; 2]) -> Option<String> {
    let inverter = &drive.spec.inverter;
    let BusSource::Measured {
        under,
        over,
        braking,
        min,
        max,
        ..
    } = inverter.bus
    else {
        return None;
    };
    let volts = |level: f64| engineering(level, "V");
    let [below, above] = [("below", under), ("above", over)]
        .map(|(side, level)| (level > 0.0).then(|| format!("{side} {}", volts(level))));
    let levels: Vec<String> = below.into_iter().chain(above).collect();
    let trips = match levels.as_slice() {
        [] => "no trip by its voltage".to_owned(),
        levels => format!("trips {}", levels.join(", ")),
    };
    let fades = braking.map_or("no braking fade".to_owned(), |fade| {
        format!("braking fades from {}", volts(fade.full))
    });
    let is_near = |name: &&str| {
        let level = if *name == "bus_min" { min } else { max };
        (level / inverter.v_bus - 1.0).abs() <= NEAR
    };
    let near: Vec<&str> = (drive.limits_of_others.iter().copied())
        .filter(is_near)
        .collect();
    let near = near.join(" and ");
    let unstated =
        (!near.is_empty()).then(|| format!("{near} not stated: give your battery's range"));
    let emf = drive.least_bus.map(|_| {
        let [level, rpm] = emf;
        format!("EMF {} at {} rpm", volts(level), rpm.floor())
    });
    let parts = [Some(trips), Some(fades), unstated, emf];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    Some(parts.join("; "))
}

fn chosen(drive: &Prepared) -> Vec<Chosen> {
    let options = drive.generated.interface.options.iter();
    let chosen = options.filter(|option| option.is_choice).map(|option| {
        Some(Chosen {
            option: option.name,
            value: option.value.replace('"', ""),
            reason: option.reason?,
        })
    });
    chosen.flatten().collect()
}

/// The same at rated speed. Where Hall edges are seen at samples alone, a turn of a whole number of periods shows them
/// always in the same place: the worse of that and of a speed just below.
fn at_rating(drive: &Prepared, omega_m: f64, bus_v: f64) -> Result<Point, PlantError> {
    let at = at_speed(drive, omega_m, bus_v)?;
    if drive.spec.inverter.rotor_sensing != RotorSensing::SampledHalls {
        return Ok(at);
    }
    let below = at_speed(drive, JUST_BELOW * omega_m, bus_v)?;
    let lost = at.torque_pct.unwrap_or(0.0) - below.torque_pct.unwrap_or(0.0);
    let is_worse = lost > ALIKE || (lost > -ALIKE && below.ripple_pp_pct > at.ripple_pp_pct);
    Ok(if is_worse { below } else { at })
}

/// The fixed-point program at a speed in rad/s and a bus voltage, with the demanded torque in its direction.
fn at_speed(drive: &Prepared, omega_m: f64, bus_v: f64) -> Result<Point, PlantError> {
    let demand = drive.demand().copysign(omega_m);
    let measured = drive.measure_on_bus(omega_m, demand, bus_v)?;
    let figures = measured.figures;
    let torque_pct = figures.mean_torque_nm.map(|torque| 100.0 * torque / demand);
    Ok(Point {
        rpm: omega_m * 30.0 / std::f64::consts::PI,
        bus_v,
        torque_pct: torque_pct.filter(|_| measured.tripped.is_none()),
        ripple_pp_pct: figures.ripple_pp_pct,
        bus_current_a: figures.bus_current_a,
        switching_hz: figures.switching_hz,
        tripped: measured.tripped,
    })
}
