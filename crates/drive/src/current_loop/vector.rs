//! Vectors of the current plane and their rotation.
//!
//! With two phases the coordinates are those of windings A and B; with three they come from Clarke's transformation that keeps
//! amplitudes: U lies along the first.

use core::f32::consts::TAU;

/// A current in ampere or a voltage in volt.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector {
    /// The part along winding A, or along the commanded direction in its frame.
    pub a: f32,
    /// The part along winding B, or a quarter of a period ahead of the commanded direction in its frame.
    pub b: f32,
}

impl Vector {
    /// The sum.
    pub fn plus(self, other: Self) -> Self {
        Self {
            a: self.a + other.a,
            b: self.b + other.b,
        }
    }

    /// The difference.
    pub fn minus(self, other: Self) -> Self {
        Self {
            a: self.a - other.a,
            b: self.b - other.b,
        }
    }

    /// The multiple.
    pub fn times(self, factor: f32) -> Self {
        Self {
            a: self.a * factor,
            b: self.b * factor,
        }
    }

    /// The scalar product.
    pub fn dot(self, other: Self) -> f32 {
        self.a * other.a + self.b * other.b
    }
}

/// A direction in the plane: cosine and sine of an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// The cosine.
    pub cosine: f32,
    /// The sine.
    pub sine: f32,
}

impl Direction {
    /// The direction of an angle in 2^-32 periods; cosine and sine are within 1e-7 of the truth.
    pub fn of(angle: u32) -> Self {
        let [direction] = Self::of_each([angle]);
        direction
    }

    /// The directions of several angles.
    #[inline]
    pub fn of_each<const COUNT: usize>(angles: [u32; COUNT]) -> [Self; COUNT] {
        let (cosines, sines) = cosines_and_sines(angles);
        core::array::from_fn(|number| Self {
            cosine: cosines[number],
            sine: sines[number],
        })
    }

    /// A vector of the frame that this direction leads, as it is in the plane.
    pub fn out_of_frame(self, vector: Vector) -> Vector {
        Vector {
            a: vector.a * self.cosine - vector.b * self.sine,
            b: vector.a * self.sine + vector.b * self.cosine,
        }
    }

    /// A vector of the plane as it is in the frame that this direction leads.
    pub fn into_frame(self, vector: Vector) -> Vector {
        Vector {
            a: vector.a * self.cosine + vector.b * self.sine,
            b: vector.b * self.cosine - vector.a * self.sine,
        }
    }
}

/// Cosines and sines of several angles.
///
/// Without a branch, with the results side by side and in a function of its own, the compiler makes vector instructions of it where there are
/// such: four angles then take as many instructions as one and a half otherwise.
#[inline(never)]
fn cosines_and_sines<const COUNT: usize>(angles: [u32; COUNT]) -> ([f32; COUNT], [f32; COUNT]) {
    // The nearest quarter and what is left of it, an eighth of a period to either side.
    let quarters = angles.map(|angle| angle.wrapping_add(1 << 29) >> 30);
    let rests: [f32; COUNT] = core::array::from_fn(|number| radians_of(angles[number].wrapping_sub(quarters[number] << 30) as i32));
    let (cosines, sines) = (rests.map(cosine), rests.map(sine));
    // Each quarter turns cosine into minus sine and sine into cosine; bit 31 is the sign.
    let exchange: [u32; COUNT] =
        core::array::from_fn(|number| (cosines[number].to_bits() ^ sines[number].to_bits()) & (quarters[number] & 1).wrapping_neg());
    let negative = |quarter: u32| (quarter & 2) << 30;
    (
        core::array::from_fn(|number| f32::from_bits(cosines[number].to_bits() ^ exchange[number] ^ negative(quarters[number] + 1))),
        core::array::from_fn(|number| f32::from_bits(sines[number].to_bits() ^ exchange[number] ^ negative(quarters[number]))),
    )
}

/// The angle of that many radians in 2^-32 periods, within half a period.
pub fn angle_of(radians: f32) -> u32 {
    (radians * (4_294_967_296.0 / TAU)) as i32 as u32
}

/// The radians of an angle in 2^-32 periods, within half a period to either side.
pub fn radians_of(angle: i32) -> f32 {
    angle as f32 * (TAU / 4_294_967_296.0)
}

/// Taylor's series; what it leaves out is below 4e-8 within an eighth of a period with the last term adjusted to that range.
fn sine(x: f32) -> f32 {
    let s = x * x;
    x + x * s * (-1.666_666_5e-1 + s * (8.332_16e-3 - s * 1.951_529_6e-4))
}

/// As [`sine`].
fn cosine(x: f32) -> f32 {
    let s = x * x;
    1.0 - 0.5 * s + s * s * (4.166_664_6e-2 + s * (-1.388_731_6e-3 + s * 2.443_315_7e-5))
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;

    #[test]
    fn cosine_and_sine_are_within_a_ten_millionth_all_the_way_round() {
        for step in 0..1_000_000u32 {
            let angle = step.wrapping_mul(4_294_967);
            let radians = f64::from(angle) / 4_294_967_296.0 * std::f64::consts::TAU;
            let direction = Direction::of(angle);
            assert!((f64::from(direction.cosine) - radians.cos()).abs() < 1.2e-7, "cosine at {angle}");
            assert!((f64::from(direction.sine) - radians.sin()).abs() < 1.2e-7, "sine at {angle}");
        }
    }

    #[test]
    fn out_of_a_frame_and_back_is_where_it_began() {
        let vector = Vector { a: 3.0, b: -1.25 };
        for angle in [0, 1 << 29, 0x5555_5555, 0x8000_0000, u32::MAX] {
            let direction = Direction::of(angle);
            let back = direction.into_frame(direction.out_of_frame(vector)).minus(vector);
            assert!(back.dot(back) < 1e-12, "{angle}: {back:?}");
        }
        // A quarter of a period ahead of winding A lies winding B.
        let turned = Direction::of(1 << 30).out_of_frame(Vector { a: 1.0, b: 0.0 });
        assert_eq!(turned, Vector { a: 0.0, b: 1.0 });
    }

    #[test]
    fn angles_and_radians_go_both_ways() {
        assert_eq!(angle_of(-TAU / 4.0), 0xC000_0000);
        assert_eq!(angle_of(0.0), 0);
        assert_eq!(radians_of(i32::MIN / 2), -TAU / 4.0);
    }
}
