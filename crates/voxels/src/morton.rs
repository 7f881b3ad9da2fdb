//! Morton codes.

/// How many bits each coordinate may have.
pub(crate) const BITS: u32 = 21;

/// Puts two zeros after each of the lowest 21 bits.
fn spread(value: u32) -> u64 {
    let mut bits = u64::from(value) & 0x1f_ffff;
    for (shift, mask) in [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        bits = (bits | bits << shift) & mask;
    }
    bits
}

fn gather(code: u64) -> u32 {
    let mut bits = code & 0x1249_2492_4924_9249;
    for (shift, mask) in [
        (2, 0x10c3_0c30_c30c_30c3),
        (4, 0x100f_00f0_0f00_f00f),
        (8, 0x001f_0000_ff00_00ff),
        (16, 0x001f_0000_0000_ffff),
        (32, 0x1f_ffff),
    ] {
        bits = (bits | bits >> shift) & mask;
    }
    bits as u32
}

/// The bits of three coordinates in turn (Morton 1966), of the first the lowest. Coordinates are below 2^21.
pub(crate) fn encode([x, y, z]: [u32; 3]) -> u64 {
    spread(x) | spread(y) << 1 | spread(z) << 2
}

/// The coordinates of a code.
pub(crate) fn decode(code: u64) -> [u32; 3] {
    [0, 1, 2].map(|axis| gather(code >> axis))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_bits_in_turn() {
        let mut state = 9u64;
        for _ in 0..2000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let place = [0, 21, 42].map(|shift| (state >> shift) as u32 & 0x1f_ffff);
            let code = encode(place);
            for bit in 0..63 {
                assert_eq!(code >> bit & 1, u64::from(place[bit % 3]) >> (bit / 3) & 1);
            }
            assert_eq!(decode(code), place);
        }
    }
}
