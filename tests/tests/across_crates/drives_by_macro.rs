//! Drives of every kind of controller, made by the macro as in firmware: they are bit-true, and the
//! tables of their types are those of the vectors' geometry.

#![expect(
    deprecated,
    reason = "the generator warns of PHCC near its trip level (HX0610, HX0611)"
)]

use fixed::types::{I7F25, I9F23};
use hexagen::{controller, verify};
use std::f64::consts::TAU;

/// A drive of the paper's motor.
macro_rules! drives {
    ($($name:ident: $controller:ident { $($options:tt)* })*) => {$(
        controller! {
            pub $name {
                motor: "../targets/motors/trivedi-keshri-660w.toml",
                controller: $controller { $($options)* },
            }
        }
    )*};
}

drives! {
    Deadbeat: pdcc { modulation: pair }
    FiniteSet: fcs_mpc { candidates: all }
    Hysteresis: phcc { table: derived }
    Regulator: pi_pwm { bandwidth: 800 Hz, feed_forward: off }
}

verify!(Deadbeat, FiniteSet, Hysteresis, Regulator);

/// Two vectors, to a part in ten million of the bus.
#[track_caller]
fn assert_near(found: [f64; 2], expected: [f64; 2]) {
    let distance = (found[0] - expected[0]).hypot(found[1] - expected[1]);
    assert!(distance < 5e-6, "{found:?} for {expected:?}");
}

fn polar(length: f64, degrees: f64) -> [f64; 2] {
    let angle = degrees / 360.0 * TAU;
    [length * angle.cos(), length * angle.sin()]
}

/// The tables of a type.
macro_rules! check_tables {
    ($($test:ident: $drive:ty)*) => {$(
        #[test]
        fn $test() {
            let real = |vector: [I7F25; 2]| vector.map(I7F25::to_num::<f64>);
            let bus = <$drive>::V_BUS.to_num::<f64>();
            assert_eq!(bus, 48.0);
            // V1 lies at 240 degrees, V12 at 270; the next ones 60 degrees farther each.
            for (index, vector) in (0..6).zip(<$drive>::THREE_PHASE_VECTORS) {
                assert_near(real(vector), polar(bus * 2.0 / 3.0, 240.0 + 60.0 * f64::from(index)));
            }
            for (index, vector) in (0..6).zip(<$drive>::TWO_PHASE_VECTORS) {
                assert_near(real(vector), polar(bus / 3f64.sqrt(), 270.0 + 60.0 * f64::from(index)));
            }
            // The times of (16) with the vectors at a sector's boundaries make the voltage.
            let period = f64::from(<$drive>::TIMER_PERIOD);
            for (sector, times) in (0..6).zip(<$drive>::SVM_COEFFICIENTS.chunks(2)) {
                let degrees = 60.0 * f64::from(sector);
                let voltage = polar(20.0, degrees + 25.0);
                let mut mean = [0.0; 2];
                for (row, degrees) in times.iter().zip([degrees, degrees + 60.0]) {
                    let row = row.map(I9F23::to_num::<f64>);
                    let time = row[0] * voltage[0] + row[1] * voltage[1];
                    assert!(time > 0.0 && time < period, "sector {sector}: {time}");
                    let vector = polar(bus * 2.0 / 3.0, degrees);
                    mean = [0, 1].map(|axis| mean[axis] + time / period * vector[axis]);
                }
                assert_near(mean, voltage);
            }
        }
    )*};
}

check_tables! {
    tables_of_deadbeat_control: Deadbeat
    tables_of_a_finite_set: FiniteSet
    tables_of_hysteresis_control: Hysteresis
    tables_of_a_regulator: Regulator
}

#[test]
fn hysteresis_control_shows_its_switching_table() {
    assert_eq!(Hysteresis::SWITCHING_TABLE.len(), 256);
    assert!(
        Hysteresis::SWITCHING_TABLE
            .iter()
            .all(|&vector| vector < 16)
    );
}
