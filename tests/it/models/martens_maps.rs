//! A baseline is compared only after it reproduces its own published data: Martens and Boblan's maps.

use super::force;
use pipeline::models::martens2017::{GEOMETRIES, PUBLISHED_10, PUBLISHED_20, largest_miss};
use pipeline::models::{Direction, State, values};

const MAP_10: &str = include_str!(concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/src/mechanics/models/data/martens_a2_dmsp10_250.csv"
));
const MAP_20: &str = include_str!(concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/src/mechanics/models/data/martens_a1_dmsp20_300.csv"
));

fn map(diameter_mm: u32) -> Vec<[f64; 3]> {
    let text = if diameter_mm == 10 { MAP_10 } else { MAP_20 };
    let row = |line: &str| {
        let mut numbers = line.split(',').map(|x| x.parse().unwrap());
        std::array::from_fn(|_| numbers.next().unwrap())
    };
    text.lines().skip(1).map(row).collect()
}

fn modulus(diameter_mm: u32) -> [f64; 4] {
    let list = if diameter_mm == 10 {
        &PUBLISHED_10
    } else {
        &PUBLISHED_20
    };
    let [c0, c1, c2, c3, ..] = values(list);
    [c0, c1, c2, c3]
}

#[test]
fn every_reading_of_the_geometry_misses_the_map_by_the_stated_number() {
    assert_eq!((map(10).len(), map(20).len()), (85, 126));
    for g in GEOMETRIES {
        let miss = largest_miss(modulus(g.diameter_mm), g.geometry, &map(g.diameter_mm));
        assert!(
            (miss - g.miss).abs() < 6e-5,
            "{} mm, {}: {miss}",
            g.diameter_mm,
            g.reading
        );
    }
}

#[test]
fn delta_in_radians_reproduces_the_claimed_accuracy_with_nominal_sizes() {
    let reading = |d: u32| {
        let mut found = GEOMETRIES.iter().filter(|g| g.diameter_mm == d);
        found
            .find(|g| g.reading.starts_with("delta in radians, nominal"))
            .unwrap()
            .geometry
    };
    // Claimed 2.35% (20 mm) and 4.4% (10 mm); at 10 mm without the threshold at 50 kPa, where the measured force is zero.
    assert!((largest_miss(modulus(20), reading(20), &map(20)) - 0.0237).abs() < 1e-4);
    let above: Vec<[f64; 3]> = map(10).into_iter().filter(|row| row[1] > 50.0).collect();
    assert!((largest_miss(modulus(10), reading(10), &above) - 0.0426).abs() < 1e-4);
}

#[test]
fn the_listed_model_reproduces_both_maps_within_four_percent() {
    for (diameter, rest, expected) in [(10, 0.25, 0.0145), (20, 0.30, 0.0207)] {
        let map = map(diameter);
        let largest = map.iter().fold(0.0, |m: f64, row| m.max(row[2]));
        let miss = map
            .iter()
            .fold(0.0, |m: f64, &[length_m, pressure_kpa, measured]| {
                let state = State {
                    diameter_mm: f64::from(diameter),
                    rest_length_m: rest,
                    contracted_length_m: f64::NAN,
                    length_m,
                    pressure_kpa,
                    direction: Direction::Isometric,
                };
                m.max((force("martens2017", &state) - measured).abs() / largest)
            });
        assert!(
            miss < 0.04 && (miss - expected).abs() < 1e-4,
            "{diameter} mm: {miss}"
        );
    }
}
