//! Sectors, the six 60 degree steps of the electrical turn, and their tables.

use crate::spec::Motor;

/// The sector after each, forward; 0 is "not known yet".
pub const NEXT: [usize; 7] = [0, 2, 3, 4, 5, 6, 1];
/// Current of phase a in units of the set-point, quasi-square reference.
pub const CORNER_A: [f64; 7] = [0.0, 0.0, 1.0, 1.0, 0.0, -1.0, -1.0];
/// Current of phase b in units of the set-point, quasi-square reference.
pub const CORNER_B: [f64; 7] = [0.0, -1.0, -1.0, 0.0, 1.0, 1.0, 0.0];
/// Phase that carries the set-point's positive current (0, 1, 2 = a, b, c).
pub const PLUS: [usize; 7] = [0, 2, 0, 0, 1, 1, 2];
/// Phase that carries it back.
pub const MINUS: [usize; 7] = [0, 1, 1, 2, 2, 0, 0];
/// Phase that is off, and outgoing while the sector's commutation lasts.
pub const OUT_PHASE: [usize; 7] = [0, 0, 2, 1, 0, 2, 1];
/// Sign of the outgoing current for positive torque and forward rotation.
pub const OUT_SIGN: [f64; 7] = [0.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0];

/// Sector of each Hall code without an inverted sensor (0: invalid code), from the specification's
/// codes of sectors 1 to 6.
pub fn hall_sectors(motor: &Motor) -> [usize; 8] {
    let mut sectors = [0; 8];
    for (index, code) in motor.hall_codes.iter().enumerate() {
        sectors[usize::from((code ^ motor.hall_inverted()) & 7)] = index + 1;
    }
    sectors
}

/// Evaluation of a Hall sample (section 2).
#[derive(Clone, Copy, Debug)]
pub struct HallEvent {
    /// Sector now; the last one while the code is invalid.
    pub sector: usize,
    /// The sector differs from the last sample's.
    pub edge: bool,
    /// It is the next one forward.
    pub forward: bool,
    /// It is the next one backward.
    pub backward: bool,
}

impl HallEvent {
    /// Compares a sample's code with the sector of the last sample (0: none yet).
    #[inline]
    pub fn new(sectors: &[usize; 8], hall: u8, sector_prev: usize) -> Self {
        let code = sectors[usize::from(hall.min(7))];
        let sector = if code != 0 { code } else { sector_prev };
        let edge = sector != sector_prev && sector_prev != 0;
        let forward = NEXT[sector_prev] == sector;
        let backward = NEXT[sector] == sector_prev;
        Self {
            sector,
            edge,
            forward,
            backward,
        }
    }
}

/// The edge that a change of the sector crosses, 0 to 2: opposite ones are the same sensor's.
#[inline]
pub fn crossed_edge(event: &HallEvent, sector_prev: usize) -> usize {
    let begins = if event.forward {
        event.sector
    } else {
        sector_prev
    };
    // Before the first sector, the third edge.
    (begins + 2) % 3
}

/// Edges at which the sector behind a crossed one begins and ends.
#[inline]
pub fn ends(crossed: usize, forward: bool) -> [usize; 2] {
    if forward {
        [crossed, (crossed + 1) % 3]
    } else {
        [(crossed + 2) % 3, crossed]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_agree_with_each_other() {
        for sector in 1..=6 {
            let mut corner = [
                CORNER_A[sector],
                CORNER_B[sector],
                -CORNER_A[sector] - CORNER_B[sector],
            ];
            assert_eq!(corner[PLUS[sector]], 1.0);
            assert_eq!(corner[MINUS[sector]], -1.0);
            assert_eq!(corner[OUT_PHASE[sector]], 0.0);
            // The outgoing phase carried current in the sector before.
            let before = NEXT.iter().position(|&next| next == sector).unwrap();
            corner = [
                CORNER_A[before],
                CORNER_B[before],
                -CORNER_A[before] - CORNER_B[before],
            ];
            assert_eq!(corner[OUT_PHASE[sector]], OUT_SIGN[sector]);
        }
    }
}
