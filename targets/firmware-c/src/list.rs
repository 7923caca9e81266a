//! The drives that are emitted as C.

/// A drive in C.
pub struct InC {
    /// Its type's name.
    pub name: &'static str,
    /// Symbol of its step function.
    pub symbol: &'static str,
    /// Motor of the library.
    pub motor: &'static str,
    /// Kind of controller.
    pub kind: &'static str,
    /// Options in the notation of a macro call.
    pub options: &'static str,
}

/// Those of the goals, and the four controllers with their defaults on another motor.
pub const DRIVES: &[InC] = &[
    InC {
        name: "TrivediPdccKeepAngle",
        symbol: "step_trivedi_keshri_660w_pdcc_keep_angle_c",
        motor: "trivedi-keshri-660w",
        kind: "pdcc",
        options: "reference: quasi_square, saturation: keep_angle, emf: held",
    },
    InC {
        name: "TrivediFcsMpcThreePhase",
        symbol: "step_trivedi_keshri_660w_fcs_mpc_three_phase_c",
        motor: "trivedi-keshri-660w",
        kind: "fcs_mpc",
        options: "candidates: three_phase, emf: held",
    },
    InC {
        name: "TrivediPhccThreePhase",
        symbol: "step_trivedi_keshri_660w_phcc_three_phase_c",
        motor: "trivedi-keshri-660w",
        kind: "phcc",
        options: "candidates: three_phase, emf: held",
    },
    InC {
        name: "TrivediPiPwmKeepAngle",
        symbol: "step_trivedi_keshri_660w_pi_pwm_keep_angle_c",
        motor: "trivedi-keshri-660w",
        kind: "pi_pwm",
        options: "reference: quasi_square, saturation: keep_angle, feed_forward: off",
    },
    InC {
        name: "TeknicPdcc",
        symbol: "step_teknic_m2310p_pdcc_c",
        motor: "teknic-m2310p",
        kind: "pdcc",
        options: "",
    },
    InC {
        name: "TeknicFcsMpc",
        symbol: "step_teknic_m2310p_fcs_mpc_c",
        motor: "teknic-m2310p",
        kind: "fcs_mpc",
        options: "",
    },
    InC {
        name: "TeknicPhcc",
        symbol: "step_teknic_m2310p_phcc_c",
        motor: "teknic-m2310p",
        kind: "phcc",
        options: "",
    },
    InC {
        name: "TeknicPiPwm",
        symbol: "step_teknic_m2310p_pi_pwm_c",
        motor: "teknic-m2310p",
        kind: "pi_pwm",
        options: "",
    },
];
