//! The drives of this firmware. Every step function has its own symbol in the ELF.

/// The drives, those of the goals with the word length of this core.
macro_rules! drives_for {
    ($target:ident) => {
        hexagen_firmware::drives! {
            TrivediPdcc, step_trivedi_keshri_660w_pdcc:
                "../motors/trivedi-keshri-660w.toml", pdcc { target: $target };
            TrivediPdccQuasiSquare, step_trivedi_keshri_660w_pdcc_quasi_square:
                "../motors/trivedi-keshri-660w.toml", pdcc { reference: quasi_square, target: $target };
            TrivediFcsMpc, step_trivedi_keshri_660w_fcs_mpc:
                "../motors/trivedi-keshri-660w.toml", fcs_mpc {};
            TrivediPhcc, step_trivedi_keshri_660w_phcc:
                "../motors/trivedi-keshri-660w.toml", phcc {};
            TrivediPiPwm, step_trivedi_keshri_660w_pi_pwm:
                "../motors/trivedi-keshri-660w.toml", pi_pwm {};

            TeknicPdcc, step_teknic_m2310p_pdcc: "../motors/teknic-m2310p.toml", pdcc {};
            TeknicFcsMpc, step_teknic_m2310p_fcs_mpc: "../motors/teknic-m2310p.toml", fcs_mpc {};
            TeknicPhcc, step_teknic_m2310p_phcc: "../motors/teknic-m2310p.toml", phcc {};
            TeknicPiPwm, step_teknic_m2310p_pi_pwm: "../motors/teknic-m2310p.toml", pi_pwm {};

            // An encoder in place of Hall sensors.
            CheetahPdcc, step_mit_mini_cheetah_pdcc: "../motors/mit-mini-cheetah.toml", pdcc {};
            CheetahPdccFieldWeakening, step_mit_mini_cheetah_pdcc_field_weakening:
                "../motors/mit-mini-cheetah.toml", pdcc { field_weakening: on };
            CheetahPdccRounding, step_mit_mini_cheetah_pdcc_rounding:
                "../motors/mit-mini-cheetah.toml", pdcc { rounding_prediction: on };
            CheetahPdccResidual, step_mit_mini_cheetah_pdcc_residual:
                "../motors/mit-mini-cheetah.toml", pdcc { residual_timeout: 5 ms };

            HurstPdccSpeed, step_hurst_long_pdcc_speed: "../motors/hurst-long.toml", pdcc { speed_loop: on };

            // Currents in the low legs, and sensors whose places are learnt.
            HubPdcc, step_hoverboard_hub_pdcc: "../motors/hoverboard-hub.toml", pdcc {};
            HubPdccHallLearning, step_hoverboard_hub_pdcc_hall_learning:
                "../motors/hoverboard-hub.toml", pdcc { hall_learning: on };
            HubPdccDeadTime, step_hoverboard_hub_pdcc_dead_time:
                "../motors/hoverboard-hub.toml", pdcc { dead_time_compensation: on };

            // The paper's modulator, whose command has three intervals.
            TrivediPdccTable2, step_trivedi_keshri_660w_pdcc_table2:
                "../motors/trivedi-keshri-660w.toml",
                pdcc {
                    reference: quasi_square, saturation: keep_angle, emf: held, modulation: table2,
                    target: $target
                };
            TrivediPiPwmTable2, step_trivedi_keshri_660w_pi_pwm_table2:
                "../motors/trivedi-keshri-660w.toml",
                pi_pwm {
                    reference: quasi_square, saturation: keep_angle, feed_forward: off,
                    modulation: table2, target: $target
                };

            // The variants of the cost table's goals, each with the core's word length.
            TrivediPdccKeepAngle, step_trivedi_keshri_660w_pdcc_keep_angle:
                "../motors/trivedi-keshri-660w.toml",
                pdcc { reference: quasi_square, saturation: keep_angle, emf: held, target: $target };
            TrivediFcsMpcThreePhase, step_trivedi_keshri_660w_fcs_mpc_three_phase:
                "../motors/trivedi-keshri-660w.toml",
                fcs_mpc { candidates: three_phase, emf: held, target: $target };
            TrivediFcsMpcTable2, step_trivedi_keshri_660w_fcs_mpc_table2:
                "../motors/trivedi-keshri-660w.toml",
                fcs_mpc { candidates: table2, off_leg: nominal, emf: held, target: $target };
            TrivediFcsMpcPhysical, step_trivedi_keshri_660w_fcs_mpc_physical:
                "../motors/trivedi-keshri-660w.toml", fcs_mpc { emf_filter: 1, target: $target };
            TrivediPhccThreePhase, step_trivedi_keshri_660w_phcc_three_phase:
                "../motors/trivedi-keshri-660w.toml", phcc { candidates: three_phase, emf: held, target: $target };
            TrivediPiPwmKeepAngle, step_trivedi_keshri_660w_pi_pwm_keep_angle:
                "../motors/trivedi-keshri-660w.toml",
                pi_pwm {
                    reference: quasi_square, saturation: keep_angle, feed_forward: off, target: $target
                };
        }
    };
}
