//! A drive in closed loop at a held speed, for tests of the bus.

use hexagen_lab::closed_loop::ClosedLoop;
use hexagen_lab::engine::{Engine, Model, Prepared, plant_of, run_of};
use hexagen_lab::plant::Plant;
use std::f64::consts::FRAC_PI_3;

/// A drive on a shaft that turns at a constant speed.
pub struct Bench<'d> {
    pub drive: &'d Prepared,
    pub closed: ClosedLoop<Engine<'d>>,
    /// Periods of a sector.
    pub sector: usize,
}

impl<'d> Bench<'d> {
    /// A shaft held at this share of the rated speed, at set-point 0.
    pub fn at(drive: &'d Prepared, share: f64) -> Self {
        let spec = &drive.spec;
        let omega = share * spec.motor.rated_speed;
        let plant = Plant::new(plant_of(spec), 0.2, omega).expect("a plant");
        let delay = run_of(spec, omega, 0.0).delay;
        let engine = drive.engine(Model::Fixed, drive.set_point(0.0));
        let sector = FRAC_PI_3 / (omega.abs() * f64::from(spec.motor.pole_pairs));
        let mut bench = Self {
            drive,
            closed: ClosedLoop::new(plant, engine, delay),
            sector: (sector / spec.inverter.t_s).round() as usize,
        };
        // The rotor's speed becomes known.
        bench.closed.run(20 * bench.sector, &mut ());
        bench
    }
}
