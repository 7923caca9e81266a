//! Planted faults that change no output and no state, each with its reason.

use super::unnoticed::{
    COMMUTATES, ESTUN, FCS, FCS_ESTUN, FCS_HOVERBOARD, FCS_PAPER, FCS_TEKNIC, HOVERBOARD, PAPER,
    PHCC_ESTUN, PHCC_PAPER, PI_ANAHEIM, PI_TEKNIC, TEKNIC, Unnoticed,
};

/// All of them.
pub const EQUIVALENT: &[Unnoticed] = &[
    Unnoticed {
        because: "a sample without a code has no sector of its own",
        drives: &[
            PAPER,
            HOVERBOARD,
            ESTUN,
            TEKNIC,
            FCS_PAPER,
            FCS_HOVERBOARD,
            FCS_ESTUN,
            FCS_TEKNIC,
            PHCC_PAPER,
            PHCC_ESTUN,
            PI_TEKNIC,
        ],
        faults: &[(&["hall_sector[0]"], &["one more"])],
    },
    Unnoticed {
        because: "only the magnitude of this current is used",
        drives: &[HOVERBOARD, TEKNIC, FCS_PAPER, PHCC_PAPER],
        faults: &[(&["meet_emf: i_c_prev"], &["sign lost"])],
    },
    Unnoticed {
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
    Unnoticed {
        because: "every leg word but 0 and 1 is off",
        drives: &[
            FCS_PAPER,
            FCS_HOVERBOARD,
            FCS_ESTUN,
            FCS_TEKNIC,
            PHCC_PAPER,
            PHCC_ESTUN,
        ],
        faults: &[(
            &[
                "vector_leg_a[7]",
                "vector_leg_a[10]",
                "vector_leg_b[9]",
                "vector_leg_b[12]",
                "vector_leg_c[8]",
                "vector_leg_c[11]",
            ],
            &["one more"],
        )],
    },
    Unnoticed {
        because: "every leg word but 0 and 1 is off",
        drives: &[FCS_PAPER, FCS_TEKNIC, PHCC_PAPER, PHCC_ESTUN],
        faults: &[(
            &["vector_leg_a[13]", "vector_leg_b[14]", "vector_leg_c[15]"],
            &["one more"],
        )],
    },
    Unnoticed {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: &[
            PAPER, HOVERBOARD, TEKNIC, FCS_PAPER, FCS_ESTUN, FCS_TEKNIC, PHCC_PAPER, PI_TEKNIC,
        ],
        faults: &[(&["line_a[0]", "line_b[0]"], &["one more"])],
    },
    Unnoticed {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: &[HOVERBOARD],
        faults: &[(&["corner_a[0]", "corner_b[0]"], &["one more"])],
    },
    Unnoticed {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: &[
            PAPER,
            TEKNIC,
            FCS_PAPER,
            FCS_HOVERBOARD,
            FCS_ESTUN,
            FCS_TEKNIC,
            PHCC_PAPER,
            PHCC_ESTUN,
            PI_TEKNIC,
            PI_ANAHEIM,
        ],
        faults: &[(&["corner_a[0]", "corner_b[0]"], &["one more"])],
    },
    Unnoticed {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: &[HOVERBOARD, ESTUN, FCS_HOVERBOARD],
        faults: &[(&["next_sector[0]", "sector_start[0]"], &["one more"])],
    },
    Unnoticed {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: COMMUTATES,
        faults: &[(&["outgoing_a[0]", "outgoing_b[0]"], &["one more"])],
    },
    Unnoticed {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: &[HOVERBOARD, TEKNIC, FCS_PAPER, PHCC_PAPER],
        faults: &[(&["off_phase[0]"], &["one more"])],
    },
    Unnoticed {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: &[HOVERBOARD, TEKNIC],
        faults: &[
            (
                &["pair_sign_a[0]", "pair_sign_b[0]", "pair_sign_c[0]"],
                &["one more"],
            ),
            (
                &["modulate_pair: in off_pair"],
                &["-1 for 0 (3)", "1 for 0 (4)", "-1 for 0 (4)"],
            ),
        ],
    },
    Unnoticed {
        because: "there is no sector 0 but before the first valid Hall code, and that trips",
        drives: &[FCS_PAPER, FCS_TEKNIC],
        faults: &[(&["zero_vector[0]"], &["one more"])],
    },
    Unnoticed {
        because: "there is neither a sector 0, but before the first valid Hall code, which trips, nor a seventh",
        drives: &[PHCC_PAPER, PHCC_ESTUN],
        faults: &[(
            &[
                "switching[0..8]",
                "switching[56..64]",
                "switching[64..72]",
                "switching[120..128]",
                "switching[128..136]",
                "switching[184..192]",
                "switching[192..200]",
                "switching[384..392]",
                "switching[440..448]",
                "switching[448..456]",
                "switching[504..512]",
            ],
            &["one more"],
        )],
    },
    Unnoticed {
        because: "direction is 1 or -1",
        drives: &[HOVERBOARD, ESTUN, FCS_HOVERBOARD],
        faults: &[
            (&["interpolate_angle: in forward"], &["-1 for 0"]),
            (&["interpolate_angle: forward"], &["another comparison"]),
        ],
    },
    Unnoticed {
        because: "the age before an edge is at least two ticks, that after it one",
        drives: &[HOVERBOARD],
        faults: &[
            (&["measure_speed: in interval"], &["0 for 1"]),
            (&["measure_speed: interval"], &["lower limit left out"]),
        ],
    },
    Unnoticed {
        because: "the greatest speed turns the rotor by less in a period",
        drives: &[HOVERBOARD, ESTUN, FCS_HOVERBOARD],
        faults: &[(
            &["turn_max"],
            &["one more", "one less", "bit 9", "bit 19", "bit 28"],
        )],
    },
    Unnoticed {
        because: "an angle that is not tracked is not used",
        drives: &[HOVERBOARD],
        faults: &[(
            &["sector_centre"],
            &["one more", "one less", "bit 9", "bit 19", "bit 28"],
        )],
    },
    Unnoticed {
        because: "without a known speed the rotor does not turn, and its EMF is the change of flux",
        drives: &[FCS_HOVERBOARD],
        faults: &[(
            &["sector_centre"],
            &["one more", "one less", "bit 9", "bit 19", "bit 28"],
        )],
    },
    Unnoticed {
        because: "at the centres of all six sectors the shape rounds to the same, and the rotor does not turn",
        drives: &[ESTUN],
        faults: &[(&["sector_centre"], &["one more"])],
    },
    Unnoticed {
        because: "one and a half periods of two ticks are three ticks: nothing to round",
        drives: &[HOVERBOARD],
        faults: &[(&["advance_sector: in sector_eff"], &["rounded down"])],
    },
    Unnoticed {
        because: "the least set-point but 0 makes more than 1",
        drives: &[
            HOVERBOARD,
            FCS_PAPER,
            FCS_HOVERBOARD,
            FCS_TEKNIC,
            PHCC_PAPER,
            PHCC_ESTUN,
        ],
        faults: &[(
            &["follow_commutation: in commutation_goes_on"],
            &["-1 for 0"],
        )],
    },
    Unnoticed {
        because: "a commutation that is followed has a sample left",
        drives: COMMUTATES,
        faults: &[(
            &["follow_commutation: in left_while_flowing"],
            &["limit left out", "-1 for 0"],
        )],
    },
    Unnoticed {
        because: "any number but 0 says that a commutation goes on",
        drives: &[HOVERBOARD, TEKNIC, FCS_PAPER, FCS_TEKNIC],
        faults: &[(&["follow_commutation: in commutating_now"], &["2 for 1"])],
    },
    Unnoticed {
        because: "with no sample left the stage changes nothing, run or not, and nothing else is asked of the commutation",
        drives: &[FCS_HOVERBOARD, FCS_ESTUN],
        faults: &[(&["detect_commutation: in commutation_lasts"], &["-1 for 0"])],
    },
    Unnoticed {
        because: "the least set-point but 0 makes more than 1",
        drives: &[PHCC_PAPER, PHCC_ESTUN],
        faults: &[(&["look_up_vector: in entry"], &["-1 for 0"])],
    },
    Unnoticed {
        because: "a third is a sixth away from its ties",
        drives: &[
            PAPER,
            HOVERBOARD,
            FCS_PAPER,
            FCS_HOVERBOARD,
            PHCC_PAPER,
            PI_TEKNIC,
        ],
        faults: &[(&["k_third"], &["one more", "one less"])],
    },
    Unnoticed {
        because: "what changes by more than the bus can cause leaves an EMF beyond the bus, which is not believed",
        drives: &[TEKNIC],
        faults: &[
            (&["di_min"], &["one more", "one less"]),
            (&["di_max"], &["one less", "one more"]),
            (&["di_min"], &["bit 5", "bit 10", "bit 14"]),
            (&["di_max"], &["bit 4", "bit 9"]),
            (
                &["estimate_emf: di_a", "estimate_emf: di_b"],
                &["lower limit left out", "upper limit left out"],
            ),
        ],
    },
    Unnoticed {
        because: "the product at the limit rounds to the same",
        drives: &[PAPER, FCS_PAPER, FCS_TEKNIC, PHCC_PAPER, PI_TEKNIC],
        faults: &[(&["di_min"], &["one more"]), (&["di_max"], &["one less"])],
    },
    Unnoticed {
        because: "the product at the limit rounds to the same",
        drives: &[HOVERBOARD],
        faults: &[(&["di_min"], &["one more"])],
    },
    Unnoticed {
        because: "the product at the limit rounds to the same",
        drives: &[HOVERBOARD, FCS_PAPER],
        faults: &[(&["di_min"], &["one less"]), (&["di_max"], &["one more"])],
    },
    Unnoticed {
        because: "the set-point words of all inputs are the same",
        drives: &[TEKNIC, PI_ANAHEIM],
        faults: &[
            (&["k_torque"], &["one more", "one less"]),
            (&["i_max_bits"], &["one more"]),
        ],
    },
    Unnoticed {
        because: "the set-point words of all inputs are the same",
        drives: &[TEKNIC, PI_ANAHEIM],
        faults: &[(&["i_max_bits"], &["one less"])],
    },
    Unnoticed {
        because: "the set-point words of all inputs are the same",
        drives: &[FCS_ESTUN],
        faults: &[
            (&["k_torque"], &["one more", "one less"]),
            (&["i_max_bits", "t_max_bits"], &["one more"]),
        ],
    },
    Unnoticed {
        because: "the flux changes by less within a period at the greatest speed",
        drives: &[FCS_HOVERBOARD],
        faults: &[(&["e_max"], &["one more", "one less", "bit 7", "bit 15"])],
    },
    Unnoticed {
        because: "the flux changes by less within a period at the greatest speed",
        drives: &[ESTUN],
        faults: &[(&["e_max"], &["one more", "one less", "bit 8", "bit 16"])],
    },
    Unnoticed {
        because: "the flux changes by less within a period at the greatest speed",
        drives: &[ESTUN, FCS_HOVERBOARD],
        faults: &[(
            &[
                "model_emf: e_a",
                "model_emf: e_b",
                "model_emf: e_a_now",
                "model_emf: e_b_now",
            ],
            &["lower limit left out", "upper limit left out"],
        )],
    },
    Unnoticed {
        because: "the bus is a whole number of units, and its limits are narrower than the ADC's range",
        drives: &[HOVERBOARD, FCS_HOVERBOARD, PI_ANAHEIM],
        faults: &[
            (&["k_bus"], &["one more"]),
            (
                &["bus_adc_max"],
                &["one more", "one less", "bit 4", "bit 8"],
            ),
            (&["set_bus: in v_bus_new"], &["limit left out"]),
        ],
    },
    Unnoticed {
        because: "the bus is a whole number of units, and its limits are narrower than the ADC's range",
        drives: &[HOVERBOARD, FCS_HOVERBOARD],
        faults: &[
            (&["k_bus"], &["one less"]),
            (&["set_bus: in v_bus_new"], &["rounded down"]),
        ],
    },
    Unnoticed {
        because: "the bus is a whole number of units, and its limits are narrower than the ADC's range",
        drives: &[PI_ANAHEIM],
        faults: &[(&["k_bus"], &["bit 10"])],
    },
    Unnoticed {
        because: "the least bus voltage makes the limit itself",
        drives: &[HOVERBOARD, PI_ANAHEIM],
        faults: &[(&["ratio_max"], &["one more", "bit 9"])],
    },
    Unnoticed {
        because: "a voltage on the hexagon is limited to itself",
        drives: &[HOVERBOARD, ESTUN, TEKNIC, PI_TEKNIC, PI_ANAHEIM],
        faults: &[(&["find_saturation: saturated"], &["another comparison"])],
    },
    Unnoticed {
        because: "the terminals sum to a multiple of three or one less: with one more their mean rounds to the same",
        drives: &[PI_TEKNIC],
        faults: &[(&["limit_nearest: in terminal_c"], &["1 for 0"])],
    },
    Unnoticed {
        because: "a limited voltage spreads over more than the bus, so its scale is between 0 and 1",
        drives: &[ESTUN, TEKNIC, PI_ANAHEIM],
        faults: &[(
            &["limit_keep_angle: in scale"],
            &[
                "1073741825 for 1073741824",
                "1073741823 for 1073741824",
                "2 for 1",
                "0 for 1",
                "limit left out",
            ],
        )],
    },
    Unnoticed {
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
    Unnoticed {
        because: "no phase of a voltage on the hexagon exceeds the bus",
        drives: &[ESTUN, TEKNIC, PI_ANAHEIM],
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
    Unnoticed {
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
    Unnoticed {
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
    Unnoticed {
        because: "where both lines are equally heavy, both are at the bus",
        drives: &[PAPER],
        faults: &[(&["limit_torque_priority: x_heavy"], &["another comparison"])],
    },
    Unnoticed {
        because: "limited voltages lie within the bus up to less than half a timer tick",
        drives: &[HOVERBOARD, PI_ANAHEIM],
        faults: &[(&["timer_period"], &["one more", "bit 7"])],
    },
    Unnoticed {
        because: "limited voltages lie within the bus up to less than half a timer tick",
        drives: &[PI_ANAHEIM],
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
    Unnoticed {
        because: "limited voltages lie within the bus up to less than half a timer tick",
        drives: &[HOVERBOARD],
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
    Unnoticed {
        because: "a limited voltage leaves the bus, centred, by less than half a timer tick",
        drives: &[PAPER],
        faults: &[
            (
                &["limit_torque_priority: in centred_max"],
                &["2 for 1", "0 for 1", "second term left out", "- for +"],
            ),
            (&["limit_torque_priority: centred_max"], &["shift one less"]),
            (
                &[
                    "limit_torque_priority: in centred_a_limited",
                    "limit_torque_priority: in centred_b_limited",
                    "limit_torque_priority: in centred_c_limited",
                ],
                &["limit left out", "limit left out (2)"],
            ),
        ],
    },
    Unnoticed {
        because: "a limited voltage leaves the bus, centred, by less than half a timer tick",
        drives: &[HOVERBOARD],
        faults: &[
            (
                &["limit_nearest: in centred_max"],
                &["2 for 1", "0 for 1", "second term left out"],
            ),
            (&["limit_nearest: centred_max"], &["shift one less"]),
            (
                &[
                    "limit_nearest: in centred_a_limited",
                    "limit_nearest: centred_a_limited",
                    "limit_nearest: in centred_b_limited",
                    "limit_nearest: centred_b_limited",
                    "limit_nearest: in centred_c_limited",
                    "limit_nearest: centred_c_limited",
                ],
                &["limit left out"],
            ),
        ],
    },
    Unnoticed {
        because: "a limited voltage leaves the bus, centred, by less than half a timer tick",
        drives: &[ESTUN, TEKNIC, PI_ANAHEIM],
        faults: &[
            (
                &["limit_keep_angle: in centred_max"],
                &["2 for 1", "0 for 1", "second term left out"],
            ),
            (&["limit_keep_angle: centred_max"], &["shift one less"]),
            (
                &[
                    "limit_keep_angle: in centred_a_limited",
                    "limit_keep_angle: in centred_b_limited",
                    "limit_keep_angle: in centred_c_limited",
                ],
                &["limit left out"],
            ),
        ],
    },
    Unnoticed {
        because: "a limited voltage leaves the bus, centred, by less than half a timer tick",
        drives: &[TEKNIC, PI_ANAHEIM],
        faults: &[(
            &[
                "limit_keep_angle: centred_a_limited",
                "limit_keep_angle: centred_b_limited",
                "limit_keep_angle: centred_c_limited",
            ],
            &["limit left out"],
        )],
    },
    Unnoticed {
        because: "a limited voltage leaves the bus, centred, by less than half a timer tick",
        drives: &[ESTUN],
        faults: &[(
            &[
                "limit_keep_angle: in centred_a_limited",
                "limit_keep_angle: in centred_b_limited",
                "limit_keep_angle: in centred_c_limited",
            ],
            &["limit left out (2)"],
        )],
    },
    Unnoticed {
        because: "a limited voltage leaves the bus, centred, by less than half a timer tick",
        drives: &[ESTUN, PI_ANAHEIM],
        faults: &[(&["limit_keep_angle: in centred_max"], &["- for +"])],
    },
    Unnoticed {
        because: "the middle of limited voltages is rounded down: no terminal is below zero",
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
    Unnoticed {
        because: "a centred voltage is at most half the bus above the middle",
        drives: &[HOVERBOARD, TEKNIC],
        faults: &[(
            &[
                "modulate_three: terminal_a_three",
                "modulate_three: terminal_b_three",
                "modulate_three: terminal_c_three",
            ],
            &["upper limit left out"],
        )],
    },
    Unnoticed {
        because: "two vectors have different numbers",
        drives: &[FCS_PAPER, FCS_HOVERBOARD, FCS_ESTUN],
        faults: &[(
            &["nearest_pair: in take_c", "nearest_pair: in take_b"],
            &["another comparison (3)"],
        )],
    },
    Unnoticed {
        because: "a line voltage next to zero is not the longest, or V0 is nearest",
        drives: &[FCS_ESTUN],
        faults: &[(
            &[
                "nearest_pair: in pair_a",
                "nearest_pair: in pair_c",
                "nearest_pair: in pair_b",
            ],
            &["1 for 0", "-1 for 0", "another comparison"],
        )],
    },
    Unnoticed {
        because: "where two pair vectors tie, V0 or the three-phase vector between them is as near and comes first",
        drives: &[FCS_ESTUN],
        faults: &[
            (
                &["nearest_pair: in take_c"],
                &[
                    "another comparison",
                    "another comparison (2)",
                    "operands swapped (2)",
                    "or for and",
                    "second left out",
                ],
            ),
            (
                &["nearest_pair: take_c", "nearest_pair: take_b"],
                &["second left out"],
            ),
            (
                &["nearest_pair: in take_b"],
                &[
                    "another comparison",
                    "operands swapped (2)",
                    "second left out",
                ],
            ),
        ],
    },
    Unnoticed {
        because: "a pair vector with its leg at either rail is a three-phase vector, which stands before it in the list",
        drives: &[FCS_HOVERBOARD],
        faults: &[(&["predict_off_legs: h_c"], &["sign lost"])],
    },
    Unnoticed {
        because: "scores are multiples of three",
        drives: &[FCS_ESTUN],
        faults: &[(&["nearest_pair: in vector"], &["-1 for 0"])],
    },
    Unnoticed {
        because: "without an EMF the integral is a mean of itself and the limited voltage",
        drives: &[PI_ANAHEIM],
        faults: &[
            (&["integral_min", "integral_max"], &["one more", "one less"]),
            (&["integral_min"], &["bit 6", "bit 12", "bit 17"]),
            (&["integral_max"], &["bit 5", "bit 11"]),
            (
                &["integrate: integral_a_now", "integrate: integral_b_now"],
                &["lower limit left out", "upper limit left out"],
            ),
        ],
    },
    Unnoticed {
        because: "a terminal is limited once more where it becomes a compare value",
        drives: &[HOVERBOARD],
        faults: &[
            (
                &["find_saturation: spread"],
                &["+ for -", "operands swapped"],
            ),
            (&["find_saturation: saturated"], &["operands swapped"]),
            (
                &[
                    "limit_nearest: in terminal_a",
                    "limit_nearest: in terminal_b",
                    "limit_nearest: in terminal_c",
                ],
                &["-1 for 0"],
            ),
            (
                &[
                    "limit_nearest: terminal_a",
                    "limit_nearest: terminal_b",
                    "limit_nearest: terminal_c",
                ],
                &["lower limit left out", "upper limit left out"],
            ),
        ],
    },
    Unnoticed {
        because: "three phases that sum to zero are neither all high nor all low, but at zero",
        drives: FCS,
        faults: &[(
            &["vector_of_low_legs[0]", "vector_of_low_legs[7]"],
            &["one more"],
        )],
    },
    Unnoticed {
        because: "where the third phase is at zero and the second next to it, V0 is nearest",
        drives: FCS,
        faults: &[(
            &["nearest_vector: in c_is_low"],
            &["1 for 0", "-1 for 0", "another comparison"],
        )],
    },
    Unnoticed {
        because: "four less and four more are the same entry of eight",
        drives: FCS,
        faults: &[(&["nearest_vector: low_legs"], &["- for +"])],
    },
    Unnoticed {
        because: "where V0 and a three-phase vector tie, a pair vector is at least as near",
        drives: &[FCS_ESTUN],
        faults: &[(&["third_of_bus"], &["one more", "one less"])],
    },
    Unnoticed {
        because: "where two three-phase vectors tie, the pair vector between them is nearer",
        drives: &[FCS_ESTUN],
        faults: &[
            (
                &["nearest_vector: in b_is_low"],
                &["2 for 1", "0 for 1", "+ for -", "1 for 0", "-1 for 0"],
            ),
            (
                &[
                    "nearest_vector: b_is_low",
                    "nearest_vector: a_is_low",
                    "nearest_vector: c_is_low",
                ],
                &["another comparison"],
            ),
            (
                &["nearest_vector: in a_is_low"],
                &[
                    "2 for 1",
                    "0 for 1",
                    "1 for 0",
                    "-1 for 0",
                    "branches swapped",
                    "+ for -",
                    "1 for 0 (2)",
                    "-1 for 0 (2)",
                ],
            ),
            (
                &["nearest_vector: in c_is_low"],
                &[
                    "operands swapped",
                    "not left out",
                    "2 for 1",
                    "0 for 1",
                    "1 for 0 (2)",
                    "-1 for 0 (2)",
                    "branches swapped",
                    "+ for -",
                    "1 for 0 (3)",
                    "-1 for 0 (3)",
                ],
            ),
        ],
    },
    Unnoticed {
        because: "two of the eight patterns are no order",
        drives: &[FCS_TEKNIC],
        faults: &[(&["pair_of_order[1]", "pair_of_order[6]"], &["one more"])],
    },
    Unnoticed {
        because: "four less and four more are the same entry of eight",
        drives: &[FCS_TEKNIC],
        faults: &[(&["nearest_pair: order"], &["- for +"])],
    },
];
