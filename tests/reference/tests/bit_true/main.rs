//! The bit-true model against the ideal one, and the bit-for-bit test itself.

mod models_agree;
mod variants;
mod verification;
