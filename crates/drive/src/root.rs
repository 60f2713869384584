//! Square roots, which `core` lacks for floats.

/// The square root, within a millionth; 0 for what has none.
pub fn square_root(x: f32) -> f32 {
    if x <= 0.0 { 0.0 } else { newton::<3>(x) }
}

/// The square root of what is above 0, by Newton's steps from within 4 percent.
fn newton<const STEPS: u32>(x: f32) -> f32 {
    let mut root = f32::from_bits((x.to_bits() >> 1) + 0x1FC0_0000);
    for _ in 0..STEPS {
        root = 0.5 * (root + x / root);
    }
    root
}

/// The square root of a whole number, rounded down; below 2^32, it takes half the instructions of [`u64::isqrt`].
#[inline]
pub fn whole_root(x: u64) -> u32 {
    let Ok(x) = u32::try_from(x) else {
        return x.isqrt() as u32;
    };
    // A millionth of 65536 is far from the next number but one: rounded to the nearest, it is at most one too much.
    let root = (square_root(x as f32) + 0.5) as u32;
    if u64::from(root) * u64::from(root) > x.into() {
        root - 1
    } else {
        root
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_root_is_within_a_millionth() {
        for step in 1..60 {
            for scale in [1e-9_f32, 1.0, 1e9] {
                let x = step as f32 / 100.0 * scale;
                let root = f64::from(square_root(x));
                assert!((root * root / f64::from(x) - 1.0).abs() < 2e-6, "{x}");
            }
        }
    }

    #[test]
    fn the_whole_root_is_exact_around_squares_and_at_the_ends() {
        for square in (0..100_000).map(|root: u64| root * root) {
            for x in [square.saturating_sub(1), square, square + 1] {
                assert_eq!(u64::from(whole_root(x)), x.isqrt(), "{x}");
            }
        }
        assert_eq!(whole_root(u64::MAX), u32::MAX);
    }

    proptest! {
        #[test]
        fn the_whole_root_is_exact(x in 0u64.., bits in 0u32..64) {
            prop_assert_eq!(u64::from(whole_root(x >> bits)), (x >> bits).isqrt());
        }
    }
}
