//! The paper's experiment in short: the real drives, with fewer runs.

use hexagen_lab::reproduction::{Effort, Reproduction, reproduce};

/// One start, a coarse curve and a coarse search for the limit.
pub fn data() -> Reproduction {
    let effort = Effort {
        starts: vec![0.1],
        curve_rpm: vec![400.0, 1500.0, 2500.0],
        limit_rpm: (1000.0, 400.0),
    };
    reproduce(&effort, &()).expect("every drive runs")
}
