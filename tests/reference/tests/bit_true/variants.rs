//! Every PDCC variant and a selection of the other controllers' on two very different motors, with
//! formats of about 30 bits.

use hexagen::{Format, Rounding};
use hexagen_reference::{
    Candidates, Controller, DiscretePhase, EmfShapeKind, EmfSource, FcsMpc, FormatTable,
    Modulation, Reference, Spec, Switch,
};
use std::f64::consts::TAU;

/// One choice of every option.
#[derive(Clone, Debug)]
pub struct Variant {
    pub name: String,
    /// The normalised text.
    pub toml: String,
    pub spec: Spec,
    pub formats: &'static [Format],
}

const MOTORS: [(&str, &str); 2] = [
    (
        "660 W",
        r#"
[motor]
pole_pairs = 4
resistance = 0.135
inductance = 0.00022
emf_constant = 0.0824
emf_shape = "trapezoidal"
flat_top_deg = 120.0
torque_constant = 0.1648
hall_codes = [1, 5, 4, 6, 2, 3]
[inverter]
v_bus = 48.0
t_s = 5e-5
timer_period = 1800
adc_bits = 12
adc_gain = 0.01953125
adc_offset = 2048
offset_tolerance = 102
trip_current = 38.0
max_current = 20.0
omega_max = 314.0
precharge_periods = 20
stall_periods = 0
calibration_log2 = 8
"#,
    ),
    (
        "servo",
        r#"
[motor]
pole_pairs = 3
resistance = 4.58
inductance = 0.0373
emf_constant = 0.55
emf_shape = "sinusoidal"
torque_constant = 0.9
hall_codes = [3, 1, 5, 4, 6, 2]
[inverter]
v_bus = 300.0
t_s = 1e-4
timer_period = 4000
adc_bits = 14
adc_gain = -0.0008
adc_offset = 8000
offset_tolerance = 400
trip_current = 5.5004
max_current = 3.7
omega_max = 420.0
precharge_periods = 0
stall_periods = 2000
calibration_log2 = 5
"#,
    ),
];

/// All variants of both motors.
pub fn all() -> Vec<Variant> {
    let mut variants = Vec::new();
    for (motor, text) in MOTORS {
        for index in 0..1536 {
            let mut left = index;
            let mut pick = |count: usize| {
                let picked = left % count;
                left /= count;
                picked
            };
            let modulation = ["three_phase", "pair"][pick(2)];
            let saturation = ["keep_angle", "nearest", "torque_priority"][pick(3)];
            let (emf, filter) = [
                ("estimated", 1.0),
                ("estimated", 0.4),
                ("model", 1.0),
                ("observer", 1.0),
            ][pick(4)];
            let reference = ["quasi_square", "proportional"][pick(2)];
            let advance = [0.0, 1.5][pick(2)];
            let delay = [1, 0][pick(2)];
            let discretisation = ["exact", "euler"][pick(2)];
            let capture = ["sampled", "timer"][pick(2)];
            let bus = ["fixed", "measured"][pick(2)];
            assert_eq!(left, 0);
            let options = format!(
                r#"
kind = "pdcc"
modulation = "{modulation}"
saturation = "{saturation}"
emf = "{emf}"
emf_filter = {filter:?}
reference = "{reference}"
advance = {advance:?}
delay = {delay}
discretisation = "{discretisation}"
word = 32
commutation_threshold = 0.1
commutation_timeout = 8
"#
            );
            let name = format!(
                "{motor}: {modulation} {saturation} {emf} {filter} {reference} advance {advance} delay {delay} \
                 {discretisation} {capture} {bus}"
            );
            variants.push(variant(name, text, capture, bus, &options));
        }
    }
    variants
}

