//! Both PI models against a textbook PI controller: parallel form, the integral in ampere seconds,
//! back-calculation with tracking time T_i.

use crate::variants;
use hexagen::Sample;
use hexagen_reference::{
    BitTrue, Controller, FormatTable, Ideal, Reference, Saturation, Spec, Switch,
};
use std::f64::consts::TAU;

#[test]
fn follows_a_textbook_controller() {
    let mut tried = 0;
    for variant in variants::others() {
        // Wide enough a band for the 660 W motor to saturate within its trip level.
        let text = variant
            .toml
            .replace("bandwidth = 1000.0", "bandwidth = 4000.0");
        let spec = &Spec::from_toml(&text).expect("a specification");
        let common = spec.loop_options();
        let Controller::PiPwm(options) = spec.controller else {
            continue;
        };
        if options.feed_forward == Switch::On
            || options.six_step == Switch::On
            || options.saturation != Saturation::Nearest
            || common.reference != Reference::QuasiSquare
            || variants::has_rotor(&variant)
        {
            continue;
        }
        tried += 1;
        let inverter = &spec.inverter;
        let mut bit_true =
            BitTrue::new(spec, &FormatTable::new(variants::formats(spec))).expect("a model");
        let mut ideal = Ideal::new(spec).expect("a model");
        let current = inverter.max_current / 4.0;
        let bits = (current * 65_536.0) as i32;
        bit_true.set_current(bits);
        ideal.set_current(bits);
        let current = f64::from(bits) / 65_536.0;

        let k_p = TAU * options.bandwidth * spec.motor.inductance;
        let k_i = k_p / options.integral_time;
        // Sector 3: in at a, out at c.
        let reference = [current, 0.0, -current];
        let mut integral = [0.0; 3];
        let mut limited = 0;
        let volts = 2e-4 * inverter.v_bus;
        for step in 0..400u32 {
            // Counts that vary around the reference, at times far enough to saturate.
            let swing = if step % 100 < 10 { 1.5 } else { 0.05 };
            let counts = |amps: f64| {
                (f64::from(inverter.adc_offset.first()) + amps / inverter.adc_gain.first()).round()
            };
            let phase = f64::from(step) * 0.3;
            let adc = [
                counts(current * (1.0 - swing * phase.cos())),
                counts(current * swing * phase.sin() / 2.0),
            ];
            let i_ab = adc.map(|count| {
                (count - f64::from(inverter.adc_offset.first())) * inverter.adc_gain.first()
            });
            let i = [i_ab[0], i_ab[1], -i_ab[0] - i_ab[1]];
            let error = [0, 1, 2].map(|x| reference[x] - i[x]);
            let u = [0, 1, 2].map(|x| k_p * error[x] + integral[x]);
            let (max, min) = (u[0].max(u[1]).max(u[2]), u[0].min(u[1]).min(u[2]));
            let pole = u.map(|u_x| {
                (u_x - f64::midpoint(max, min)).clamp(-inverter.v_bus / 2.0, inverter.v_bus / 2.0)
            });
            let mean = pole.iter().sum::<f64>() / 3.0;
            limited += u32::from(max - min > inverter.v_bus);
            let counts = [adc[0] as u16, adc[1] as u16];
            let sample = Sample::with_hall(counts, spec.motor.hall_codes[2]);
            let legs = bit_true.step(&sample);
            let duties = ideal.step(&sample);
            assert!(ideal.trace().run, "{} step {step}", variant.name);
            for x in 0..2 {
                for trace in [bit_true.trace(), *ideal.trace()] {
                    assert!(
                        (trace.u_unsat[x] - u[x]).abs() < volts
                            && (trace.u[x] - (pole[x] - mean)).abs() < volts,
                        "{} step {step}: {trace:?}, expected {u:?}",
                        variant.name
                    );
                }
            }
            for x in 0..3 {
                let duty = pole[x] / inverter.v_bus + 0.5;
                let count = duty * f64::from(inverter.timer_period);
                assert!((duties.duty[x] - duty).abs() < 1e-9, "{}", variant.name);
                assert!(
                    (f64::from(legs.instants()[x]) - count).abs() < 1.5,
                    "{}",
                    variant.name
                );
                // Integration, and back-calculation of the limited part.
                let tracking = (pole[x] - mean - u[x]) / options.integral_time;
                integral[x] += inverter.t_s * (k_i * error[x] + tracking);
            }
        }
        assert!(limited > 5 && limited < 350, "{}: {limited}", variant.name);
    }
    assert!(tried > 0);
}
