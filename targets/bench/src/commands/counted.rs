//! The counted drives: the firmware's list, read without building the firmware.

use crate::listing::{motor, variant};

#[macro_use]
#[path = "../../../firmware/on_target/drives.rs"]
mod listed;

/// Stand-in for the crate that the list names: its macro lists drives instead of making them.
mod hexagen_firmware {
    macro_rules! drives {
        ($($name:ident, $symbol:ident: $motor:literal, $kind:ident { $($options:tt)* } $(, $call:ident)?;)*) => {
            /// Symbol, motor file, kind of controller and options of each, as in the list.
            const WRITTEN: &[[&str; 4]] = &[
                $([stringify!($symbol), $motor, stringify!($kind), stringify!($($options)*)],)*
            ];
        };
    }
    pub(super) use drives;
}

drives_for!(cortex_m4);

/// A counted drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counted {
    /// Symbol of the step function.
    pub symbol: &'static str,
    /// Name of the library's motor.
    pub motor: &'static str,
    /// Controller and options in the command line's notation.
    pub variant: String,
}

/// All counted drives, with word lengths for a Cortex-M4.
pub fn drives() -> Vec<Counted> {
    let counted = |&[symbol, file, kind, options]: &[&'static str; 4]| Counted {
        symbol,
        // An unknown file becomes an unknown motor.
        motor: motor(file).unwrap_or(file),
        variant: variant(kind, options),
    };
    WRITTEN.iter().map(counted).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_read_with_the_cores_word_lengths() {
        let drives = drives();
        let keep_angle = drives
            .iter()
            .find(|drive| drive.symbol == "step_trivedi_keshri_660w_pdcc_keep_angle")
            .expect("is counted");
        assert_eq!(keep_angle.motor, "trivedi-keshri-660w");
        assert_eq!(
            keep_angle.variant,
            "pdcc:reference=quasi_square,saturation=keep_angle,emf=held,target=cortex_m4"
        );
    }
}