/// A selection of the options of FCS-MPC, PHCC and PI-PWM, on both motors.
pub fn others() -> Vec<Variant> {
    const KINDS: [(&str, &[&str], &[&str]); 3] = [
        (
            "fcs-mpc",
            &["table2", "three_phase", "all"],
            &["physical", "nominal"],
        ),
        (
            "phcc",
            &["derived", "three_phase", "printed"],
            &["physical", "nominal"],
        ),
        (
            "pi-pwm",
            &["keep_angle", "nearest", "torque_priority"],
            &["on", "off"],
        ),
    ];
    let mut variants = Vec::new();
    for (motor, text) in MOTORS {
        for (kind, firsts, seconds) in KINDS {
            for index in 0..72 {
                let (first, second) = (firsts[index % 3], seconds[index / 3 % 2]);
                if (first, second) == ("torque_priority", "off") {
                    continue;
                }
                let (emf, filter) =
                    [("estimated", 1.0), ("estimated", 0.4), ("model", 1.0)][index / 6 % 3];
                let delay = [1, 0][index / 18 % 2];
                let reference = ["quasi_square", "proportional"][index / 36];
                // The other options vary out of step with these.
                let advance = [0.0, 1.5][index % 5 % 2];
                let discretisation = ["exact", "euler"][index % 7 % 2];
                let capture = ["sampled", "timer"][index % 11 % 2];
                let bus = ["fixed", "measured"][index % 13 % 2];
                let choosing = format!(
                    "off_leg = \"{second}\"\ncommutation_threshold = 0.1\ncommutation_timeout = 8"
                );
                // One controller of the pair follows the corners, without the EMF.
                let six_step = match (second, reference) {
                    ("off", "quasi_square") => ["on", "off"][index % 17 % 2],
                    _ => "off",
                };
                let own = match (kind, first) {
                    ("fcs-mpc", _) => {
                        let modulated = ["off", "on"][index % 17 % 2];
                        let cost = match (modulated, index % 19 % 4) {
                            ("off", 1) => "switching_weight = 0.05",
                            ("off", 2) => "switching_weight = 0.03\ntorque_weight = 1.5",
                            ("off", 3)
                                if first == "three_phase"
                                    || (first, second) == ("all", "nominal") =>
                            {
                                "horizon = 2"
                            }
                            _ => "",
                        };
                        format!(
                            "candidates = \"{first}\"\nmodulated = \"{modulated}\"\n{cost}\n{choosing}"
                        )
                    }
                    ("phcc", "three_phase") => format!(
                        "table = \"derived\"\ncandidates = \"three_phase\"\nband = 0.1\n{choosing}"
                    ),
                    ("phcc", _) => format!(
                        "table = \"{first}\"\ncandidates = \"table2\"\nband = 0.1\n{choosing}"
                    ),
                    _ => format!(
                        "saturation = \"{first}\"\nfeed_forward = \"{second}\"\nsix_step = \"{six_step}\"\n\
                         bandwidth = 1000.0\nintegral_time = 0.0016"
                    ),
                };
                let options = format!(
                    r#"
kind = "{kind}"
emf = "{emf}"
emf_filter = {filter:?}
reference = "{reference}"
advance = {advance:?}
delay = {delay}
discretisation = "{discretisation}"
word = 32
{own}
"#
                );
                let name = format!(
                    "{motor}: {kind} {first} {second} {emf} {filter} {reference} advance {advance} \
                     delay {delay} {discretisation} {capture} {bus}"
                );
                variants.push(variant(name, text, capture, bus, &options));
            }
        }
    }
    variants
}

/// The paper's modulator with both controllers that have it, on both motors.
pub fn of_table2() -> Vec<Variant> {
    let mut variants = Vec::new();
    for (motor, text) in MOTORS {
        for index in 0..48 {
            let kind = ["pdcc", "pi-pwm"][index % 2];
            let saturation = ["keep_angle", "nearest", "torque_priority"][index / 2 % 3];
            let zero = ["all_low", "pair_low"][index / 6 % 2];
            let delay = [1, 0][index / 12 % 2];
            let bus = ["fixed", "measured"][index / 24 % 2];
            // The other options vary out of step with these.
            let emf = ["estimated", "model"][index % 5 % 2];
            let advance = [0.0, 1.5][index % 7 % 2];
            let capture = ["sampled", "timer"][index % 11 % 2];
            let own = if kind == "pdcc" {
                ""
            } else {
                "feed_forward = \"on\"\nsix_step = \"off\"\nbandwidth = 1000.0\nintegral_time = 0.0016"
            };
            let options = format!(
                r#"
kind = "{kind}"
modulation = "table2"
zero = "{zero}"
saturation = "{saturation}"
emf = "{emf}"
emf_filter = 1.0
reference = "quasi_square"
advance = {advance:?}
delay = {delay}
discretisation = "exact"
word = 32
commutation_threshold = 0.1
commutation_timeout = 8
{own}
"#
            );
            let name = format!(
                "{motor}: {kind} table2 {zero} {saturation} {emf} advance {advance} delay {delay} {capture} {bus}"
            );
            variants.push(variant(name, text, capture, bus, &options));
        }
    }
    variants
}

