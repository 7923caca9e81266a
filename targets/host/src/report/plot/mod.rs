//! The plots, as inline SVG: sizes in CSS pixels, colours from one palette, legends left to HTML.

mod bars;
mod canvas;
pub mod palette;
mod stability;
mod torque_speed;
mod trajectory;
mod wave;

pub use bars::{Bars, Group, bars};
pub use stability::{SEARCH, stability};
pub use torque_speed::{Curve, TorqueSpeed, dash, torque_speed};
pub use trajectory::trajectory;
pub use wave::{Wave, wave};
