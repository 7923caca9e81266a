//! The paper's motor and inverter in numbers.

/// Pole of the discrete plant, its gain in A/V and the gain's inverse, exact discretisation.
pub(super) const A: f64 = 0.969_784_1;
pub(super) const B: f64 = 0.223_818_4;
pub(super) const K: f64 = 1.0 / B;

/// Bus voltage, and counts of the timer.
pub(super) const BUS: f64 = 48.0;
pub(super) const TIMER: f64 = 1800.0;

/// Ampere per ADC count.
pub(super) const GAIN: f64 = 80.0 / 4096.0;

/// Demanded current, ampere.
pub(super) const DEMAND: f64 = 20.0;

pub(super) const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// Corner of the reference in ampere, by Hall code: Clarke of (+I, -I, 0) on the sector's pair.
pub(super) const CORNERS: [[f64; 2]; 8] = [
    [0.0, 0.0],
    [0.0, -2.0 * SIDE],
    [-DEMAND, SIDE],
    [-DEMAND, -SIDE],
    [DEMAND, SIDE],
    [DEMAND, -SIDE],
    [0.0, 2.0 * SIDE],
    [0.0, 0.0],
];
pub(super) const SIDE: f64 = DEMAND / SQRT_3;

/// Vectors V0 to V6 in volt, and their legs.
pub(super) const VECTORS: [[f64; 2]; 7] = [
    [0.0, 0.0],
    [-BUS / 3.0, -BUS / SQRT_3],
    [BUS / 3.0, -BUS / SQRT_3],
    [2.0 * BUS / 3.0, 0.0],
    [BUS / 3.0, BUS / SQRT_3],
    [-BUS / 3.0, BUS / SQRT_3],
    [-2.0 * BUS / 3.0, 0.0],
];
pub(super) const LEGS: [[u16; 3]; 7] = [
    [0, 0, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 1, 1],
];
