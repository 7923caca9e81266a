//! The bit-true model against the ideal one, and the bit-for-bit test itself.

mod fcs_mpc;
mod models_agree;
mod phcc;
mod pi_pwm;
mod torn_reads;
mod variants;
mod verification;
