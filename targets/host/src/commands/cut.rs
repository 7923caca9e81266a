//! What cuts a torque besides the voltage of the bus.

use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::spec::{BusSource, InverterSpec};

/// The limit of the bus current and the fade that may cut a torque on a bus of `v_bus` volt, in words; none
/// where neither is stated.
pub fn cut_by(inverter: &InverterSpec, is_motoring: bool, v_bus: f64) -> Option<String> {
    let BusSource::Measured {
        braking, motoring, ..
    } = inverter.bus
    else {
        return of_current(inverter, is_motoring);
    };
    let (name, fade) = if is_motoring {
        let begun = motoring.filter(|fade| v_bus < fade.full);
        ("motoring_fade", begun)
    } else {
        let begun = braking.filter(|fade| v_bus > fade.full);
        ("braking_fade", begun)
    };
    let bus = engineering(v_bus, "V");
    let of_voltage = fade.map(|_| format!("`{name}` on a bus of {bus}"));
    let both = of_current(inverter, is_motoring).into_iter();
    let both: Vec<String> = both.chain(of_voltage).collect();
    (!both.is_empty()).then(|| both.join(", "))
}

fn of_current(inverter: &InverterSpec, is_motoring: bool) -> Option<String> {
    let (name, most) = if is_motoring {
        ("bus_current_limit", inverter.bus_currents.drawn)
    } else {
        ("return_current_limit", inverter.bus_currents.returned)
    };
    Some(format!("`{name}` of {}", engineering(most?, "A")))
}
