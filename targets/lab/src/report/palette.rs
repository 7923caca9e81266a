//! Colours of figures.
//!
//! Variants use the palette of Okabe and Ito, then three colours of Paul Tol's muted one and one of
//! his vibrant one; phases Tol's high-contrast one. All are safe for colour-blind readers. Variants and phases share no
//! colour, so that a colour is unambiguous.

use serde::Serialize;

/// Red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Color(pub u8, pub u8, pub u8);

/// Text.
pub const INK: Color = Color(0x1F, 0x23, 0x28);
/// Axes and tick marks.
pub const AXIS: Color = Color(0x6B, 0x72, 0x7B);
/// Grid lines.
pub const GRID: Color = Color(0xE3, 0xE6, 0xEA);
/// The ideal wave or hexagon, drawn broad below the measured one.
pub const IDEAL: Color = Color(0xBF, 0xC5, 0xCC);
/// Demands and limits.
pub const DEMAND: Color = Color(0x3D, 0x44, 0x4D);
/// Phases a, b, c.
pub const PHASES: [Color; 3] = [
    Color(0x00, 0x44, 0x88),
    Color(0xDD, 0xAA, 0x33),
    Color(0xBB, 0x55, 0x66),
];
/// Variants, in the order of their table.
pub const VARIANTS: [Color; 12] = [
    Color(0x00, 0x72, 0xB2),
    Color(0xD5, 0x5E, 0x00),
    Color(0x00, 0x9E, 0x73),
    Color(0xCC, 0x79, 0xA7),
    Color(0xE6, 0x9F, 0x00),
    Color(0x56, 0xB4, 0xE9),
    Color(0x7A, 0x5C, 0x3E),
    Color(0x7F, 0x7F, 0x7F),
    Color(0x33, 0x22, 0x88),
    Color(0x99, 0x99, 0x33),
    Color(0x88, 0x22, 0x55),
    Color(0xEE, 0x33, 0x77),
];

/// Colour of the variant with this index in the table; repeats beyond the palette.
pub fn variant(index: usize) -> Color {
    VARIANTS[index % VARIANTS.len()]
}
