//! Planted faults that change no output and no state, each with its reason.

const PAPER: &str = "pdcc trivedi-keshri-660w";
const HOVERBOARD: &str = "pdcc hoverboard-hub";
const ESTUN: &str = "pdcc estun-emj-04apb22";
const TEKNIC: &str = "pdcc teknic-m2310p";

/// Faults without effect for the same reason: all of `what` at all of `places`.
pub struct Equivalent {
    pub because: &'static str,
    pub drives: &'static [&'static str],
    faults: &'static [Faults],
}

/// Places and what is wrong at each of them.
type Faults = (&'static [&'static str], &'static [&'static str]);

impl Equivalent {
    /// Place and what is wrong there.
    pub fn faults(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.faults.iter().flat_map(|(places, whats)| {
            let pairs = |place| whats.iter().map(move |what| (place, *what));
            places.iter().flat_map(move |place| pairs(*place))
        })
    }
}

/// All of them.
pub const EQUIVALENT: &[Equivalent] = &[
    Equivalent {
        because: "a sum of full-scale samples is the limit itself",
        drives: &[PAPER, HOVERBOARD, ESTUN, TEKNIC],
        faults: &[
            (&["calibration_sum_max"], &["one more"]),
            (
                &[
                    "advance_sequence: in sum_a_now",
                    "advance_sequence: in sum_b_now",
                ],
                &["limit left out"],
            ),
        ],
    },
    Equivalent {
        because: "a sum of full-scale samples is the limit itself, and this bit makes it greater",
        drives: &[PAPER],
        faults: &[(&["calibration_sum_max"], &["bit 6"])],
    },
    Equivalent {
        because: "a drive in control takes the sequence's branch without effect",
        drives: &[PAPER, HOVERBOARD, ESTUN, TEKNIC],
        faults: &[(&["detect_faults: in sequencing"], &["-1 for 0"])],
    },
    Equivalent {
        because: "without stall time-out there is no fourth fault to tell",
        drives: &[PAPER, ESTUN, TEKNIC],
        faults: &[(&["latch_fault: in fault_latched"], &["3 for 4", "5 for 4"])],
    },
    Equivalent {
        because: "only the magnitude of this current is used",
        drives: &[PAPER, ESTUN],
        faults: &[(&["measure_currents: i_c"], &["sign lost"])],
    },
    Equivalent {
        because: "every leg word but 0 and 1 is off",
        drives: &[PAPER, HOVERBOARD, ESTUN, TEKNIC],
        faults: &[(&["rest: in leg_resting"], &["3 for 2 (2)"])],
    },
    Equivalent {
        because: "every leg word but 0 and 1 is off",
        drives: &[HOVERBOARD, TEKNIC],
        faults: &[(
            &[
                "modulate_pair: in leg_a_pair",
                "modulate_pair: in leg_b_pair",
                "modulate_pair: in leg_c_pair",
            ],
            &["3 for 2"],
        )],
    },
    Equivalent {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: &[PAPER, HOVERBOARD, TEKNIC],
        faults: &[(&["corner_a[0]", "corner_b[0]"], &["one more"])],
    },
    Equivalent {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: &[HOVERBOARD, ESTUN, TEKNIC],
        faults: &[(&["next_sector[0]"], &["one more"])],
    },
    Equivalent {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: &[HOVERBOARD, ESTUN],
        faults: &[(&["sector_start[0]"], &["one more"])],
    },
    Equivalent {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: &[HOVERBOARD, TEKNIC],
        faults: &[
            (
                &[
                    "off_phase[0]",
                    "outgoing_sign[0]",
                    "pair_sign_a[0]",
                    "pair_sign_b[0]",
                    "pair_sign_c[0]",
                ],
                &["one more"],
            ),
            (
                &["modulate_pair: in off_pair"],
                &["-1 for 0 (3)", "1 for 0 (4)", "-1 for 0 (4)"],
            ),
        ],
    },
    Equivalent {
        because: "a phase that is neither the first nor the second is the third",
        drives: &[HOVERBOARD, TEKNIC],
        faults: &[(&["off_phase[2]", "off_phase[5]"], &["one more"])],
    },
    Equivalent {
        because: "direction is 1 or -1",
        drives: &[HOVERBOARD, ESTUN],
        faults: &[
            (&["interpolate_angle: in forward"], &["-1 for 0"]),
            (&["interpolate_angle: forward"], &["another comparison"]),
        ],
    },
    Equivalent {
        because: "steps from or to sector 0, and of none, tell no direction",
        drives: &[TEKNIC],
        faults: &[
            (&["read_hall: in edge"], &["-1 for 0"]),
            (&["read_hall: edge"], &["or for and", "second left out"]),
        ],
    },
    Equivalent {
        because: "the age before an edge is at least two ticks, that after it one",
        drives: &[HOVERBOARD],
        faults: &[
            (&["measure_speed: in interval"], &["0 for 1"]),
            (&["measure_speed: interval"], &["lower limit left out"]),
        ],
    },
    Equivalent {
        because: "the greatest speed turns the rotor by less in a period",
        drives: &[HOVERBOARD, ESTUN],
        faults: &[(
            &["turn_max"],
            &["one more", "one less", "bit 9", "bit 19", "bit 28"],
        )],
    },
    Equivalent {
        because: "an angle that is not tracked is not used",
        drives: &[HOVERBOARD],
        faults: &[(
            &["sector_centre"],
            &["one more", "one less", "bit 9", "bit 19", "bit 28"],
        )],
    },
    Equivalent {
        because: "at the centres of all six sectors the shape rounds to the same, and the rotor does not turn",
        drives: &[ESTUN],
        faults: &[(&["sector_centre"], &["one more"])],
    },
    Equivalent {
        because: "one and a half periods of two ticks are three ticks: nothing to round",
        drives: &[HOVERBOARD],
        faults: &[(&["advance_sector: in sector_eff"], &["rounded down"])],
    },
    Equivalent {
        because: "the least set-point but 0 makes more than 1",
        drives: &[HOVERBOARD],
        faults: &[(
            &["detect_commutation: in outgoing_sign_turned"],
            &["-1 for 0 (2)"],
        )],
    },
    Equivalent {
        because: "the age before counts at an edge only, and the first step has none",
        drives: &[ESTUN],
        faults: &[(&["age_prev"], &["initial value one more"])],
    },
    Equivalent {
        because: "a third of one more rounds to nothing, and only the mean takes the third terminal",
        drives: &[HOVERBOARD],
        faults: &[(&["t_c_cmd"], &["initial value one more"])],
    },
    Equivalent {
        because: "without delay the EMF is stored, but not used in the next step",
        drives: &[TEKNIC],
        faults: &[(&["e_a_prev", "e_b_prev"], &["initial value one more"])],
    },
    Equivalent {
        because: "a third is a sixth away from its ties",
        drives: &[PAPER, HOVERBOARD],
        faults: &[(&["k_third"], &["one more", "one less"])],
    },
    Equivalent {
        because: "0.6 of a whole number is a tenth away from its ties",
        drives: &[HOVERBOARD],
        faults: &[(&["k_filter"], &["one more", "one less"])],
    },
    Equivalent {
        because: "the product at the limit rounds to the same",
        drives: &[PAPER, HOVERBOARD],
        faults: &[(&["di_min", "di_max"], &["one more", "one less"])],
    },
    Equivalent {
        because: "the set-point word at the limit is the same",
        drives: &[TEKNIC],
        faults: &[(&["i_min_bits", "i_max_bits"], &["one more", "one less"])],
    },
    Equivalent {
        because: "the set-point words of all torques within the limits are the same",
        drives: &[TEKNIC],
        faults: &[(&["k_torque"], &["one more", "one less"])],
    },
    Equivalent {
        because: "a filter's result lies between its input and its last result, which are within",
        drives: &[HOVERBOARD],
        faults: &[
            (
                &["e_min", "e_max"],
                &["one more", "one less", "bit 9", "bit 18"],
            ),
            (
                &["estimate_emf: e_a", "estimate_emf: e_b"],
                &["lower limit left out", "upper limit left out"],
            ),
        ],
    },
    Equivalent {
        because: "the flux changes by less within a period at the greatest speed",
        drives: &[ESTUN],
        faults: &[
            (
                &["e_min", "e_max"],
                &["one more", "one less", "bit 8", "bit 16"],
            ),
            (
                &[
                    "model_emf: e_a",
                    "model_emf: e_b",
                    "model_emf: e_a_now",
                    "model_emf: e_b_now",
                ],
                &["lower limit left out", "upper limit left out"],
            ),
        ],
    },
    Equivalent {
        because: "a count is a whole number of units, and the limits of the bus are narrower than the ADC's range",
        drives: &[HOVERBOARD],
        faults: &[
            (&["k_bus"], &["one more", "one less"]),
            (
                &["bus_adc_max"],
                &["one more", "one less", "bit 4", "bit 8"],
            ),
            (
                &["set_bus: in v_bus_new"],
                &["limit left out", "rounded down"],
            ),
        ],
    },
    Equivalent {
        because: "the least bus voltage makes the limit itself",
        drives: &[HOVERBOARD],
        faults: &[(&["ratio_max"], &["one more", "bit 9"])],
    },
    Equivalent {
        because: "a voltage on the hexagon is limited to itself",
        drives: &[HOVERBOARD, ESTUN, TEKNIC],
        faults: &[(&["find_saturation: saturated"], &["another comparison"])],
    },
    Equivalent {
        because: "the terminals sum to a multiple of three or one less: with one more their mean rounds to the same",
        drives: &[PAPER],
        faults: &[(&["limit_torque_priority: in terminal_c"], &["1 for 0"])],
    },
    Equivalent {
        because: "the terminals sum to a multiple of three or one less: with one more their mean rounds to the same",
        drives: &[HOVERBOARD],
        faults: &[(&["limit_nearest: in terminal_c"], &["1 for 0"])],
    },
    Equivalent {
        because: "a limited voltage spreads over more than the bus, so its scale is between 0 and 1",
        drives: &[ESTUN, TEKNIC],
        faults: &[(
            &["limit_keep_angle: in scale"],
            &[
                "0 for 1",
                "2 for 1",
                "1073741823 for 1073741824",
                "1073741825 for 1073741824",
                "limit left out",
            ],
        )],
    },
    Equivalent {
        because: "no phase of a voltage on the hexagon exceeds the bus",
        drives: &[ESTUN, TEKNIC],
        faults: &[(
            &[
                "limit_keep_angle: in u_a_limited",
                "limit_keep_angle: u_a_limited",
                "limit_keep_angle: in u_b_limited",
                "limit_keep_angle: u_b_limited",
            ],
            &["limit left out"],
        )],
    },
    Equivalent {
        because: "no phase of a voltage on the hexagon exceeds the bus",
        drives: &[PAPER],
        faults: &[(
            &[
                "limit_torque_priority: in u_a_limited",
                "limit_torque_priority: u_a_limited",
                "limit_torque_priority: in u_b_limited",
                "limit_torque_priority: u_b_limited",
            ],
            &["limit left out"],
        )],
    },
    Equivalent {
        because: "without a directed EMF the result is not used",
        drives: &[PAPER],
        faults: &[
            (
                &["limit_torque_priority: in f_positive"],
                &["1 for 0", "-1 for 0"],
            ),
            (
                &["limit_torque_priority: f_positive"],
                &["another comparison"],
            ),
            (
                &[
                    "limit_torque_priority: in quotient",
                    "limit_torque_priority: in blend",
                ],
                &["2 for 1"],
            ),
        ],
    },
    Equivalent {
        because: "the lesser two of three EMF that sum to zero are opposite to the greatest",
        drives: &[PAPER],
        faults: &[
            (
                &[
                    "limit_torque_priority: in force_x",
                    "limit_torque_priority: in force_y",
                ],
                &["-1 for 0"],
            ),
            (
                &[
                    "limit_torque_priority: force_x",
                    "limit_torque_priority: force_y",
                ],
                &["limit left out"],
            ),
        ],
    },
    Equivalent {
        because: "where both lines are equally heavy, both are at the bus",
        drives: &[PAPER],
        faults: &[(&["limit_torque_priority: x_heavy"], &["another comparison"])],
    },
    Equivalent {
        because: "limited voltages lie within the bus up to less than half a timer tick",
        drives: &[PAPER, HOVERBOARD, ESTUN, TEKNIC],
        faults: &[(&["timer_period"], &["one more", "bit 7"])],
    },
    Equivalent {
        because: "limited voltages lie within the bus up to less than half a timer tick",
        drives: &[PAPER, ESTUN],
        faults: &[
            (
                &[
                    "modulate: in compare_a_pulsed",
                    "modulate: in compare_b_pulsed",
                    "modulate: in compare_c_pulsed",
                ],
                &["-1 for 0"],
            ),
            (
                &[
                    "modulate: compare_a_pulsed",
                    "modulate: compare_b_pulsed",
                    "modulate: compare_c_pulsed",
                ],
                &["lower limit left out", "upper limit left out"],
            ),
        ],
    },
    Equivalent {
        because: "limited voltages lie within the bus up to less than half a timer tick",
        drives: &[HOVERBOARD, TEKNIC],
        faults: &[
            (
                &[
                    "modulate_three: in compare_a_three",
                    "modulate_three: in compare_b_three",
                    "modulate_three: in compare_c_three",
                    "modulate_pair: in compare_line",
                ],
                &["-1 for 0"],
            ),
            (
                &[
                    "modulate_three: compare_a_three",
                    "modulate_three: compare_b_three",
                    "modulate_three: compare_c_three",
                    "modulate_pair: compare_line",
                ],
                &["lower limit left out", "upper limit left out"],
            ),
        ],
    },
    Equivalent {
        because: "the middle of limited voltages is rounded down: no terminal is below the bus",
        drives: &[HOVERBOARD, TEKNIC],
        faults: &[
            (
                &[
                    "modulate_three: in terminal_a_three",
                    "modulate_three: in terminal_b_three",
                    "modulate_three: in terminal_c_three",
                ],
                &["-1 for 0"],
            ),
            (
                &[
                    "modulate_three: terminal_a_three",
                    "modulate_three: terminal_b_three",
                    "modulate_three: terminal_c_three",
                ],
                &["lower limit left out"],
            ),
        ],
    },
    Equivalent {
        because: "the bus is a multiple of six units: only the third terminal rounds beyond it",
        drives: &[HOVERBOARD],
        faults: &[(
            &[
                "modulate_three: terminal_a_three",
                "modulate_three: terminal_b_three",
            ],
            &["upper limit left out"],
        )],
    },
    Equivalent {
        because: "a leg number but 1, 2 and 3 is no leg",
        drives: &[TEKNIC],
        faults: &[(&["modulate_three: in u_c_pair"], &["-1 for 0"])],
    },
];
