//! What the type's documentation says of its operation: signs and wiring, start-up, faults.

use super::current_loop::LoopDesign;
use super::start::start_rpm;
use crate::design::vectors::SECTOR_CURRENT;
use crate::diagnostics::{engineering, frequency, significant};
use crate::spec::{BUS_FRESH, BusSource, HallCapture, Spec};

/// Conducting pairs of sectors S1 to S6 at a positive set-point: the phase into which the current flows, and that out of which.
fn pairs() -> [String; 6] {
    SECTOR_CURRENT.map(|signs| {
        let phase_of = |wanted: i32| {
            let mut phases = ["a", "b", "c"].into_iter().zip(signs);
            phases
                .find(|&(_, sign)| sign == wanted)
                .map_or("", |(phase, _)| phase)
        };
        format!("{}, {}", phase_of(1), phase_of(-1))
    })
}

/// Signs, sectors, and the sensors' scales.
pub fn wiring(spec: &Spec, design: &LoopDesign) -> Vec<String> {
    let inverter = &spec.inverter;
    let way = if inverter.adc_gain < 0.0 {
        "fall"
    } else {
        "rise"
    };
    let codes = spec.motor.hall_codes.map(|code| format!("{code:03b}"));
    let mut lines = vec![
        String::new(),
        "# Signs and wiring".to_owned(),
        String::new(),
        format!("A phase current is positive into the motor; the counts of phases a and b {way} with it, {} each, from {} at zero", engineering(inverter.adc_gain.abs(), "A"), inverter.adc_offset),
        "current. Forward is the order of the sectors, in which the EMFs of a, b and c peak one after the other:".to_owned(),
        String::new(),
        "| sector | S1 | S2 | S3 | S4 | S5 | S6 |".to_owned(),
        "|---|---|---|---|---|---|---|".to_owned(),
        format!("| Hall code `Ha Hb Hc`, Ha in bit 2 | {} |", codes.join(" | ")),
        format!("| current into, out of phase (positive set-point) | {} |", pairs().join(" | ")),
        String::new(),
        "A positive set-point makes torque forward, a negative one backward, whichever way the rotor turns. Against the rotation the".to_owned(),
        "motor brakes, and the power goes into the bus, whose voltage nothing here limits. Reversal needs no call. How to find".to_owned(),
        "the codes of a motor, and all conventions: `hexagen::conventions`.".to_owned(),
        format!("One ampere of set-point makes {}.", engineering(spec.torque_constant(), "Nm")),
        format!("One volt over one period changes a phase current by {}.", engineering(design.plant.gain, "A")),
    ];
    if let HallCapture::Timer { ticks } = inverter.hall_capture {
        lines.extend([
            String::new(),
            format!("`hall_ticks` is the time from the last Hall edge to the sample, counted at {} (`HALL_TIMER_HZ`), {} ticks", frequency(ticks / inverter.t_s), significant(ticks)),
            "in a control period; the count stops at 65535. With `hall` it is one snapshot: latch both in the".to_owned(),
            "capture interrupt, or read the ticks, the code, and the ticks again, until the second count is not below the first. A pair that an".to_owned(),
            "edge tore apart is noticed where it contradicts the last period; the angle then goes by the time that was to be expected.".to_owned(),
        ]);
    }
    lines
}