/// A motor's text with the rest of its inverter and a controller.
fn variant(name: String, motor: &str, capture: &str, bus: &str, controller: &str) -> Variant {
    let ticks = if capture == "timer" { 50 } else { 2 };
    // 60 degrees in 200 periods at the least speed, a turn in 20 at the greatest.
    let (age_max, rev_min) = (200 * ticks, 20 * ticks);
    let sense = if bus == "measured" {
        "bus_gain = 0.1\nbus_adc_bits = 12\nbus_min = 40.0\nbus_max = 390.0"
    } else {
        ""
    };
    let toml = format!(
        r#"
name = "Variant"
{motor}
bus = "{bus}"
{sense}
hall_capture = "{capture}"
ticks = {ticks}
age_max = {age_max}
rev_min = {rev_min}
[controller]
{controller}
"#
    );
    variant_of(name, toml)
}

/// One in seven of all these variants, with a fade of the set-point where the bus is measured, else with
/// a slew rate; without PHCC, which decides by the sign of the set-point: within a word of 0 the
/// rounding of the two models differs in it.
pub fn limited() -> Vec<Variant> {
    let variants = all().into_iter().chain(others()).step_by(7);
    variants
        .filter(|variant| !matches!(variant.spec.controller, Controller::Phcc(_)))
        .map(|variant| {
            let faded = variant.toml.replace(
                "bus_max = 390.0\n",
                "bus_max = 390.0\nbraking_fade = [250.0, 380.0]\nmotoring_fade = [120.0, 50.0]\n",
            );
            let toml = if faded == variant.toml {
                format!("{faded}slew_rate = 3000.0\n")
            } else {
                faded
            };
            variant_of(format!("{} limited", variant.name), toml)
        })
        .collect()
}

/// One in five of all variants whose reference can turn against the field, with field weakening.
pub fn weakened() -> Vec<Variant> {
    let variants = all().into_iter().chain(others());
    let turnable = variants.filter(|variant| {
        let is_limited = match &variant.spec.controller {
            Controller::Pdcc(pdcc) => pdcc.modulation == Modulation::ThreePhase,
            Controller::PiPwm(pi_pwm) => pi_pwm.six_step == Switch::Off,
            Controller::PPwm(_) => true,
            Controller::FcsMpc(_) | Controller::Phcc(_) => false,
        };
        is_limited && variant.spec.loop_options().reference == Reference::Proportional
    });
    turnable
        .step_by(5)
        .map(|variant| {
            let share = "weakening_share = [19.5, 55.3]\ntorque_constant";
            let toml = variant.toml.replacen("torque_constant", share, 1);
            let toml = format!("{toml}field_weakening = \"on\"\n");
            variant_of(format!("{} weakened", variant.name), toml)
        })
        .collect()
}

/// One in three of all variants that observe the EMF and whose Hall edges are timed, with learnt places of the sensors.
pub fn learnt() -> Vec<Variant> {
    let variants = all().into_iter().chain(others());
    let timed = variants.filter(|variant| {
        let observes = variant.spec.loop_options().emf == EmfSource::Observer;
        observes && variant.toml.contains("hall_capture = \"timer\"")
    });
    timed
        .step_by(3)
        .map(|variant| {
            let toml = format!("{}hall_learning = \"on\"\n", variant.toml);
            variant_of(format!("{} learnt", variant.name), toml)
        })
        .collect()
}

