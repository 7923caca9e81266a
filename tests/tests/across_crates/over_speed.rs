//! The over-speed watch on the step of firmware: Hall edges at stated distances.

use hexagen::{Drive, Fault, Legs, Sample};

hexagen::controller! {
    /// At 3000 rpm an electrical turn takes 100 periods, and a sector 16.7.
    pub Fast {
        motor: {
            pole_pairs: 4,
            resistance: 135 mohm per_phase,
            inductance: 0.22 mH per_phase,
            winding: star,
            back_emf: 0.1648 V/(rad/s) line_to_line peak,
            emf_shape: trapezoidal,
            rated_current: 20 A,
            rated_speed: 2000 rpm,
        },
        inverter: {
            bus_voltage: 48 V,
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            adc_bits: 12,
            adc_range: 40 A,
            current_sensing: in_phase,
            over_speed: 3000 rpm,
        },
        controller: pdcc { emf: estimated, reference: quasi_square },
    }
}

/// Codes of sectors 1 to 6.
const CODES: [u8; 6] = [0b001, 0b101, 0b100, 0b110, 0b010, 0b011];

/// A drive whose rotor is in sector 1, and how many Hall edges it has seen.
struct Bench {
    drive: Drive<Fast>,
    edges: usize,
}

impl Bench {
    fn new() -> Self {
        let mut bench = Self {
            drive: Drive::new(),
            edges: 0,
        };
        bench.wait(100);
        bench
    }

    /// So many periods in the present sector, without a current.
    fn wait(&mut self, periods: usize) -> Legs {
        let sample = Sample::with_hall([2048; 2], CODES[self.edges % 6]);
        (0..periods).fold(Legs::OFF, |_, _| self.drive.step(&sample))
    }

    /// The rotor enters the next sector, for so many periods.
    fn turn(&mut self, periods: usize) {
        self.edges += 1;
        self.wait(periods);
    }

    fn fault(&self) -> Option<Fault> {
        self.drive.status().fault
    }
}

#[test]
fn seven_short_turns_trip_and_no_fewer() {
    let mut bench = Bench::new();
    // The first edge begins the measurement, the second one gives the first turn of 96 periods.
    for _ in 0..7 {
        bench.turn(16);
    }
    assert_eq!(bench.fault(), None, "six of them");
    bench.turn(1);
    assert_eq!(bench.fault(), None, "the trip comes with the next period");
    assert_eq!(bench.wait(1), Legs::OFF);
    assert_eq!(bench.fault(), Some(Fault::OverSpeed));
    let trip = bench.drive.trip(&mut []).expect("a trip is kept");
    assert_eq!(trip.fault, Fault::OverSpeed);
    assert_eq!(bench.wait(100), Legs::OFF, "the trip is latched");
    bench.drive.reset();
    assert_eq!(bench.fault(), None);
}

#[test]
fn a_speed_just_below_does_not_trip() {
    let mut bench = Bench::new();
    for edge in 0..200 {
        // A turn of exactly 100 periods is not above the over-speed.
        bench.turn([17, 17, 16, 17, 17, 16][edge % 6]);
    }
    assert_eq!(bench.fault(), None);
}

#[test]
fn one_wrong_interval_trips_nothing() {
    // Behind the first edge, where it stands for all six, and in rotation.
    for before in [1, 2, 12] {
        for wrong in [1, 5, 15] {
            let mut bench = Bench::new();
            for _ in 0..before {
                bench.turn(17);
            }
            bench.turn(wrong);
            for _ in 0..20 {
                bench.turn(17);
            }
            assert_eq!(bench.fault(), None, "{wrong} periods behind {before} edges");
        }
    }
}

#[test]
fn a_rotor_that_coasts_is_watched_too() {
    let mut bench = Bench::new();
    bench.drive.coast();
    for _ in 0..9 {
        bench.turn(10);
    }
    assert_eq!(bench.fault(), Some(Fault::OverSpeed));
}
