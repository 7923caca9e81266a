//! The drives of the paper's experiment and those that go beyond it, as in `hexagen reproduce`, counted for its Table 5.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use drives::DRIVES;
// The vector table.
use hexagen_cortex_m4 as _;
use hexagen_firmware::semihosted::run;

/// Each controller as printed in the paper, corrected, and improved.
mod drives {
    #![expect(deprecated, reason = "the printed switching table draws a warning")]

    hexagen_firmware::drives! {
        FcsMpcLiteral, step_trivedi_keshri_660w_fcs_mpc_literal:
            "../motors/trivedi-keshri-660w.toml",
            fcs_mpc {
                off_leg: nominal, emf: held, delay: 0, discretisation: euler,
                hall_capture: timer
            };
        FcsMpcCorrected, step_trivedi_keshri_660w_fcs_mpc_corrected:
            "../motors/trivedi-keshri-660w.toml",
            fcs_mpc { off_leg: physical, emf: model, discretisation: euler, hall_capture: timer };
        PdccLiteral, step_trivedi_keshri_660w_pdcc_literal:
            "../motors/trivedi-keshri-660w.toml",
            pdcc {
                reference: quasi_square, saturation: keep_angle, modulation: table2, emf: held,
                discretisation: euler, hall_capture: timer
            };
        PdccCorrected, step_trivedi_keshri_660w_pdcc_corrected:
            "../motors/trivedi-keshri-660w.toml",
            pdcc {
                reference: quasi_square, saturation: nearest, emf: model, discretisation: euler,
                hall_capture: timer
            };
        PdccImproved, step_trivedi_keshri_660w_pdcc_improved:
            "../motors/trivedi-keshri-660w.toml",
            pdcc {
                reference: quasi_square, saturation: torque_priority, advance: 2, emf: model,
                discretisation: euler, hall_capture: timer
            };
        PhccLiteral, step_trivedi_keshri_660w_phcc_literal:
            "../motors/trivedi-keshri-660w.toml",
            phcc {
                table: printed, off_leg: nominal, emf: held, discretisation: euler,
                hall_capture: timer
            };
        PhccCorrected, step_trivedi_keshri_660w_phcc_corrected:
            "../motors/trivedi-keshri-660w.toml",
            phcc { table: derived, emf: model, discretisation: euler, hall_capture: timer };
        PiPwmLiteral, step_trivedi_keshri_660w_pi_pwm_literal:
            "../motors/trivedi-keshri-660w.toml",
            pi_pwm {
                reference: quasi_square, saturation: keep_angle, modulation: table2,
                feed_forward: off, bandwidth: 800 Hz, integral_time: 0.5 ms,
                discretisation: euler, hall_capture: timer
            };
        PiPwmCorrected, step_trivedi_keshri_660w_pi_pwm_corrected:
            "../motors/trivedi-keshri-660w.toml",
            pi_pwm {
                reference: quasi_square, saturation: nearest, feed_forward: off, bandwidth: 800 Hz,
                integral_time: 0.5 ms, discretisation: euler, hall_capture: timer
            };
        PiPwmImproved, step_trivedi_keshri_660w_pi_pwm_improved:
            "../motors/trivedi-keshri-660w.toml",
            pi_pwm {
                reference: quasi_square, saturation: nearest, feed_forward: on, bandwidth: 1 kHz,
                emf: model, discretisation: euler, hall_capture: timer
            };
    }
}

#[entry]
fn main() -> ! {
    run(DRIVES)
}
