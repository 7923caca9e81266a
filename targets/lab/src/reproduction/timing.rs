//! Computation times of Table 5: counted instructions of a Cortex-M4 at a given clock.

use crate::counted::Figures;

/// Clock of the processor in hertz: that of the motor file's timer.
pub const CLOCK_HZ: f64 = 72e6;

/// Source of the times.
pub const TIMES_TEXT: &str = "Instructions of one step on a Cortex-M4, from the function's entry to its return, as cargo xtask cost \
     counts them: usual is the median of settled steps (none for a drive that trips), worst is the maximum, start and overspeed \
     included. Computation times are estimated cycles without wait states (load, store 2, taken branch 3, division 12, all else 1; \
     for the worst step with the cycles per instruction of the usual one); free is the rest of the period after the worst step";

/// Times of a step in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    /// Of a usual step; `None` for a drive that trips.
    pub usual: Option<f64>,
    /// Of the worst step.
    pub worst: f64,
    /// Remainder of the period after the worst step.
    pub free: f64,
}

impl Times {
    /// The times of a step in a control period `t_s`, seconds, with the cycles of a usual one.
    pub fn of(cost: &Figures, usual_cycles: Option<u32>, t_s: f64) -> Self {
        let time = |cycles: u32| f64::from(cycles) / CLOCK_HZ;
        let worst = time(cost.worst_cycles());
        Self {
            usual: usual_cycles.map(time),
            worst,
            free: t_s - worst,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_share_the_period() {
        let cost = Figures {
            normal: 100,
            supervision: None,
            worst: 200,
            cycles: 144,
            code: 400,
            stack: 8,
            longest: None,
        };
        let times = Times::of(&cost, Some(144), 50e-6);
        let usual = times.usual.expect("there is one");
        assert!((usual - 2e-6).abs() < 1e-12, "{times:?}");
        assert!((times.worst - 4e-6).abs() < 1e-12, "{times:?}");
        assert!((times.free - 46e-6).abs() < 1e-12, "{times:?}");
    }
}
