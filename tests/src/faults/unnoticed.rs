//! Faults that the comparison does not notice, and why.

use std::collections::BTreeMap;

/// Faults that are not noticed for the same reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unnoticed {
    /// The reason.
    pub because: &'static str,
    /// The drives, by kind and motor.
    pub drives: &'static [&'static str],
    /// All faults of each second list at all places of the first; `table[0..8]` is entries 0 to 7.
    pub faults: &'static [Faults],
}

/// Places and what is wrong at each of them.
pub type Faults = (&'static [&'static str], &'static [&'static str]);

impl Unnoticed {
    /// Place and what is wrong there.
    pub fn faults(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.faults.iter().flat_map(|(places, whats)| {
            let pairs = |place| whats.iter().map(move |what| (place, *what));
            places.iter().flat_map(move |place| pairs(*place))
        })
    }
}

pub(super) const PAPER: &str = "pdcc trivedi-keshri-660w";
pub(super) const HOVERBOARD: &str = "pdcc hoverboard-hub";
pub(super) const ESTUN: &str = "pdcc estun-emj-04apb22";
pub(super) const TEKNIC: &str = "pdcc teknic-m2310p";
pub(super) const FCS_PAPER: &str = "fcs-mpc trivedi-keshri-660w";
pub(super) const FCS_HOVERBOARD: &str = "fcs-mpc hoverboard-hub";
pub(super) const FCS_ESTUN: &str = "fcs-mpc estun-emj-04apb22";
pub(super) const FCS_TEKNIC: &str = "fcs-mpc teknic-m2310p";
pub(super) const PHCC_PAPER: &str = "phcc trivedi-keshri-660w";
pub(super) const PHCC_ESTUN: &str = "phcc estun-emj-04apb22";
pub(super) const PI_TEKNIC: &str = "pi-pwm teknic-m2310p";
pub(super) const PI_ANAHEIM: &str = "pi-pwm anaheim-bly172s";

/// Those of FCS-MPC.
pub(super) const FCS: &[&str] = &[FCS_PAPER, FCS_HOVERBOARD, FCS_ESTUN, FCS_TEKNIC];

/// Those that follow commutations.
pub(super) const COMMUTATES: &[&str] = &[
    HOVERBOARD,
    TEKNIC,
    FCS_PAPER,
    FCS_HOVERBOARD,
    FCS_ESTUN,
    FCS_TEKNIC,
    PHCC_PAPER,
    PHCC_ESTUN,
];

