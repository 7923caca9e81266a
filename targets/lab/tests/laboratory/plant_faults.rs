//! Broken wires and switches of the plant against closed forms, and changes between two periods.

use hexagen::{LegState, Legs};
use hexagen_lab::plant::{AdcChannel, EmfShape, Plant, PlantParams, SHORT_RESISTANCE, Short};

const V: f64 = 48.0;
const R: f64 = 0.135;
const L: f64 = 0.22e-3;
const T_S: f64 = 50e-6;
const N: u16 = 1800;

fn motor() -> PlantParams {
    PlantParams::ideal(4, R, L, 0.0824, V, T_S)
}

/// A motor at rest with currents, to which this happens.
fn broken(currents: [f64; 2], change: impl FnOnce(&mut PlantParams)) -> Plant {
    let mut plant = Plant::new(motor(), 0.3, 0.0).unwrap();
    plant.set_currents(currents);
    plant.change(change).unwrap();
    plant
}

fn pulsed(compare: [u16; 3]) -> Legs {
    Legs::new(compare, [LegState::Pulsed; 3])
}

#[track_caller]
fn assert_near(got: f64, want: f64) {
    assert!(
        (got - want).abs() <= 1e-9 * want.abs().max(1.0),
        "got {got}, want {want}"
    );
}

#[test]
fn a_wire_that_opens_leaves_the_flux_of_the_loop_of_the_two_others() {
    let mut plant = broken([10.0, 5.0], |plant| plant.wiring.open[2] = true);
    let begun = plant.truth().currents;
    assert_eq!(begun, [2.5, -2.5, 0.0]);
    for period in 1..=40 {
        plant.run_period(pulsed([N, 0, N]), &mut ());
        let [i_a, i_b, i_c] = plant.truth().currents;
        let end = V / (2.0 * R);
        let want = end + (2.5 - end) * (-R / L * f64::from(period) * T_S).exp();
        assert_near(i_a, want);
        assert_near(i_b, -want);
        assert_eq!(i_c, 0.0);
    }
}

#[test]
fn with_two_wires_open_nothing_flows() {
    let mut plant = broken([10.0, 5.0], |plant| plant.wiring.open = [true, false, true]);
    plant.set_speed(1000.0);
    for _ in 0..40 {
        plant.run_period(pulsed([N, 300, 0]), &mut ());
        assert_eq!(plant.truth().currents, [0.0; 3]);
    }
}

#[test]
fn of_a_dead_switch_the_diode_is_left() {
    // The upper switch of leg a: current out of the motor flows, current into it does not.
    let mut plant = broken([0.0; 2], |plant| plant.wiring.upper_dead[0] = true);
    plant.run_period(pulsed([N, 0, 0]), &mut ());
    assert_eq!(plant.truth().currents, [0.0; 3]);
    plant.run_period(pulsed([N, N, 0]), &mut ());
    let [i_a, i_b, _] = plant.truth().currents;
    assert!(i_a.abs() < 1e-9 && i_b > 1.0, "{i_a} {i_b}");
    plant.set_currents([-20.0, 10.0]);
    plant.run_period(pulsed([N, 0, 0]), &mut ());
    assert!(plant.truth().currents[0] > -20.0 + 0.5 * V / (1.5 * L) * T_S);
    // The lower switch: the other way round.
    let mut plant = broken([0.0; 2], |plant| plant.wiring.lower_dead[0] = true);
    plant.run_period(pulsed([0, N, N]), &mut ());
    assert_eq!(plant.truth().currents, [0.0; 3]);
}

#[test]
fn exchanged_wires_are_the_same_motor_at_other_legs() {
    let mut crossed = motor();
    crossed.wiring.windings = [1, 0, 2];
    let mut crossed = Plant::new(crossed, 0.3, 150.0).unwrap();
    let mut straight = Plant::new(motor(), 0.3, 150.0).unwrap();
    for period in 0..100 {
        let compare = [period * 17, 900, period * 5];
        let [a, b, c] = compare;
        crossed.run_period(pulsed(compare), &mut ());
        straight.run_period(pulsed([b, a, c]), &mut ());
        let [i_a, i_b, i_c] = crossed.truth().currents;
        let want = straight.truth();
        for (got, want) in [i_b, i_a, i_c].into_iter().zip(want.currents) {
            assert_near(got, want);
        }
        assert_near(crossed.truth().mean_torque, want.mean_torque);
    }
}

#[test]
fn a_change_to_the_same_changes_nothing_and_a_wrong_one_is_refused() {
    let commands = |period: u16| pulsed([period * 17 % N, 900, period * 5 % N]);
    let mut one = Plant::new(motor(), 0.3, 150.0).unwrap();
    let mut other = one.clone();
    for period in 0..100 {
        other.change(|_| {}).unwrap();
        let error = other.change(|plant| plant.wiring.windings = [0, 0, 2]);
        assert!(error.unwrap_err().to_string().contains("windings is 0"));
        one.run_period(commands(period), &mut ());
        other.run_period(commands(period), &mut ());
        assert_eq!(one.truth(), other.truth());
        assert_eq!(one.sample(Legs::OFF), other.sample(Legs::OFF));
    }
}

