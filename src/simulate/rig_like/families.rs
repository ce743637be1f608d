//! Two independent sets of constants. Seeds, resting lengths, set points, shapes of the misfit and coefficients of the law all differ, so
//! that what was designed with one can be judged on the other.

use super::misfit::Shape;
use pipeline_base::random::Stream;

/// A set of constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// To design with.
    Design,
    /// For the table that is published; nobody looks at single campaigns of it.
    Published,
}

impl Family {
    /// Name, part of every stream of random numbers.
    pub fn name(self) -> &'static str {
        match self {
            Family::Design => "design",
            Family::Published => "published",
        }
    }

    /// A stream of random numbers that no other family, seed or purpose shares.
    pub fn stream(self, seed: u64, path: &[&str]) -> Stream {
        let path: Vec<&str> = ["rig-like", self.name()]
            .into_iter()
            .chain(path.iter().copied())
            .collect();
        Stream::new(seed, &path)
    }

    /// Of which functions the misfit is made.
    pub fn shape(self) -> Shape {
        match self {
            Family::Design => Shape::Bumps,
            Family::Published => Shape::Waves,
        }
    }

    /// Bounds of the resting lengths, mm, inside the domain of the force paper.
    pub fn rest_lengths_mm(self) -> (f64, f64) {
        match self {
            Family::Design => (112.0, 460.0),
            Family::Published => (118.0, 515.0),
        }
    }

    /// Bounds of the contraction at 620 kPa.
    pub fn contractions_620(self) -> (f64, f64) {
        match self {
            Family::Design => (0.157, 0.177),
            Family::Published => (0.153, 0.18),
        }
    }

    /// Set points on the way up of a staircase, kPa.
    pub fn set_points_kpa(self) -> &'static [f64] {
        match self {
            Family::Design => &[
                50.0, 90.0, 135.0, 185.0, 235.0, 290.0, 345.0, 400.0, 455.0, 510.0, 565.0, 620.0,
            ],
            Family::Published => &[
                55.0, 105.0, 160.0, 215.0, 265.0, 320.0, 370.0, 425.0, 475.0, 525.0, 570.0, 612.0,
            ],
        }
    }

    /// Standard deviation by which the coefficients of the law depart from the published ones, as a share.
    pub fn law_scatter(self) -> f64 {
        match self {
            Family::Design => 0.03,
            Family::Published => 0.04,
        }
    }
}
