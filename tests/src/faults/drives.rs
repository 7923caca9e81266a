//! The drives with planted faults.

use crate::options::Drive;

/// Minimum percentage of the faults planted in each drive that the comparison must detect, a per
/// cent or two below the present score: a weaker comparison falls below. In a table of parabolas one unit more of t^2 is at most
/// a quarter of a unit of the function.
pub const LEAST_NOTICED: [u8; 13] = [91, 88, 88, 89, 93, 84, 86, 92, 81, 74, 95, 77, 60];

/// Together these have every stage of a step of every kind of controller.
pub const DRIVES: &[Drive] = &[
    Drive {
        kind: "pdcc",
        motor: "trivedi-keshri-660w",
        settings: &[("saturation", "torque_priority")],
    },
    Drive {
        kind: "pdcc",
        motor: "anaheim-bly341s",
        settings: &[
            ("modulation", "pair"),
            ("saturation", "nearest"),
            ("advance", "1.5"),
            ("v_bus", "measured"),
            ("stall_timeout", "100ms"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "pdcc",
        motor: "estun-emj-04apb22",
        settings: &[
            ("saturation", "keep_angle"),
            ("emf", "model"),
            ("reference", "proportional"),
            ("hall_capture", "timer"),
            ("adc_inverted", "on"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "pdcc",
        motor: "teknic-m2310p",
        settings: &[
            ("modulation", "pair"),
            ("saturation", "keep_angle"),
            ("emf", "unfiltered"),
            ("delay", "0"),
            ("word", "16"),
            ("discretisation", "euler"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "fcs-mpc",
        motor: "trivedi-keshri-660w",
        settings: &[("start_up", "short")],
    },
    Drive {
        kind: "fcs-mpc",
        motor: "anaheim-bly341s",
        settings: &[
            ("candidates", "all"),
            ("emf", "model"),
            ("legs", "bootstrap"),
            ("v_bus", "measured"),
            ("hall_capture", "timer"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "fcs-mpc",
        motor: "estun-emj-04apb22",
        settings: &[
            ("candidates", "all"),
            ("off_leg", "nominal"),
            ("delay", "0"),
            ("word", "16"),
            ("discretisation", "euler"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "fcs-mpc",
        motor: "teknic-m2310p",
        settings: &[
            ("off_leg", "nominal"),
            ("adc_inverted", "on"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "phcc",
        motor: "trivedi-keshri-660w",
        settings: &[("start_up", "short")],
    },
    Drive {
        kind: "phcc",
        motor: "estun-emj-04apb22",
        settings: &[
            ("table", "given"),
            ("band", "narrow"),
            ("delay", "0"),
            ("word", "16"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "pi-pwm",
        motor: "teknic-m2310p",
        settings: &[("saturation", "nearest"), ("start_up", "short")],
    },
    Drive {
        kind: "pi-pwm",
        motor: "anaheim-bly172s",
        settings: &[
            ("saturation", "keep_angle"),
            ("feed_forward", "off"),
            ("tuning", "slow_integral"),
            ("word", "16"),
            ("v_bus", "measured"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "p-pwm",
        motor: "hurst-long",
        settings: &[("emf", "model"), ("advance", "0"), ("start_up", "short")],
    },
];
