//! What may break: in the plant, in the signals that the drive reads, in the call of its control
//! loop.

use crate::plant::{PlantParams, Short};

/// What breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Defect {
    /// Nothing.
    None,
    /// Motor, inverter or placement of sensors.
    Plant(PlantDefect),
    /// Signals between plant and drive.
    Signal(SignalDefect),
    /// The bus.
    Bus {
        /// New over old voltage.
        factor: f64,
        /// Whether a drive that measures the bus is told the new voltage.
        is_told: bool,
    },
    /// The shaft.
    Shaft {
        /// New over old speed.
        factor: f64,
    },
    /// The control interrupt: the last command stands.
    Interrupt {
        /// Control periods without it; `None`: it never comes again.
        lost: Option<usize>,
    },
}

/// A change of the plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlantDefect {
    /// The wire from a leg to its winding opens.
    OpenWire {
        /// The leg, 0 to 2.
        leg: usize,
    },
    /// A bad joint.
    Joint {
        /// The leg, 0 to 2.
        leg: usize,
        /// New over old resistance of the phase.
        factor: f64,
    },
    /// A switch that no longer turns on.
    DeadSwitch {
        /// The leg, 0 to 2.
        leg: usize,
        /// Whether it is the upper one.
        is_upper: bool,
    },
    /// A short circuit at the motor.
    Short(Short),
    /// The wires of phases a and b change places, with the current that each leg carries.
    WiresExchanged,
    /// True over stated R, L and EMF constant.
    Motor([f64; 3]),
    /// Dead time beyond the stated one, at most up to a tenth of the PWM period.
    DeadTime {
        /// Second.
        more: f64,
    },
    /// True over stated current per ADC count of the two channels.
    AdcScale([f64; 3]),
    /// Noise of the current ADCs.
    AdcNoise {
        /// Counts rms.
        rms: f64,
    },
    /// Displaced Hall sensors.
    Halls {
        /// Electrical degrees; positive is late in forward rotation.
        error_deg: [f64; 3],
    },
    /// A displaced angle sensor.
    Angle {
        /// Electrical degrees; positive is late in forward rotation.
        error_deg: f64,
    },
}

/// A change of signals between plant and drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SignalDefect {
    /// The current sensor of a phase, 0 to 2.
    Current {
        /// The phase.
        phase: usize,
        /// What it does.
        defect: CurrentDefect,
    },
    /// The counts of two phases change places.
    CurrentsExchanged([usize; 2]),
    /// A Hall sensor no longer changes.
    HallStuck {
        /// The sensor, 0 to 2 for Ha to Hc.
        line: usize,
        /// Its level.
        is_high: bool,
    },
    /// Ha and Hb change places.
    HallsExchanged,
    /// One Hall line shows the wrong level for one sample every 20 ms.
    HallFlips,
    /// All three Hall lines do so: the code of the opposite sector.
    HallOpposite,
    /// The angle sensor's angle no longer changes.
    AngleStuck,
    /// It is half an electrical turn off for one sample every 20 ms.
    AngleJumps,
    /// The timer of Hall edges shows this count.
    EdgeTimer {
        /// Ticks.
        ticks: u16,
    },
}

/// A change of a current sensor; shares are of the ADC's range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CurrentDefect {
    /// Reads zero current.
    StuckAtZero,
    /// Reads what it read last.
    StuckAtLast,
    /// Reads count 0.
    StuckAtBottom,
    /// Reads the largest count.
    StuckAtTop,
    /// New over old gain.
    Gain(f64),
    /// The count of zero current moves up.
    Offset(f64),
    /// Uniform noise of this amplitude, independent from sample to sample.
    Noise(f64),
}

/// Most dead time in PWM periods: with more no inverter is built.
const MOST_DEAD_TIME: f64 = 0.1;

impl PlantDefect {
    /// Applies the change.
    pub fn apply(self, plant: &mut PlantParams) {
        match self {
            Self::OpenWire { leg } => plant.wiring.open[leg] = true,
            Self::Joint { leg, factor } => plant.resistance[leg] *= factor,
            Self::DeadSwitch { leg, is_upper } => {
                let wiring = &mut plant.wiring;
                let dead = if is_upper {
                    &mut wiring.upper_dead
                } else {
                    &mut wiring.lower_dead
                };
                dead[leg] = true;
            }
            Self::Short(short) => plant.wiring.short = Some(short),
            Self::WiresExchanged => plant.wiring.windings.swap(0, 1),
            Self::Motor([r, l, k_b]) => *plant = plant.clone().scaled(r, l, k_b),
            Self::DeadTime { more } => {
                let most = MOST_DEAD_TIME * plant.pwm_period();
                plant.dead_time = plant.dead_time.max((plant.dead_time + more).min(most));
            }
            Self::AdcScale(scales) => plant.scale_adc(&scales),
            Self::AdcNoise { rms } => {
                for channel in &mut plant.adc {
                    channel.noise = rms;
                }
            }
            Self::Halls { error_deg } => {
                let known = plant.hall_error_deg;
                plant.hall_error_deg = std::array::from_fn(|x| known[x] + error_deg[x]);
            }
            // The true angle at the sensor's angle 0 is more than the stated one.
            Self::Angle { error_deg } => {
                if let Some(sensor) = &mut plant.angle {
                    sensor.offset_deg += error_deg;
                }
            }
        }
    }
}
