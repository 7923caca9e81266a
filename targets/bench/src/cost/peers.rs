//! Inputs of the peers: closed loops on the host, of each naive controller with itself.

use super::count::Inputs;
use crate::BenchError;
use hexagen::fixed::types::I16F16;
use hexagen_firmware::peers::{FcsMpc, Pdcc, Peer, Phcc, PiPwm};
use hexagen_host::engine::Prepared;

/// The inputs of the peer with this symbol, on the plant of a drive.
///
/// # Errors
/// When there is no such peer.
pub fn inputs(drive: &Prepared, symbol: &str) -> Result<Inputs, BenchError> {
    match symbol {
        "step_f32_pdcc" => of::<Pdcc<f32>>(drive),
        "step_f32_fcs_mpc" => of::<FcsMpc<f32>>(drive),
        "step_f32_phcc" => of::<Phcc<f32>>(drive),
        "step_i16f16_pdcc" => of::<Pdcc<I16F16>>(drive),
        "step_i16f16_fcs_mpc" => of::<FcsMpc<I16F16>>(drive),
        "step_i16f16_phcc" => of::<Phcc<I16F16>>(drive),
        "step_i16f16_pi_pwm" => of::<PiPwm<I16F16>>(drive),
        // `foc` and `idsp` are rotor-oriented, without an angle between the edges: they read what another PI meets.
        "step_f32_pi_pwm" | "step_foc" | "step_idsp" => of::<PiPwm<f32>>(drive),
        _ => Err(BenchError::Failed(format!(
            "`{symbol}` is no peer of the host"
        ))),
    }
}

fn of<P: Peer>(drive: &Prepared) -> Result<Inputs, BenchError> {
    let mut peer = P::new();
    Inputs::record_peer(drive, |sample| peer.step(sample))
}
