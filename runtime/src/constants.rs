//! Constructors for tables of constants.

use fixed::FixedI32;

/// Pairs of fixed-point numbers from their bits; the type gives the fraction bits.
///
/// ```
/// use hexagen::fixed::types::I8F24;
///
/// const VECTORS: [[I8F24; 2]; 1] = hexagen::pairs_from_bits([[1 << 24, -(1 << 23)]]);
/// assert_eq!(VECTORS, [[I8F24::ONE, I8F24::lit("-0.5")]]);
/// ```
#[must_use]
pub const fn pairs_from_bits<Frac, const N: usize>(
    bits: [[i32; 2]; N],
) -> [[FixedI32<Frac>; 2]; N] {
    let mut pairs = [[FixedI32::from_bits(0); 2]; N];
    let mut n = 0;
    while n < N {
        pairs[n] = [
            FixedI32::from_bits(bits[n][0]),
            FixedI32::from_bits(bits[n][1]),
        ];
        n += 1;
    }
    pairs
}
