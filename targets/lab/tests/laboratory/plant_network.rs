//! The plant against closed forms: RL rise, commutation slopes, floating legs, the onset of diode
//! rectification, volt-seconds of PWM, shaft motion, sensors, and the energy balance.

use hexagen::{LegState, Legs};
use hexagen_lab::plant::{
    AdcChannel, EmfShape, EnergyMeter, Mechanics, Observer, Plant, PlantError, PlantParams,
    Segment, Terminal,
};
use std::f64::consts::{PI, TAU};

const V: f64 = 48.0;
const R: f64 = 0.135;
const L: f64 = 0.22e-3;
const T_S: f64 = 50e-6;
const N: u16 = 1800;

fn motor() -> PlantParams {
    PlantParams::ideal(4, R, L, 0.0824, V, T_S)
}

fn legs(command: [Option<u16>; 3]) -> Legs {
    Legs::new(
        command.map(Option::unwrap_or_default),
        command.map(|c| {
            if c.is_some() {
                LegState::Pulsed
            } else {
                LegState::Off
            }
        }),
    )
}

/// Records all segments.
#[derive(Default)]
struct Tape(Vec<Segment>);

impl Observer for Tape {
    fn segment(&mut self, segment: &Segment) {
        self.0.push(segment.clone());
    }
}

#[track_caller]
fn assert_close(got: f64, want: f64, tolerance: f64) {
    assert!(
        (got - want).abs() <= tolerance,
        "got {got}, want {want} +- {tolerance}"
    );
}

#[test]
fn current_rises_as_an_exponential() {
    let mut params = motor();
    params.k_phase = [0.0; 3];
    params.inductance = [L, 2.0 * L, L];
    params.resistance = [R, 3.0 * R, R];
    let mut plant = Plant::new(params, 0.0, 0.0).unwrap();
    for period in 1..=200 {
        plant.run_period(legs([Some(N), Some(0), None]), &mut ());
        let t = f64::from(period) * T_S;
        let want = V / (4.0 * R) * (1.0 - (-4.0 * R * t / (3.0 * L)).exp());
        let [i_a, i_b, i_c] = plant.truth().currents;
        assert_close(i_a / want, 1.0, 1e-9);
        assert_close(i_b / want, -1.0, 1e-9);
        assert_eq!(i_c, 0.0);
    }
}

#[test]
fn emf_ramp_on_a_lossless_winding_integrates_to_a_parabola() {
    let mut params = motor();
    params.resistance = [0.0; 3];
    let omega_m = 100.0;
    let start = -20.0_f64.to_radians();
    let mut plant = Plant::new(params, start, omega_m).unwrap();
    let mut meter = EnergyMeter::new(&plant);
    for period in 1..=30 {
        plant.run_period(Legs::LOW, &mut meter);
        // e_a ramps through zero while e_b = -E and e_c = +E: a sees two thirds of its own EMF.
        let angle = start + 4.0 * omega_m * f64::from(period) * T_S;
        let slope = 0.0824 * omega_m * 6.0 / PI;
        let want =
            -(2.0 / 3.0) * slope * (angle * angle - start * start) / 2.0 / (4.0 * omega_m * L);
        assert_close(plant.truth().currents[0], want, 1e-11);
    }
    // The shaft's work is all that the magnetic field gains.
    let account = meter.balance(&plant);
    assert_eq!(account.copper, 0.0);
    assert!(account.relative_error() < 1e-12, "{account:?}");
}

#[test]
fn three_unequal_phases_settle_by_ohms_law() {
    let mut params = motor();
    params.k_phase = [0.0; 3];
    params.inductance = [L, 1.7 * L, 0.6 * L];
    params.resistance = [1.0, 2.0, 3.0];
    let mut plant = Plant::new(params, 0.0, 0.0).unwrap();
    for _ in 0..400 {
        plant.run_period(legs([Some(N), Some(0), Some(0)]), &mut ());
    }
    let total = V / (1.0 + 2.0 * 3.0 / 5.0);
    let currents = plant.truth().currents;
    for (got, want) in currents
        .into_iter()
        .zip([total, -total * 0.6, -total * 0.4])
    {
        assert_close(got, want, 1e-9 * total);
    }
}

