//! The plant's capture timer against the known Hall edges of a rotor at constant speed.

use hexagen::Legs;
use hexagen_lab::plant::{Plant, PlantParams};

/// Ticks per control period.
const TICKS: f64 = 1800.0;

/// Ticks from the last Hall edge to a time in periods, at constant speed in degrees per period:
/// edges are at 30 + 60 n. `None` before the first edge.
fn ticks_since_edge(start: f64, per_period: f64, periods: f64) -> Option<f64> {
    let sixths = (start + per_period * periods - 30.0) / 60.0;
    let last = if per_period > 0.0 {
        sixths.floor()
    } else {
        sixths.ceil()
    };
    let at = (30.0 + 60.0 * last - start) / per_period;
    (at >= 0.0).then_some((periods - at) * TICKS)
}

#[test]
fn samples_have_the_whole_ticks_since_the_last_edge() {
    let mut compared = 0;
    for (start, per_period) in [
        (11.3, 0.731),
        (200.7, 7.37),
        (77.1, -3.13),
        (301.9, 41.7),
        (29.0, -55.3),
    ] {
        let mut params = PlantParams::ideal(4, 0.135, 0.22e-3, 0.0, 48.0, 50e-6);
        params.hall_ticks_per_period = TICKS;
        let omega_m = f64::to_radians(per_period) / params.t_s / f64::from(params.pole_pairs);
        let mut plant = Plant::new(params, f64::to_radians(start), omega_m).expect("a plant");
        let mut hall = plant.sample(Legs::OFF).hall();
        for period in 1..=400 {
            plant.run_period(Legs::OFF, &mut ());
            let sample = plant.sample(Legs::OFF);
            let place = format!("{start} + {period} x {per_period} degrees");
            match ticks_since_edge(start, per_period, f64::from(period)) {
                None => assert_eq!(sample.ticks(), u16::MAX, "{place}"),
                // So near to an integer tick rounding decides.
                Some(ticks) if (ticks - ticks.round()).abs() < 1e-5 => {}
                Some(ticks) => {
                    assert_eq!(sample.ticks(), ticks.floor() as u16, "{place}");
                    compared += 1;
                }
            }
            let is_new = sample.hall() != hall;
            assert_eq!(is_new, f64::from(sample.ticks()) < TICKS, "{place}");
            hall = sample.hall();
        }
    }
    assert!(compared > 1800, "{compared}");
}
