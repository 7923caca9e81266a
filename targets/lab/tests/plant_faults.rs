//! Broken wires and switches of the plant against closed forms, and changes between two periods.

use hexagen::{LegState, Legs};
use hexagen_lab::plant::{Plant, PlantParams};

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