/// The currents in amperes that sensors of +-2 kA show, with what they round.
fn read(plant: &mut Plant) -> [f64; 2] {
    let [a, b, _] = plant.sample(Legs::OFF).adc();
    [a, b].map(|count| (f64::from(count) - 32768.0) * 2000.0 / 32768.0)
}

/// A turning motor with a short and wide current sensors.
fn shorted(short: Option<Short>) -> Plant {
    let mut params = motor();
    params.adc = vec![AdcChannel::bipolar(16, 2000.0); 2];
    params.wiring.short = short;
    let mut plant = Plant::new(params, 0.3, 100.0).unwrap();
    plant.set_currents([5.0, -3.0]);
    plant
}

#[track_caller]
fn assert_reads(got: f64, want: f64) {
    assert!((got - want).abs() < 0.04, "{got} A, but {want} A flow");
}

#[test]
fn through_two_shorted_phases_the_emf_drives_its_loop_although_all_legs_are_off() {
    let mut params = motor();
    params.shape = EmfShape::Sinusoidal;
    params.adc = vec![AdcChannel::bipolar(16, 2000.0); 2];
    params.wiring.short = Some(Short::Legs([1, 2]));
    let mut plant = Plant::new(params, 0.3, 100.0).unwrap();
    let mut largest = 0.0_f64;
    for period in 0..1000 {
        plant.run_period(Legs::OFF, &mut ());
        let [i_a, i_b, i_c] = plant.truth().currents;
        assert!(i_a == 0.0 && (i_b + i_c).abs() < 1e-9, "{i_a} {i_b} {i_c}");
        if period >= 500 {
            largest = largest.max(i_b.abs());
        }
    }
    // The line EMF over the impedance of two phases, at four times the mechanical speed.
    let want = 3.0_f64.sqrt() * 0.0824 * 100.0 / (2.0 * R.hypot(400.0 * L));
    assert!(
        (largest / want - 1.0).abs() < 1e-3,
        "{largest} A, but {want} A"
    );
    assert!(plant.truth().mean_torque < 0.0, "the loop brakes");
    // A loop within the motor passes no sensor.
    assert_eq!(read(&mut plant), [0.0; 2]);
}

#[test]
fn through_a_short_the_bus_drives_a_current_that_no_winding_takes() {
    let short_current = V / SHORT_RESISTANCE;
    let mut sound = shorted(None);
    let mut phases = shorted(Some(Short::Legs([0, 1])));
    let mut minus = shorted(Some(Short::ToMinus(0)));
    for compare in [[N, 0, 900], [900, 900, 900], [N, 0, 300]] {
        for plant in [&mut sound, &mut phases, &mut minus] {
            plant.run_period(pulsed(compare), &mut ());
            // At the turning point pulsed legs are low, a full one is high.
            let extra = if compare[0] == N { short_current } else { 0.0 };
            let [i_a, i_b, _] = plant.truth().currents;
            let (of_a, of_b) = match plant.params().wiring.short {
                None => (0.0, 0.0),
                Some(Short::ToMinus(_)) => (extra, 0.0),
                Some(Short::Legs(_)) => (extra, -extra),
            };
            let [read_a, read_b] = read(plant);
            assert_reads(read_a, i_a + of_a);
            assert_reads(read_b, i_b + of_b);
        }
        for plant in [&phases, &minus] {
            for (got, want) in plant.truth().currents.iter().zip(sound.truth().currents) {
                assert_near(*got, want);
            }
        }
    }
}

#[test]
fn a_shorted_leg_that_is_off_is_carried_by_what_it_is_shorted_to() {
    let off_a = Legs::new(
        [0, 600, 900],
        [LegState::Off, LegState::Pulsed, LegState::Pulsed],
    );
    for (short, alike) in [
        (Short::ToMinus(0), pulsed([0, 600, 900])),
        (Short::Legs([0, 1]), pulsed([600, 600, 900])),
    ] {
        let (mut plant, mut sound) = (shorted(Some(short)), shorted(None));
        plant.run_period(off_a, &mut ());
        sound.run_period(alike, &mut ());
        let [i_a, i_b, _] = plant.truth().currents;
        assert_near(i_a, sound.truth().currents[0]);
        assert_near(i_b, sound.truth().currents[1]);
        assert!(i_a.abs() > 1.0, "{i_a}");
        let [read_a, read_b] = read(&mut plant);
        assert_reads(read_a, 0.0);
        let carried = if short == Short::ToMinus(0) { 0.0 } else { i_a };
        assert_reads(read_b, i_b + carried);
    }
}

#[test]
fn a_short_of_an_open_wire_is_refused() {
    let mut plant = Plant::new(motor(), 0.3, 0.0).unwrap();
    for short in [Short::Legs([0, 0]), Short::ToMinus(3), Short::Legs([0, 2])] {
        let error = plant.change(|plant| {
            plant.wiring.open[2] = true;
            plant.wiring.short = Some(short);
        });
        assert!(error.unwrap_err().to_string().contains("short is"));
    }
}