/// One in three of all variants that observe the EMF behind a measured bus, with the torque constant learnt.
pub fn with_torque_learnt() -> Vec<Variant> {
    let variants = all().into_iter().chain(others());
    let told = variants.filter(|variant| {
        let observes = variant.spec.loop_options().emf == EmfSource::Observer;
        observes && variant.toml.contains("bus_adc_bits")
    });
    told.step_by(3)
        .map(|variant| {
            let toml = format!("{}torque_learning = \"on\"\n", variant.toml);
            variant_of(format!("{} torque learnt", variant.name), toml)
        })
        .collect()
}

fn variant_of(name: String, toml: String) -> Variant {
    let spec = Spec::from_toml(&toml).expect("a valid specification");
    Variant {
        formats: formats(&spec),
        spec,
        toml,
        name,
    }
}

/// Formats with as many bits as the plant's ranges allow.
pub fn formats(spec: &Spec) -> &'static [Format] {
    let (motor, inverter, options) = (&spec.motor, &spec.inverter, spec.loop_options());
    let g = inverter.adc_gain.first().abs();
    let w = inverter.v_bus / f64::from(inverter.timer_period);
    let DiscretePhase { a, b } = DiscretePhase::new(spec);
    let adc_max = f64::from((1u32 << inverter.adc_bits) - 1);
    // Currents reach twice the ADC's range (phase c), voltages the deadbeat voltages for them.
    let f_i = 29 - (2.0 * adc_max).log2().ceil() as i32;
    let volts = 4.0 * (adc_max * g / b + 2.0 * inverter.v_bus_max().expect("a bus"));
    let f_v = 29 - (volts / w).log2().ceil() as i32;
    // Scores of FCS-MPC are sums of up to twelve voltages.
    let f_v = match spec.controller {
        Controller::FcsMpc(_) => f_v - 4,
        _ => f_v,
    };
    let (proportional, integral_share) = match &spec.controller {
        Controller::PiPwm(pi) => (
            TAU * pi.bandwidth * motor.inductance,
            inverter.t_s / pi.integral_time,
        ),
        Controller::PPwm(p) => (TAU * p.bandwidth * motor.inductance, 1.0),
        _ => (1.0 / b, 1.0),
    };
    // Of a reference that turns, too.
    let gain = proportional.max(1.0 / b);
    let scale = 2f64.powi(f_v);
    let bus = inverter.v_bus_max().expect("a bus");
    let turn = f64::from(motor.pole_pairs) * inverter.t_s / (1.6 * motor.emf_constant);
    let ohm = g / w * 2f64.powi(f_v - f_i);
    // A turn takes a line EMF of twice the bus at most, as a factor of 31 bits or a little more
    // than 30; a ramp takes two.
    let slope = match motor.emf_shape {
        EmfShapeKind::Sinusoidal | EmfShapeKind::Harmonics => turn * 4.0 * bus,
        EmfShapeKind::Trapezoidal => {
            turn * w / scale * 4.0 * (bus / w * scale).powi(2) / 2f64.powi(30)
        }
    };
    let shift = |value: f64| (30 - value.log2().ceil() as i32).clamp(0, 62);
    let e_max = 2.0 * motor.emf_constant * inverter.omega_max / w * scale;
    let linkage = motor.emf_constant / (f64::from(motor.pole_pairs) * inverter.t_s) / w * 1.6;
    let slowest = 6.0 * f64::from(inverter.age_max);
    let rise_shift = (slowest / f64::from(inverter.rev_min)).log2().floor() + 2.0;
    let rise = 7.0 / 3.0 * (rise_shift.max(2.0) - 3.0).exp2();
    let peak = 1.6 * motor.torque_constant / motor.emf_constant;
    // The greatest set-point word.
    let top = inverter.max_current * gain / w * scale;
    let entries = [
        ("current", f_i),
        ("voltage", f_v),
        ("k_di", shift(ohm / b)),
        ("k_r", shift(ohm * motor.resistance)),
        ("k_hold", shift(ohm * a / b)),
        ("k_decay", shift(b * motor.resistance)),
        ("k_fade", shift(b * motor.resistance)),
        ("k_filter", shift(options.emf_filter)),
        ("k_slope", shift(slope)),
        ("k_third", shift(1.0 / 3.0)),
        ("k_sixth", shift(1.0 / 6.0)),
        ("score", 2 * f_v - 30),
        ("k_torque_weight", shift(4.5)),
        ("k_pole", shift(a)),
        ("k_first", shift(1.0 + a * a)),
        ("k_pole_sixth", shift(a / 6.0)),
        ("k_drop", shift(ohm * proportional)),
        ("k_due", shift(proportional * b)),
        ("k_lead", shift(a)),
        ("k_i", shift(integral_share)),
        ("k_set", shift(scale * gain / w / 65_536.0)),
        (
            "k_torque",
            shift(scale * gain / w / motor.torque_constant / 65_536.0),
        ),
        ("k_advance", shift(options.advance.max(1.0))),
        ("k_rise", shift(rise)),
        ("k_bus", shift(0.1 / w * scale)),
        ("k_braking", shift(inverter.max_current * gain / 130.0)),
        ("k_motoring", shift(inverter.max_current * gain / 70.0)),
        ("j_in_force", f_v + 1),
        ("k_weakening", 31),
        (
            "k_against",
            shift(top / (3f64.sqrt() * 75.0 / 360.0 * 2f64.powi(32))),
        ),
        ("k_even", shift(2f64.powi(17) / top)),
        (
            "k_across",
            shift(0.02 * linkage * TAU / 2f64.powi(32) * scale),
        ),
        (
            "k_along",
            shift(3.0 * linkage * TAU / 2f64.powi(32) * scale),
        ),
        ("k_learn", shift(2f64.powi(22) * w / scale / inverter.v_bus)),
        ("k_little", shift(200.0 * motor.resistance / gain)),
        ("k_free", 30),
        ("ratio", 24),
        ("scale", 16),
        (
            "scale_volts",
            f_v - ((bus / w * scale).log2().floor() as i32 - 15).max(0),
        ),
        ("shape", shift(peak)),
        ("stretch", 31),
        ("flux", shift(linkage)),
        ("emf_product", 2 * f_v - (e_max.log2().ceil() as i32).max(0)),
    ];
    let formats: Vec<Format> = entries
        .into_iter()
        .map(|(name, frac_bits)| Format {
            name,
            storage_bits: 32,
            frac_bits: i8::try_from(frac_bits).expect("fraction bits"),
            rounding: Rounding::RoundHalfUp,
            segments: if matches!(name, "shape" | "stretch" | "flux") {
                48
            } else {
                0
            },
        })
        .collect();
    Vec::leak(formats)
}