/// The instant of a commutation from a+ c- to b+ c- at 150 degrees with a constant EMF: a tiny
/// speed and a huge constant. Returns the plant, 20 A in a and c, and E.
fn commutation(bus_per_e: f64) -> (Plant, f64) {
    let mut params = motor();
    let e = V / bus_per_e;
    params.resistance = [0.0; 3];
    params.pole_pairs = 1;
    params.k_phase = [e * 1e8; 3];
    let mut plant = Plant::new(params, 150.0_f64.to_radians(), 1e-8).unwrap();
    plant.set_currents([20.0, 0.0]);
    (plant, e)
}

#[test]
fn commutation_slopes_of_the_three_classic_cases() {
    for bus_per_e in [4.0, 7.0, 2.5] {
        let (mut plant, e) = commutation(bus_per_e);
        let fall = 3.0 * L * 20.0 / (V + 2.0 * e);
        let mut tape = Tape::default();
        let periods = 6;
        for _ in 0..periods {
            plant.run_period(legs([None, Some(N), Some(0)]), &mut tape);
        }
        let (during, after): (Vec<_>, Vec<_>) = tape
            .0
            .iter()
            .partition(|s| s.terminal[0] != Terminal::Floating);
        for segment in &during {
            let middle = 0.5 * segment.duration;
            let t = segment.start + middle;
            let [i_a, i_b, i_c] = segment.currents_at(middle);
            assert_close(i_a, 20.0 - (V + 2.0 * e) / (3.0 * L) * t, 1e-6);
            assert_close(i_b, 2.0 * (V - e) / (3.0 * L) * t, 1e-6);
            // V = 4 E keeps the third current, a higher bus raises and a lower one reduces it.
            assert_close(i_c, -20.0 - (V - 4.0 * e) / (3.0 * L) * t, 1e-6);
        }
        let end = during.last().map(|s| s.start + s.duration).unwrap();
        assert_close(end, fall, 1e-12);
        let i_b = 2.0 * (V - e) / (3.0 * L) * fall
            + (V - 2.0 * e) / (2.0 * L) * (f64::from(periods) * T_S - fall);
        let currents = plant.truth().currents;
        assert_close(currents[1], i_b, 1e-5);
        assert_eq!(currents[0], 0.0);
        assert!(!after.is_empty());
    }
}

#[test]
fn outgoing_current_of_either_sign_is_clamped_to_its_own_rail() {
    for (sign, volts) in [(1.0, -0.7), (-1.0, V + 0.7)] {
        let mut params = motor();
        params.diode_drop = 0.7;
        let mut plant = Plant::new(params, 1.0, 10.0).unwrap();
        plant.set_currents([sign * 10.0, -sign * 10.0]);
        let mut tape = Tape::default();
        plant.run_period(legs([None, Some(900), Some(900)]), &mut tape);
        assert_eq!(tape.0[0].voltages_at(0.0)[0], volts);
        assert!(matches!(
            tape.0[0].terminal[0],
            Terminal::Rail { diode: true, .. }
        ));
    }
}

