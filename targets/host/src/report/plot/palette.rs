//! Colours of plots, and how the page's dark scheme redraws them.
//!
//! Variants use the palette of Okabe and Ito, then three colours of Paul Tol's muted one; phases Tol's
//! high-contrast one. All are safe for colour-blind readers. Variants and phases share no colour, so a line is
//! either.

use plotters::style::RGBColor;
use std::fmt::Write;

/// Text.
pub const INK: RGBColor = RGBColor(0x1F, 0x23, 0x28);
/// Axes and tick marks.
pub const AXIS: RGBColor = RGBColor(0x6B, 0x72, 0x7B);
/// Grid lines.
pub const GRID: RGBColor = RGBColor(0xE3, 0xE6, 0xEA);
/// The ideal wave or hexagon, drawn broad below the measured one.
pub const IDEAL: RGBColor = RGBColor(0xBF, 0xC5, 0xCC);
/// Demands and limits.
pub const DEMAND: RGBColor = RGBColor(0x3D, 0x44, 0x4D);
/// Phases a, b, c.
pub const PHASES: [RGBColor; 3] = [
    RGBColor(0x00, 0x44, 0x88),
    RGBColor(0xDD, 0xAA, 0x33),
    RGBColor(0xBB, 0x55, 0x66),
];
const VARIANTS: [RGBColor; 11] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
    RGBColor(0x56, 0xB4, 0xE9),
    RGBColor(0x7A, 0x5C, 0x3E),
    RGBColor(0x7F, 0x7F, 0x7F),
    RGBColor(0x33, 0x22, 0x88),
    RGBColor(0x99, 0x99, 0x33),
    RGBColor(0x88, 0x22, 0x55),
];

/// Colours that the dark scheme replaces; the others read well on both grounds.
const DARK: [(RGBColor, &str); 13] = [
    (INK, "#D7DCE2"),
    (AXIS, "#8B949E"),
    (GRID, "#2D333B"),
    (IDEAL, "#545D68"),
    (DEMAND, "#ADBAC7"),
    (PHASES[0], "#6CA6E0"),
    (PHASES[2], "#E0788A"),
    (VARIANTS[0], "#4DA3D9"),
    (VARIANTS[1], "#F07F35"),
    (VARIANTS[2], "#2FC295"),
    (VARIANTS[6], "#B8946C"),
    (VARIANTS[8], "#9A8CF0"),
    (VARIANTS[10], "#CC66A0"),
];

/// Colour of the variant at a place in the table; places beyond the palette begin anew.
pub fn variant(index: usize) -> RGBColor {
    VARIANTS[index % VARIANTS.len()]
}

/// The colour as CSS writes it and as plots contain it.
pub fn css(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// Rules that redraw plots and swatches for a dark ground.
pub fn dark_rules() -> String {
    let mut rules = String::new();
    for (light, dark) in DARK {
        let light = css(light);
        // Writing to a String cannot fail.
        let _ = writeln!(
            rules,
            ".plot [stroke=\"{light}\"],.swatch [stroke=\"{light}\"]{{stroke:{dark}}}\
             .plot [fill=\"{light}\"],.swatch [fill=\"{light}\"]{{fill:{dark}}}"
        );
    }
    rules
}
