//! Alpha-beta vectors (amplitude-invariant) and zero-sum phase values.

use nalgebra::{Vector2, Vector3};

/// Amplitude-invariant Clarke transform.
pub fn clarke(x: &Vector3<f64>) -> Vector2<f64> {
    Vector2::new(
        (2.0 * x[0] - x[1] - x[2]) / 3.0,
        (x[1] - x[2]) / 3f64.sqrt(),
    )
}

/// The zero-sum phase values of an alpha-beta vector.
pub fn phases(x: &Vector2<f64>) -> Vector3<f64> {
    let (half_a, quadrature) = (x[0] / 2.0, x[1] * 3f64.sqrt() / 2.0);
    Vector3::new(x[0], quadrature - half_a, -quadrature - half_a)
}

/// Alpha-beta of phases a, b with zero sum.
pub fn from_ab(a: f64, b: f64) -> Vector2<f64> {
    clarke(&Vector3::new(a, b, -(a + b)))
}

/// Phases a, b of an alpha-beta vector.
pub fn to_ab(x: &Vector2<f64>) -> [f64; 2] {
    let phases = phases(x);
    [phases[0], phases[1]]
}