#[test]
fn leg_without_current_floats_at_its_emf_above_the_star_point() {
    let theta = 75.0_f64.to_radians();
    let omega_m = 50.0;
    let mut plant = Plant::new(motor(), theta, omega_m).unwrap();
    let mut tape = Tape::default();
    for _ in 0..3 {
        plant.run_period(legs([Some(1200), Some(0), None]), &mut tape);
    }
    let e = 0.0824 * omega_m;
    for segment in &tape.0 {
        let t = 0.3 * segment.duration;
        let angle = segment.theta_e + segment.omega_e * t;
        // S2 conducts a+ b-; e_c falls from +E at 30 to -E at 90 degrees.
        let e_c = e * (1.0 - (angle - PI / 6.0) * 6.0 / PI);
        let v_a = segment.voltages_at(t)[0];
        assert!(v_a == 0.0 || v_a == V);
        let want = e_c + v_a / 2.0;
        if segment.terminal[2] == Terminal::Floating {
            assert_close(segment.voltages_at(t)[2], want, 1e-6);
            assert!((-1e-6..=V + 1e-6).contains(&want));
        } else if segment.currents_at(0.0)[2] == 0.0 {
            assert!(
                want < 1e-6,
                "starts to conduct although it would float at {want}"
            );
        }
    }
    // Coasting without current, the terminals show the EMF; means over a period included.
    let mut coasting = Plant::new(motor(), theta, omega_m).unwrap();
    coasting.run_period(Legs::OFF, &mut ());
    let v = coasting.truth().mean_voltages;
    let middle = theta + 4.0 * omega_m * T_S / 2.0;
    assert_close(v[0] - v[1], 2.0 * e, 1e-9);
    assert_close(
        v[0] - v[2],
        e - e * (1.0 - (middle - PI / 6.0) * 6.0 / PI),
        1e-9,
    );
    let floats = tape
        .0
        .iter()
        .filter(|s| s.terminal[2] == Terminal::Floating)
        .count();
    assert!(
        floats > 0 && floats < tape.0.len(),
        "the test needs both cases, {floats} of {}",
        tape.0.len()
    );
}

#[test]
fn diodes_begin_to_rectify_when_the_line_emf_exceeds_the_bus() {
    for drop in [0.0, 0.8] {
        let mut params = motor();
        params.shape = EmfShape::Sinusoidal;
        params.pole_pairs = 1;
        params.diode_drop = drop;
        // Largest line-to-line EMF swings between 1.5 E at 30 degrees and 1.732 E.
        let e = (V + 2.0 * drop) / 1.6;
        let omega = e / 0.0824;
        let mut plant = Plant::new(params, PI / 6.0, omega).unwrap();
        let mut tape = Tape::default();
        for _ in 0..20 {
            plant.run_period(Legs::OFF, &mut tape);
        }
        let onset = ((1.6 / 3.0_f64.sqrt()).asin() - PI / 3.0) / omega;
        let first = tape
            .0
            .iter()
            .find(|s| s.terminal != [Terminal::Floating; 3])
            .unwrap();
        assert_close(first.start, onset, 1e-12);
        // Phase a is the highest and feeds the bus, phase b is the lowest.
        assert!(matches!(
            first.terminal[0],
            Terminal::Rail {
                upper: true,
                diode: true,
                ..
            }
        ));
        assert!(matches!(
            first.terminal[1],
            Terminal::Rail {
                upper: false,
                diode: true,
                ..
            }
        ));
        assert_eq!(first.terminal[2], Terminal::Floating);
    }
    let quiet = 0.999 * V / (2.0 * 0.0824);
    let mut plant = Plant::new(motor(), 0.3, quiet).unwrap();
    for _ in 0..200 {
        plant.run_period(Legs::OFF, &mut ());
        assert_eq!(plant.truth().currents, [0.0; 3]);
    }
}

#[test]
fn mean_line_voltage_is_the_difference_of_the_compare_values() {
    let mut plant = Plant::new(motor(), 0.2, 120.0).unwrap();
    let mut word = 12345_u32;
    let mut random = || {
        word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (word >> 16) as u16 % (N + 1)
    };
    for _ in 0..500 {
        let compare = [random(), random(), random()];
        plant.run_period(legs(compare.map(Some)), &mut ());
        let v = plant.truth().mean_voltages;
        for (x, y) in [(0, 1), (1, 2), (2, 0)] {
            let want = (f64::from(compare[x]) - f64::from(compare[y])) / f64::from(N) * V;
            assert_close(v[x] - v[y], want, 1e-10);
        }
    }
}

#[test]
fn dead_time_costs_volt_seconds_by_the_currents_sign() {
    let mut params = motor();
    params.k_phase = [0.0; 3];
    params.dead_time = 1e-6;
    params.inductance = [1.0; 3];
    let mut plant = Plant::new(params, 0.0, 0.0).unwrap();
    plant.set_currents([10.0, -4.0]);
    plant.run_period(legs([Some(900); 3]), &mut ());
    plant.run_period(legs([Some(900); 3]), &mut ());
    let v = plant.truth().mean_voltages;
    // For current into the motor the lower diode conducts in both gaps: the rising edge is late;
    // for current out of the motor the upper one does: the falling edge is late.
    let lost = 1e-6 / T_S * V;
    assert_close(v[0], V / 2.0 - lost, 1e-9);
    assert_close(v[1], V / 2.0 + lost, 1e-9);
    assert_close(v[2], V / 2.0 + lost, 1e-9);
}

