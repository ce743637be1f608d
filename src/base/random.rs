//! Random numbers that depend on what they are for and on nothing else.
//!
//! A [`Stream`] is ChaCha8 keyed by a seed and a path of names, such as `["log", session id, run]`. No stream sees how often another
//! was drawn from, or whether another exists: a specimen or a run that is added to a truth file leaves the bytes of all other simulated
//! sessions as they were, and a session that is added to a campaign leaves every other session's split of rows as it was.
//!
//! Derivation of the 256-bit key: FNV-1a (64 bits; offset basis 0xcbf29ce484222325, prime 0x100000001b3) over the seed's eight
//! little-endian bytes and then each name followed by the byte 0x1f; the hash starts a SplitMix64 generator, whose first four
//! outputs, little-endian, are the key.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

/// A sequence of random numbers.
pub struct Stream {
    generator: ChaCha8Rng,
    spare: Option<f64>,
}

impl Stream {
    /// The stream of `seed` for the purpose that `path` names.
    pub fn new(seed: u64, path: &[&str]) -> Self {
        let mut state = fnv1a(seed, path);
        let mut key = [0_u8; 32];
        for word in key.chunks_exact_mut(8) {
            word.copy_from_slice(&split_mix(&mut state).to_le_bytes());
        }
        Self {
            generator: ChaCha8Rng::from_seed(key),
            spare: None,
        }
    }

    /// Uniform on the open interval (0, 1): the upper 53 bits, at the middle of their cell (the last cell's middle rounds down).
    pub fn uniform(&mut self) -> f64 {
        let cell = (self.generator.next_u64() >> 11) as f64;
        ((cell + 0.5) * (1.0 / (1_u64 << 53) as f64)).min(1.0 - f64::EPSILON / 2.0)
    }

    /// Uniform on 0, 1, …, `n` - 1; 0 of none. The bias is below n/2^53.
    pub fn below(&mut self, n: usize) -> usize {
        ((self.uniform() * n as f64) as usize).min(n.saturating_sub(1))
    }

    /// Standard normal (G. E. P. Box and M. E. Muller, Ann. Math. Stat. 29 (1958) 610); both deviates of a pair are used.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * libm::log(self.uniform())).sqrt();
        let angle = TAU * self.uniform();
        self.spare = Some(radius * libm::sin(angle));
        radius * libm::cos(angle)
    }
}

fn fnv1a(seed: u64, path: &[&str]) -> u64 {
    let names = path.iter().flat_map(|name| name.bytes().chain([0x1f]));
    seed.to_le_bytes()
        .into_iter()
        .chain(names)
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
}

/// SplitMix64 (G. L. Steele, D. Lea and C. H. Flood, OOPSLA 2014).
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_depends_on_every_part_of_its_path_and_on_the_seed() {
        let first = |seed, path: &[&str]| Stream::new(seed, path).uniform();
        let x = first(1, &["log", "a", "8"]);
        assert_eq!(x, first(1, &["log", "a", "8"]));
        assert_ne!(x, first(2, &["log", "a", "8"]));
        assert_ne!(x, first(1, &["log", "a", "9"]));
        assert_ne!(x, first(1, &["log", "a8"]));
        assert_ne!(x, first(1, &["loga", "8"]));
    }

    #[test]
    fn the_derivation_does_not_change_from_version_to_version() {
        let mut state = 0;
        assert_eq!(split_mix(&mut state), 0xe220_a839_7b1d_cdaf);
        let mut stream = Stream::new(42, &["log", "sim10-l182-c25", "8"]);
        let drawn = [stream.uniform(), stream.normal()].map(f64::to_bits);
        // Recomputed outside of this program, from the ChaCha8 of RFC 8439 with four double rounds.
        assert_eq!(
            drawn,
            [4_604_518_482_878_480_618, 4_609_151_751_703_806_426]
        );
    }

    #[test]
    fn normal_deviates_have_the_moments_of_the_standard_normal() {
        let mut stream = Stream::new(7, &["moments"]);
        let n = 40_000;
        let x: Vec<f64> = (0..n).map(|_| stream.normal()).collect();
        let moment = |p: i32| {
            x.iter()
                .map(|v| (0..p).fold(1.0, |a, _| a * v))
                .sum::<f64>()
                / f64::from(n)
        };
        assert!(moment(1).abs() < 0.02, "{}", moment(1));
        assert!((moment(2) - 1.0).abs() < 0.03, "{}", moment(2));
        assert!((moment(4) - 3.0).abs() < 0.2, "{}", moment(4));
    }
}