/// Faults that change an output or a state in so few states that a run may miss them all.
pub const RARE: &[Unnoticed] = &[
    Unnoticed {
        because: "differs only where the EMF is the 256th part of the bus to the last bit",
        drives: &[PAPER],
        faults: &[(
            &["limit_torque_priority: directed"],
            &["another comparison"],
        )],
    },
    Unnoticed {
        because: "differs only where a compare value is half a count from a whole one to the last bit",
        drives: &[HOVERBOARD],
        faults: &[(&["modulate_three: in compare_a_three"], &["rounded down"])],
    },
    Unnoticed {
        because: "moves the EMF by its last bit at the greatest speeds",
        drives: &[FCS_PAPER],
        faults: &[(&["k_slope"], &["one more", "one less"])],
    },
    Unnoticed {
        because: "moves the EMF by a part of its last bit, and only at the line EMF's limit",
        drives: &[
            PAPER, HOVERBOARD, ESTUN, TEKNIC, FCS_PAPER, FCS_ESTUN, FCS_TEKNIC, PHCC_PAPER,
        ],
        faults: &[(&["line_max"], &["one more", "one less"])],
    },
    Unnoticed {
        because: "differs only where the nearest pair vector has next to no line voltage, with its third leg at a rail",
        drives: &[FCS_PAPER, FCS_HOVERBOARD],
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
        because: "differs only at six voltages, where V0, a three-phase and a pair vector tie",
        drives: &[FCS_PAPER, FCS_HOVERBOARD, FCS_ESTUN],
        faults: &[(
            &["nearest_vector: in vector_three"],
            &["another comparison"],
        )],
    },
    Unnoticed {
        because: "moves the score of the pair's zero vector by no more than its last digits",
        drives: &[FCS_PAPER],
        faults: &[(
            &["nearest_pair: in tau_zero"],
            &["1 for 0 (2)", "1 for 0", "-1 for 0", "-1 for 0 (2)"],
        )],
    },
    Unnoticed {
        because: "differs only where the off leg's EMF is beyond two thirds of the bus and the pair's zero vector is still next to the best",
        drives: &[FCS_PAPER],
        faults: &[(&["nearest_pair: in tau_zero"], &["upper limit left out"])],
    },
    Unnoticed {
        because: "moves the voltage by its last bit, which changes the choice next to a tie only",
        drives: &[FCS_PAPER, FCS_TEKNIC],
        faults: &[(&["k_decay"], &["one more", "one less"])],
    },
    Unnoticed {
        because: "moves the error by its last bit, which shows at the end of its band only",
        drives: &[PHCC_ESTUN],
        faults: &[(
            &["predict_error: in q_a", "predict_error: in q_b"],
            &["rounded down"],
        )],
    },
    Unnoticed {
        because: "differs only where the error is at the end of its band to the last bit",
        drives: &[PHCC_ESTUN],
        faults: &[
            (
                &[
                    "band_alpha",
                    "band_beta",
                    "band_alpha_below",
                    "band_beta_below",
                ],
                &["one more", "one less"],
            ),
            (
                &[
                    "compare_with_bands: alpha_falls",
                    "compare_with_bands: beta_falls",
                ],
                &["another comparison"],
            ),
        ],
    },
    Unnoticed {
        because: "differs only in a commutation of unknown direction, where the rotor jumps over sectors at its first edge",
        drives: &[PHCC_PAPER, PHCC_ESTUN],
        faults: &[(
            &[
                "switching[12..16]",
                "switching[20..24]",
                "switching[28..32]",
                "switching[36..40]",
                "switching[44..48]",
                "switching[52..56]",
                "switching[76..80]",
                "switching[84..88]",
                "switching[92..96]",
                "switching[100..104]",
                "switching[108..112]",
                "switching[116..120]",
            ],
            &["one more"],
        )],
    },
    Unnoticed {
        because: "moves the error by its last bit, which shows at the end of its band only",
        drives: &[PHCC_PAPER],
        faults: &[(&["k_hold"], &["one more", "one less"])],
    },
    Unnoticed {
        because: "differs only where the blend ends to the last bit",
        drives: &[PAPER],
        faults: &[(&["limit_torque_priority: in blend"], &["1 for 0"])],
    },
    Unnoticed {
        because: "differs only where a compare value is half a count from a whole one to the last bit",
        drives: &[HOVERBOARD],
        faults: &[(
            &[
                "modulate_three: in compare_b_three",
                "modulate_three: in compare_c_three",
            ],
            &["rounded down"],
        )],
    },
    Unnoticed {
        because: "differs only where a phase is at a third of the bus to the last bit",
        drives: &[FCS_PAPER, FCS_ESTUN, FCS_TEKNIC],
        faults: &[(
            &["nearest_vector: in vector_three"],
            &["another comparison (2)"],
        )],
    },
    Unnoticed {
        because: "differs only where a phase is at a third of the bus to the last bit",
        drives: &[FCS_PAPER, FCS_ESTUN],
        faults: &[(
            &["nearest_vector: in vector_three"],
            &[
                "another comparison (3)",
                "another comparison (4)",
                "another comparison (6)",
            ],
        )],
    },
    Unnoticed {
        because: "moves a voltage or a score by its last digits, which changes the choice next to a tie only",
        drives: &[FCS_HOVERBOARD],
        faults: &[
            (&["sector_last"], &["one more", "one less", "bit 10"]),
            (
                &[
                    "third_turn",
                    "sector_start[1..7]",
                    "flux_c0[0..12]",
                    "flux_c1[0..12]",
                    "flux_c2[0..12]",
                ],
                &["one more"],
            ),
            (&["k_decay"], &["one more", "one less"]),
            (
                &["model_emf: in flux_start_b", "model_emf: in flux_end_b"],
                &["rounded down"],
            ),
            (
                &["model_emf: in flux_now_a", "model_emf: in flux_now_b"],
                &["rounded down", "rounded down (2)"],
            ),
            (
                &["applied_voltage: in terminal_off"],
                &["1 for 0", "-1 for 0"],
            ),
            (
                &[
                    "predict_off_legs: in d_a",
                    "predict_off_legs: in d_b",
                    "predict_off_legs: in d_c",
                ],
                &["1 for 0"],
            ),
            (
                &["nearest_pair: in score_a", "nearest_pair: in score_b"],
                &["rounded half up"],
            ),
            (
                &["nearest_pair: in take_c", "nearest_pair: in take_b"],
                &[
                    "another comparison",
                    "operands swapped (2)",
                    "second left out",
                ],
            ),
            (
                &["nearest_pair: take_c", "nearest_pair: take_b"],
                &["second left out"],
            ),
        ],
    },
    Unnoticed {
        because: "differs only where a phase is at a third of the bus to the last bit",
        drives: &[FCS_HOVERBOARD],
        faults: &[
            (
                &[
                    "nearest_vector: in u_b_triple",
                    "nearest_vector: in u_c_triple",
                ],
                &["another comparison"],
            ),
            (
                &["nearest_vector: in vector_three"],
                &["another comparison (2)"],
            ),
        ],
    },
    Unnoticed {
        because: "differs only where a phase is next to zero and no third of the bus from the others",
        drives: &[FCS_PAPER, FCS_HOVERBOARD],
        faults: &[(&["nearest_vector: in c_is_low"], &["-1 for 0 (2)"])],
    },
    Unnoticed {
        because: "differs only where two three-phase vectors tie to the last bit and no pair vector is nearer",
        drives: &[FCS_HOVERBOARD],
        faults: &[(&["nearest_vector: in a_is_low"], &["-1 for 0"])],
    },
    Unnoticed {
        because: "differs only next to where V0 and a three-phase vector tie, and a pair vector is nearly always nearer there",
        drives: &[FCS_ESTUN],
        faults: &[(&["third_of_bus"], &["bit 4"])],
    },
    Unnoticed {
        because: "differs only where two phases are equal to the last bit",
        drives: &[FCS_TEKNIC],
        faults: &[(&["nearest_pair: in a_below_c"], &["-1 for 0"])],
    },
    Unnoticed {
        because: "moves a voltage by its last digit, which changes the choice next to a tie only",
        drives: &[FCS_TEKNIC],
        faults: &[(&["k_hold"], &["one less"])],
    },
    Unnoticed {
        because: "differs only where the spread is half the bus to the last bit",
        drives: &[FCS_TEKNIC],
        faults: &[(
            &["nearest_pair: in vector_pair"],
            &[
                "another comparison",
                "another comparison (2)",
                "another comparison (3)",
                "another comparison (4)",
                "another comparison (5)",
                "another comparison (6)",
            ],
        )],
    },
    Unnoticed {
        because: "differs only where a phase is at a third of the bus to the last bit",
        drives: &[FCS_TEKNIC],
        faults: &[(
            &["nearest_vector: in vector_three"],
            &[
                "another comparison",
                "another comparison (3)",
                "another comparison (4)",
                "another comparison (5)",
                "another comparison (6)",
            ],
        )],
    },
    Unnoticed {
        because: "differs only where a phase is at a third of the bus to the last bit",
        drives: &[FCS_ESTUN],
        faults: &[(
            &["nearest_vector: in vector_three"],
            &["another comparison (5)"],
        )],
    },
    Unnoticed {
        because: "differs only where the component is that of the corner to the last bit, and there by nothing",
        drives: &[PAPER],
        faults: &[
            (&["limit_torque_priority: in beyond_corner"], &["1 for 0"]),
            (
                &["limit_torque_priority: beyond_corner"],
                &["another comparison"],
            ),
        ],
    },
];

/// The places that a text names: entries of a table `table[first..end]`, or the one place.
fn entries(text: &str) -> Vec<String> {
    let range = text
        .strip_suffix(']')
        .and_then(|text| text.split_once('['))
        .and_then(|(table, range)| Some((table, range.split_once("..")?)));
    let Some((table, (first, end))) = range else {
        return vec![text.to_owned()];
    };
    let [first, end] = [first, end].map(|number| number.parse::<usize>().expect("a number"));
    (first..end).map(|n| format!("{table}[{n}]")).collect()
}

/// The listed faults of a drive, kind and motor, with the reasons; `wrong` gets those that are listed twice.
pub fn listed<'r>(
    rows: &'r [Unnoticed],
    drive: &str,
    wrong: &mut Vec<String>,
) -> BTreeMap<String, &'r str> {
    let mut listed = BTreeMap::new();
    for row in rows.iter().filter(|row| row.drives.contains(&drive)) {
        for (places, what) in row.faults() {
            for place in entries(places) {
                let fault = format!("{place}: {what}");
                if listed.insert(fault, row.because).is_some() {
                    wrong.push(format!("{drive}: {place}: {what}: listed twice"));
                }
            }
        }
    }
    listed
}