/// Mechanical angle of the shaft's rotation, in radians.
#[derive(Default)]
struct Turned(f64);

impl Observer for Turned {
    fn segment(&mut self, segment: &Segment) {
        self.0 += segment.omega_m * segment.duration;
    }
}

fn energy_of(params: PlantParams, omega_m: f64, limit: f64) {
    let mechanics = params.mechanics;
    let mut plant = Plant::new(params, 0.1, omega_m).unwrap();
    let mut meter = EnergyMeter::new(&plant);
    let mut turned = Turned::default();
    for period in 0..1000_u32 {
        let truth = plant.truth();
        // Six-step pair PWM with the third leg off, now and then all three, to visit all events.
        let duty = 600 + (period % 7) as u16 * 100;
        let (plus, minus) = [(2, 1), (0, 1), (0, 2), (1, 2), (1, 0), (2, 0)][truth.sector - 1];
        let mut command = [None; 3];
        command[plus] = Some(duty);
        command[minus] = Some(if period % 2 == 0 { 0 } else { N - duty });
        if period % 11 == 0 {
            command = [Some(duty), Some(700), Some(900)];
        }
        plant.run_period(legs(command), &mut (&mut meter, &mut turned));
    }
    let account = meter.balance(&plant);
    assert!(account.relative_error() < limit, "{account:?}");
    assert!(
        account.copper > 0.01 * account.bus.abs() && account.shaft.abs() > 0.1 * account.bus.abs(),
        "{account:?}"
    );
    if let Some(m) = mechanics {
        let end = plant.truth().omega_m;
        let kinetic = 0.5 * m.inertia * (end * end - omega_m * omega_m);
        let work = (m.opposing_torque - m.external_torque) * turned.0;
        assert_close((kinetic + work) / account.shaft, 1.0, 1e-6);
        assert!(
            (end / omega_m - 1.0).abs() > 0.01,
            "the speed should move: {omega_m} to {end}"
        );
    }
}

#[test]
fn energy_is_balanced() {
    energy_of(motor(), 80.0, 1e-10);
    let mut sine = motor();
    sine.shape = EmfShape::Sinusoidal;
    energy_of(sine, -80.0, 1e-10);
    let mut series = motor();
    let (mut sines, mut cosines) = ([0.0; 12], [0.0; 12]);
    (sines[0], sines[2], cosines[3]) = (1.0, 0.06, 0.03);
    series.shape = EmfShape::Harmonics { sines, cosines };
    energy_of(series, 80.0, 1e-10);
    let mut crooked = motor().scaled(1.3, 0.8, 1.1);
    crooked.inductance[1] *= 1.2;
    crooked.resistance[2] *= 0.7;
    crooked.k_phase[0] *= 0.9;
    crooked.dead_time = 1e-6;
    crooked.diode_drop = 0.7;
    energy_of(crooked.clone(), 80.0, 1e-10);
    crooked.mechanics = Some(Mechanics {
        inertia: 4e-4,
        opposing_torque: 0.3,
        external_torque: -0.1,
        viscous: 0.0,
    });
    energy_of(crooked, 80.0, 1e-4);
}

