//! Peers of the drives: each step function has its own symbol in the ELF.

use hexagen_firmware::hexagen::fixed::types::I16F16;
use hexagen_firmware::peers::{FcsMpc, FocLoop, IdspLoop, Pdcc, Phcc, PiPwm};

hexagen_firmware::peers! {
    step_f32_pdcc: Pdcc<f32>;
    step_f32_fcs_mpc: FcsMpc<f32>;
    step_f32_phcc: Phcc<f32>;
    step_f32_pi_pwm: PiPwm<f32>;
    step_i16f16_pdcc: Pdcc<I16F16>;
    step_i16f16_fcs_mpc: FcsMpc<I16F16>;
    step_i16f16_phcc: Phcc<I16F16>;
    step_i16f16_pi_pwm: PiPwm<I16F16>;
    step_foc: FocLoop;
    step_idsp: IdspLoop;
}
