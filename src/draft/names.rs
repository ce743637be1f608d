//! What the name of a column says: `Force (lbf)`, `pressure_kpa`, `t [ms]`.

use super::Guess;
use pipeline_base::columns::{self, KnownColumn};
use pipeline_base::session::Position;
use pipeline_base::units::{Quantity, UNITS, Unit};
use pipeline_formats::overview::Undescribed;

/// Words in the names of columns and the quantity that they mean, in English and German; the letters that papers use come last.
const WORDS: &[(&str, &[&str])] = &[
    ("time", &["time", "timestamp", "zeit", "clock", "t"]),
    ("torque", &["torque", "moment", "drehmoment"]),
    ("pressure", &["pressure", "druck", "press", "p"]),
    ("force", &["force", "kraft", "load", "f"]),
    ("angle", &["angle", "winkel", "flexion", "theta", "phi"]),
    ("temperature", &["temperature", "temperatur", "temp"]),
    ("phase", &["phase", "state", "direction", "valve"]),
    (
        "length",
        &["length", "laenge", "länge", "displacement", "l"],
    ),
];

/// The guess that a column's name allows.
pub fn guess(column: &Undescribed) -> Guess {
    let mut guess = Guess::unknown(column);
    let Position::Name(name) = &column.position else {
        return guess;
    };
    if let Some(exact) = columns::KNOWN.iter().find(|k| k.column == name) {
        guess.quantity = Some(exact);
        guess.unit = unit(name, exact.quantity);
    } else {
        guess.quantity = quantity(name);
        guess.unit = unit(name, guess.quantity.and_then(|q| q.quantity));
    }
    guess.why = match (guess.quantity, guess.unit) {
        (Some(_), Some(_)) => "by its name and unit".to_owned(),
        (Some(_), None) => "by its name".to_owned(),
        (None, _) => "a column of your own, carried through every stage".to_owned(),
    };
    guess
}

/// The parts of a name: what stands between brackets, underscores and blanks.
fn parts(name: &str) -> Vec<&str> {
    name.split(|c: char| !c.is_alphanumeric() && c != '.' && c != '°')
        .map(|part| part.trim_matches(['.', '°']))
        .filter(|part| !part.is_empty())
        .collect()
}

fn quantity(name: &str) -> Option<&'static KnownColumn> {
    if let Some(known) = columns::by_quantity_name(name) {
        return Some(known);
    }
    let parts: Vec<String> = parts(name).iter().map(|p| p.to_lowercase()).collect();
    // `moment_arm` before `moment`.
    let of_two_words = |k: &&KnownColumn| {
        k.quantity_name.contains('_') && parts.join("_").contains(k.quantity_name)
    };
    if let Some(known) = columns::KNOWN.iter().find(of_two_words) {
        return Some(known);
    }
    let says = |words: &[&str]| parts.iter().any(|p| words.contains(&p.as_str()));
    let (quantity, _) = WORDS.iter().find(|(_, words)| says(words))?;
    columns::by_quantity_name(quantity)
}

/// The unit in a name, of the quantity where that is known: as it is written, or else its case ignored. It never comes first.
fn unit(name: &str, quantity: Option<Quantity>) -> Option<Unit> {
    let parts = parts(name);
    let candidates = || UNITS.iter().filter(|u| Some(u.quantity) == quantity);
    let written = |u: &&Unit, part: &str| u.symbol == part || u.symbol.replace('.', "") == part;
    let of_part = |part: &&str| {
        let exact = candidates().find(|u| written(u, part));
        exact.or_else(|| {
            candidates().find(|u| {
                u.symbol
                    .replace('.', "")
                    .eq_ignore_ascii_case(&part.replace('.', ""))
            })
        })
    };
    parts.iter().skip(1).rev().find_map(of_part).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_quantity_and_unit() {
        let cases = [
            ("Force (lbf)", "force", "lbf"),
            ("pressure_kpa", "pressure", "kPa"),
            ("t [ms]", "time", "ms"),
            ("Druck/bar", "pressure", "bar"),
            ("torque N.m", "torque", "N.m"),
            ("torque_nm", "torque", "N.m"),
            ("Temp [°C]", "temperature", "C"),
            ("length_mm", "length", "mm"),
            ("Moment arm (cm)", "moment_arm", "cm"),
            ("muscle_length_mm", "muscle_length", "mm"),
        ];
        for (name, expected, symbol) in cases {
            let found = quantity(name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(found.quantity_name, expected, "{name}");
            let unit = unit(name, found.quantity).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(unit.symbol, symbol, "{name}");
        }
        assert!(quantity("humidity").is_none());
        assert!(unit("force", Some(Quantity::Force)).is_none());
    }
}
