//! Hall sensors: codes, placement errors, and exact times of their edges.

use super::floor;
use std::f64::consts::TAU;

/// Codes `HaHbHc` of sectors S1 to S6 from the ideal sensors.
const IDEAL_CODES: [u8; 6] = super::STANDARD_HALL_CODES;

/// Electrical angles of the edges at which sectors S1 to S6 begin, of sensors in their places: degrees.
pub(super) const EVEN_EDGES_DEG: [f64; 6] = [-30.0, 30.0, 90.0, 150.0, 210.0, 270.0];

/// A sensor: it reads 1 from its rising edge on, for the angle `high`. Radians.
#[derive(Clone, Copy, Debug)]
struct Sensor {
    rise: f64,
    high: f64,
}

impl Sensor {
    fn is_high(self, theta_e: f64) -> bool {
        let turns = floor((theta_e - self.rise) / TAU);
        theta_e - self.rise - turns * TAU < self.high
    }

    /// The rising or falling edge that is nearest to an angle.
    fn edge_near(self, is_rising: bool, theta_e: f64) -> f64 {
        let edge = self.rise + if is_rising { 0.0 } else { self.high };
        edge + floor((theta_e - edge) / TAU + 0.5) * TAU
    }
}

/// The three sensors and the time of the last edge.
#[derive(Clone, Debug)]
pub(super) struct Sensors {
    each: [Sensor; 3],
    codes: [u8; 6],
    last_edge: f64,
    /// Sensors that read 1 at the end of the last sweep. Kept, as the angle may be wrapped before the
    /// next one begins: computed again it may round to the other side of an edge, which would be missed.
    high: Option<[bool; 3]>,
}

impl Sensors {
    /// Sensors with edges at these angles, which each is displaced from.
    pub(super) fn new(edges_deg: [f64; 6], error_deg: [f64; 3], codes: [u8; 6]) -> Self {
        let each = std::array::from_fn(|x| {
            // Ha rises where S2 begins, and falls three edges on.
            let [rise, fall] = [1 + 2 * x, (4 + 2 * x) % 6].map(|edge| edges_deg[edge]);
            Sensor {
                rise: (rise + error_deg[x]).to_radians(),
                high: (fall - rise).rem_euclid(360.0).to_radians(),
            }
        });
        Self {
            each,
            codes,
            last_edge: f64::NEG_INFINITY,
            high: None,
        }
    }

    /// The same sensors in other places; the last edge is kept.
    pub(super) fn change(&mut self, edges_deg: [f64; 6], error_deg: [f64; 3], codes: [u8; 6]) {
        *self = Self {
            last_edge: self.last_edge,
            ..Self::new(edges_deg, error_deg, codes)
        };
    }

    /// Time of the last edge in seconds, minus infinity before the first.
    pub(super) fn last_edge(&self) -> f64 {
        self.last_edge
    }

    /// Which sensors read 1.
    fn are_high(&self, theta_e: f64) -> [bool; 3] {
        self.each.map(|sensor| sensor.is_high(theta_e))
    }

    /// Hall code at an electrical angle, in the motor's wiring. A sensor combination that ideal
    /// placement never shows is returned as it is.
    pub(super) fn code(&self, theta_e: f64) -> u8 {
        let high = self.are_high(theta_e).into_iter();
        let raw = high.fold(0_u8, |code, is_high| code << 1 | u8::from(is_high));
        IDEAL_CODES
            .iter()
            .position(|&code| code == raw)
            .map_or(raw, |sector| self.codes[sector])
    }

    /// Records edges while the angle moves linearly from `from` to `to` during `[t, t + h]`.
    pub(super) fn sweep(&mut self, from: f64, to: f64, t: f64, h: f64) {
        let before = self.high.unwrap_or_else(|| self.are_high(from));
        let after = self.are_high(to);
        self.high = Some(after);
        for x in 0..3 {
            if before[x] != after[x] {
                // Backward, a sensor that begins to read 1 passes its falling edge.
                let is_rising = after[x] == (to > from);
                let edge = self.each[x].edge_near(is_rising, to);
                let share = ((edge - from) / (to - from)).clamp(0.0, 1.0);
                self.last_edge = self.last_edge.max(t + h * share);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::sector_of;

    #[test]
    fn ideal_codes_match_the_sector() {
        let sensors = Sensors::new(EVEN_EDGES_DEG, [0.0; 3], IDEAL_CODES);
        for step in 0..720 {
            let theta = (f64::from(step) * 0.5 + 0.25).to_radians();
            assert_eq!(
                sensors.code(theta),
                IDEAL_CODES[sector_of(theta) - 1],
                "{step}"
            );
        }
    }

    #[test]
    fn edges_are_found_in_both_directions_and_displaced_by_the_placement() {
        let mut sensors = Sensors::new(EVEN_EDGES_DEG, [5.0, 0.0, 0.0], IDEAL_CODES);
        let degrees = f64::to_radians;
        sensors.sweep(degrees(30.0), degrees(34.0), 0.0, 1.0);
        assert_eq!(sensors.last_edge(), f64::NEG_INFINITY);
        sensors.sweep(degrees(34.0), degrees(38.0), 1.0, 1.0);
        assert!((sensors.last_edge() - 1.25).abs() < 1e-12);
        sensors.sweep(degrees(38.0), degrees(92.0), 2.0, 1.0);
        sensors.sweep(degrees(92.0), degrees(88.0), 3.0, 1.0);
        assert!((sensors.last_edge() - 3.5).abs() < 1e-12);
        assert_eq!(sensors.code(degrees(33.0)), 0b001);
        assert_eq!(sensors.code(degrees(36.0)), 0b101);
    }
}