#[test]
fn free_shaft_coasts_to_rest_and_yields_to_external_torque() {
    let mut params = motor();
    let inertia = 2e-4;
    params.mechanics = Some(Mechanics {
        inertia,
        opposing_torque: 0.4,
        external_torque: 0.1,
        viscous: 0.0,
    });
    let mut plant = Plant::new(params.clone(), 0.0, -10.0).unwrap();
    // Both torques brake: 10 rad/s end after 10 J / 0.5 N m = 4 ms.
    for _ in 0..40 {
        plant.run_period(Legs::OFF, &mut ());
    }
    assert_close(plant.truth().omega_m, -5.0, 1e-9);
    for _ in 0..60 {
        plant.run_period(Legs::OFF, &mut ());
    }
    assert_eq!(plant.truth().omega_m, 0.0);
    params.mechanics = Some(Mechanics {
        inertia,
        opposing_torque: 0.1,
        external_torque: 0.4,
        viscous: 0.0,
    });
    let mut plant = Plant::new(params, 0.0, 0.0).unwrap();
    for _ in 0..40 {
        plant.run_period(Legs::OFF, &mut ());
    }
    assert_close(plant.truth().omega_m, 0.3 / inertia * 2e-3, 1e-9);
    let viscous = Mechanics {
        inertia,
        opposing_torque: 0.0,
        external_torque: 0.0,
        viscous: 0.1,
    };
    let params = PlantParams {
        mechanics: Some(viscous),
        ..motor()
    };
    let mut plant = Plant::new(params, 0.0, 50.0).unwrap();
    for _ in 0..40 {
        plant.run_period(Legs::OFF, &mut ());
    }
    // One time constant J/B of 2 ms.
    assert_close(plant.truth().omega_m, 50.0 / 1.0_f64.exp(), 1e-5);
}

#[test]
fn samples_show_quantised_currents_codes_and_time_since_the_edge() {
    let mut params = motor();
    params.adc = vec![
        AdcChannel {
            amperes_per_count: 0.02,
            ..AdcChannel::bipolar(12, 40.0)
        },
        AdcChannel {
            amperes_per_count: -0.1,
            ..AdcChannel::bipolar(10, 40.0)
        },
    ];
    params.hall_error_deg = [4.0, 0.0, 0.0];
    params.hall_ticks_per_period = 1000.0;
    params.k_phase = [0.0; 3];
    let omega_e = 1.0_f64.to_radians() / T_S; // one electrical degree per period
    let mut plant = Plant::new(params, 29.5_f64.to_radians(), omega_e / 4.0).unwrap();
    assert_eq!(plant.sample(Legs::OFF).ticks(), u16::MAX);
    plant.set_currents([1.0, -3.0]);
    let sample = plant.sample(Legs::OFF);
    assert_eq!((sample.adc()[0], sample.adc()[1]), (2098, 542));
    for period in 1..=100_u16 {
        plant.run_period(Legs::OFF, &mut ());
        let angle = 29.5 + f64::from(period);
        // Ha's edge at 30 degrees comes 4 degrees late, Hc's at 90 in time.
        let (code, since) = match angle {
            a if a < 34.0 => (0b001, None),
            a if a < 90.0 => (0b101, Some(a - 34.0)),
            a => (0b100, Some(a - 90.0)),
        };
        let sample = plant.sample(Legs::OFF);
        assert_eq!(sample.hall(), code, "{angle}");
        let ticks = since.map_or(f64::from(u16::MAX), |degrees| degrees * 1000.0);
        assert_close(f64::from(sample.ticks()), ticks, 1.0);
    }
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    let refuse = |change: fn(&mut PlantParams), field: &str| {
        let mut params = motor();
        change(&mut params);
        let Err(PlantError::Range { name, .. }) = Plant::new(params, 0.0, 0.0) else {
            panic!("{field} was accepted");
        };
        assert_eq!(name, field);
    };
    refuse(|p| p.inductance[1] = 0.0, "inductance");
    refuse(|p| p.resistance[2] = f64::NAN, "resistance");
    refuse(|p| p.v_bus = -48.0, "v_bus");
    refuse(|p| p.dead_time = 40e-6, "dead_time");
    refuse(
        |p| p.adc[0].amperes_per_count = 0.0,
        "adc amperes_per_count",
    );
    refuse(
        |p| {
            p.shape = EmfShape::Trapezoidal {
                flat_top_deg: 180.0,
            }
        },
        "flat_top_deg",
    );
    refuse(|p| p.adc[1].noise = -1.0, "adc noise");
    refuse(|p| p.adc[1].instant = 30e-6, "adc instant");
    // The second channel before the first.
    refuse(|p| p.adc[0].instant = 1e-6, "adc instant");
    refuse(|p| p.hall_error_deg[1] = TAU * 10.0, "hall_error_deg");
}