/// What a new drive does, and what to call first.
pub fn start_up(spec: &Spec, design: &LoopDesign) -> Vec<String> {
    let inverter = &spec.inverter;
    let samples = 1_u32 << inverter.calibration_log2;
    let tolerance = engineering(
        f64::from(inverter.offset_tolerance) * inverter.adc_gain.abs(),
        "A",
    );
    let mut lines = vec![
        String::new(),
        "# Start-up".to_owned(),
        String::new(),
        "A new drive runs: its first step controls currents, at set-point 0, with nominal current offsets and nothing charged. Where".to_owned(),
        "the offsets or the bootstrap capacitors of the inverter need it, call `calibrate()` before the first step. Then follow by themselves:".to_owned(),
        String::new(),
        format!("1. {samples} steps with all legs off, whose ADC counts are averaged. The motor rests meanwhile. An offset more than {tolerance} from"),
        "   nominal trips the drive.".to_owned(),
    ];
    if inverter.precharge_periods > 0 {
        lines.extend([
            format!("2. {} steps with all lower switches on, which charge the bootstrap capacitors.", inverter.precharge_periods),
            "3. Control, at the set-point that stands.".to_owned(),
            String::new(),
            "`precharge()` alone begins with the second. It is accepted while the drive runs, too, and short-circuits a motor that turns: call it at rest only.".to_owned(),
        ]);
    } else {
        lines.extend([
            "2. Control, at the set-point that stands. The specification has no pre-charge: `precharge()` does nothing.".to_owned(),
            String::new(),
        ]);
    }
    let told = match spec.inverter.bus {
        BusSource::Fixed => "",
        BusSource::Measured { .. } => " and the bus told by `set_bus`",
    };
    lines.extend([
        format!("Control may begin, and begin again by `reset()`, on a rotor that turns at up to {} rpm with set-point 0{told}; on a faster", start_rpm(spec, design)),
        "one the EMF, not known yet or beyond the lowest bus, may trip the drive.".to_owned(),
    ]);
    lines
}

/// What trips the drive, and what does not.
pub fn safe_states(spec: &Spec) -> Vec<String> {
    let inverter = &spec.inverter;
    let mut lines = vec![
        String::new(),
        "# Safe states".to_owned(),
        String::new(),
        "Each of these turns all legs off until `reset()`, behind which the next step goes on at the set-point that stands: a current".to_owned(),
        "converter at an end of its range, a phase current above the trip level, a Hall code of 000 or from 111 on, an offset that".to_owned(),
    ];
    lines.push(if inverter.stall_periods > 0 {
        format!("calibration refuses, {} periods without a Hall edge while the set-point is not 0.", inverter.stall_periods)
    } else {
        "calibration refuses. A rotor that stands under demand is no fault here (`stall_timeout` is off).".to_owned()
    });
    lines.push(
        "A Hall code that skips sectors is no fault either: it is taken as it reads.".to_owned(),
    );
    if let BusSource::Measured { min, max, .. } = inverter.bus {
        lines.extend([
            format!("Nor is any bus voltage: until the first `set_bus` it is taken as {}, and one outside {} to {}, such as", engineering(inverter.v_bus, "V"), engineering(min, "V"), engineering(max, "V")),
            "that of a dead sensor, as the nearer of these; who reads the sensor watches over it. Where calls cease, the status says".to_owned(),
            format!("`bus_is_stale` from {} on, and before the first one: a warning, for firmware to act on.", engineering(BUS_FRESH, "s")),
        ]);
    }
    lines
}

/// What goes wrong without a trip, and whose part it is.
pub fn unseen(spec: &Spec) -> Vec<String> {
    let bus = match spec.inverter.bus {
        BusSource::Fixed => "No bus voltage is looked at",
        BusSource::Measured { .. } => "No bus voltage trips the drive",
    };
    vec![
        String::new(),
        "# What the supervisor cannot see".to_owned(),
        String::new(),
        "The supervisor misses an ADC or amplifier that is stuck or wrong within its range: one that is frozen at mid-scale can let".to_owned(),
        "the true current rise to several times the trip level. It misses the current of phase c, which has no sensor (it is taken as".to_owned(),
        "-(a + b)), a control interrupt that does not come (the last command stands), heat, shoot-through, and what is shorter than a".to_owned(),
        format!("control period. {bus}, not even one too high for the switches. So the board must have (a) a"),
        "comparator of the current on the timer's break input, (b) a watchdog on the control interrupt and (c) a thermal limit; where".to_owned(),
        "the motor can brake, a limit of the bus voltage, too.".to_owned(),
    ]
}