/// The table of a variant's formats.
pub fn table(variant: &Variant) -> FormatTable {
    FormatTable::new(variant.formats)
}

/// Whether the variant tracks commutations.
pub fn commutates(variant: &Variant) -> bool {
    match &variant.spec.controller {
        Controller::Pdcc(pdcc) => pdcc.modulation != Modulation::ThreePhase,
        Controller::FcsMpc(fcs_mpc) => fcs_mpc.candidates != Candidates::ThreePhase,
        Controller::Phcc(_) => true,
        Controller::PiPwm(pi_pwm) => pi_pwm.modulation == Modulation::Table2,
        Controller::PPwm(_) => false,
    }
}

/// Whether a voltage can exceed the variant's range.
pub fn saturates(variant: &Variant) -> bool {
    !matches!(
        variant.spec.controller,
        Controller::FcsMpc(_) | Controller::Phcc(_)
    )
}

/// Whether the variant interpolates the rotor's angle.
pub fn has_rotor(variant: &Variant) -> bool {
    let options = variant.spec.loop_options();
    let needs_emf = match &variant.spec.controller {
        Controller::PiPwm(pi_pwm) => pi_pwm.feed_forward == Switch::On,
        Controller::Phcc(_) => options.delay == 1,
        Controller::Pdcc(_) | Controller::FcsMpc(_) | Controller::PPwm(_) => true,
    };
    needs_emf && matches!(options.emf, EmfSource::Model | EmfSource::Observer)
        || options.advance > 0.0
        || options.reference == Reference::Proportional
}

/// Whether the cost of FCS-MPC is only the current error in one period.
pub fn is_plain(options: &FcsMpc) -> bool {
    options.horizon == 1 && options.switching_weight + options.torque_weight <= 0.0
}
