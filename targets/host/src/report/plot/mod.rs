//! The plots, as inline SVG: sizes in CSS pixels, colours from one palette, legends left to HTML.

mod bars;
mod canvas;
mod histogram;
mod levels;
pub mod palette;
mod plane;
mod stability;
mod torque_speed;
mod trajectory;
mod wave;

pub use bars::{Bars, Group, bars};
pub use histogram::{Histogram, histogram};
pub use levels::{Level, levels};
pub use plane::{Named, Path, Plane, plane};
pub use stability::{SEARCH, stability};
pub use torque_speed::{Curve, TorqueSpeed, dash, torque_speed};
pub use trajectory::{corners, means, trajectory};
pub use wave::{Wave, wave};
