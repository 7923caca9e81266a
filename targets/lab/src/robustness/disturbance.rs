//! The disturbances of the robustness sheet, as changes of the plant options.

use crate::engine::{PerSensor, PlantOptions};
use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::spec::{InverterSpec, RotorSensing};

/// A plant option.
type Scale = fn(&mut PlantOptions) -> &mut Option<f64>;

/// Parameters of the motor, each with the option that scales it, and by how much: a data sheet's resistance may
/// be of another temperature, basis or without leads, and iron saturates.
const SCALES: [(&str, Scale, [f64; 2]); 3] = [
    ("R", |plant| &mut plant.scale_r, [0.5, 2.0]),
    ("L", |plant| &mut plant.scale_l, [0.75, 1.3]),
    ("k_b", |plant| &mut plant.scale_kb, [0.8, 1.2]),
];

/// True over nominal bus voltage.
const BUS: f64 = 0.85;

/// Dead times in seconds; the nominal plant has the motor file's.
const DEAD_TIMES: [f64; 4] = [0.0, 0.5e-6, 1e-6, 2e-6];

/// Placement errors of the Hall sensors in electrical degrees: all equal, and all different.
const HALL_ERRORS: [(&str, [f64; 3]); 3] = [
    ("Hall -5 deg", [-5.0; 3]),
    ("Hall +5 deg", [5.0; 3]),
    ("Hall +5, -5, 0 deg", [5.0, -5.0, 0.0]),
];

/// Resolutions of the current ADCs in bits.
const ADC_BITS: [u32; 2] = [10, 12];

/// Zero error of the ADCs, the same for both, relative to the largest current.
const ADC_OFFSET: f64 = 0.005;

/// True over stated current per ADC count of the two channels.
const ADC_SCALE: [f64; 3] = [1.01, 0.99, 1.0];

/// Noise of the current ADCs in counts rms.
const ADC_NOISE: f64 = 1.0;

/// One disturbance.
#[derive(Clone, Debug)]
pub struct Disturbance {
    /// Its name in reports.
    pub name: String,
    /// Plant options of the disturbed plant.
    pub plant: PlantOptions,
}

/// The sensors' values of an undisturbed plant: one for all, or one of each.
fn known_of_sensors(known: Option<&PerSensor>, sound: f64) -> Vec<f64> {
    known.map_or_else(|| vec![sound], |known| known.0.clone())
}

/// The undisturbed plant, then every disturbance. `inverter` is that of the drives on the
/// undisturbed plant.
pub fn disturbances(undisturbed: &PlantOptions, inverter: &InverterSpec) -> Vec<Disturbance> {
    let mut all = Vec::new();
    let mut add = |name: &str, change: &dyn Fn(&mut PlantOptions)| {
        let mut plant = undisturbed.clone();
        change(&mut plant);
        let name = name.to_owned();
        all.push(Disturbance { name, plant });
    };
    add("none", &|_| {});
    for (parameter, scale, factors) in SCALES {
        for factor in factors {
            add(&format!("{parameter} x {factor}"), &|plant| {
                let scale = scale(plant);
                *scale = Some(factor * scale.unwrap_or(1.0));
            });
        }
    }
    add("bus -15 %", &|plant| {
        plant.v_bus = Some(BUS * plant.v_bus.unwrap_or(inverter.v_bus));
    });
    let known = undisturbed.dead_time.unwrap_or(inverter.dead_time);
    for dead_time in DEAD_TIMES {
        if (dead_time - known).abs() > 1e-12 {
            let name = format!("dead time {}", engineering(dead_time, "s"));
            add(&name, &|plant| plant.dead_time = Some(dead_time));
        }
    }
    let has_angle = matches!(inverter.rotor_sensing, RotorSensing::Angle(_));
    for (name, error) in HALL_ERRORS {
        // An angle sensor is one.
        let name = if has_angle {
            name.replace("Hall", "angle")
        } else {
            name.to_owned()
        };
        if has_angle && error[0] != error[1] {
            continue;
        }
        add(&name, &|plant| {
            let known = plant.hall_error.unwrap_or([0.0; 3]);
            plant.hall_error = Some(std::array::from_fn(|x| known[x] + error[x]));
        });
    }
    let largest = inverter.adc_gain.abs() * f64::from(1_u32 << (inverter.adc_bits - 1));
    let offset = ADC_OFFSET * largest;
    for bits in ADC_BITS {
        let name = format!("{bits}-bit ADC, {} off", engineering(offset, "A"));
        add(&name, &|plant| {
            plant.adc_bits = Some(bits);
            // A stated current per count would shrink the range.
            let range = plant.adc_range.take();
            plant.adc_range = range.or_else(|| Some(format!("{largest} A")));
            let known = known_of_sensors(plant.adc_offset.as_ref(), 0.0);
            plant.adc_offset = Some(PerSensor(
                known.iter().map(|known| known + offset).collect(),
            ));
        });
    }
    add("current sensors 2 % apart", &|plant| {
        let known = known_of_sensors(plant.scale_adc.as_ref(), 1.0);
        let apart = ADC_SCALE.iter().take(inverter.sensors().len());
        let scales = apart.zip(known.iter().cycle());
        plant.scale_adc = Some(PerSensor(
            scales.map(|(apart, known)| apart * known).collect(),
        ));
    });
    add("ADC noise 1 count rms", &|plant| {
        plant.adc_noise = Some(plant.adc_noise.unwrap_or(0.0).hypot(ADC_NOISE));
    });
    // The board states that its currents are converted one after the other.
    let times = inverter.current_sensing.times();
    if times.is_some_and(|times| times.conversion > 0.0) && undisturbed.conversion_time.is_none() {
        add("both currents at once", &|plant| {
            plant.conversion_time = Some(0.0);
        });
    }
    all
}
