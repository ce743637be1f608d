//! One look for each model in all figures: name, colour, dash and mark, so that none is told by its colour alone.

use crate::plot::{Dash, Ink, Mark, Shape, Stroke, look};
use crate::wording::name::model_name;
use pipeline_compare::NEW;

/// How a model is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Short name.
    pub name: String,
    /// Line.
    pub stroke: Stroke,
    /// Mark.
    pub mark: Mark,
}

const LOOKS: [(&str, Ink, Dash, Shape); 9] = [
    (NEW, Ink::Black, Dash::Solid, Shape::Circle),
    ("new_published", Ink::Blue, Dash::Dashed, Shape::Square),
    ("knee_paper", Ink::Sky, Dash::DashDotDot, Shape::Diamond),
    ("hunt2017", Ink::Green, Dash::DashDot, Shape::Triangle),
    ("festo_tool", Ink::Vermilion, Dash::Long, Shape::Wedge),
    ("sarosi2012", Ink::Purple, Dash::Short, Shape::Plus),
    ("martens2017", Ink::Orange, Dash::LongDot, Shape::Cross),
    ("chou_hannaford", Ink::Grey, Dash::LongShort, Shape::Circle),
    ("tondu_lopez", Ink::Grey, Dash::Dotted, Shape::Square),
];

/// The look of a model; one that is not in the list gets a look by its place.
pub fn of_model(id: &str, title: &str, place: usize) -> Look {
    let listed = LOOKS.iter().find(|l| l.0 == id);
    let (ink, dash, shape) = match listed {
        Some((_, ink, dash, shape)) => (*ink, *dash, *shape),
        None => {
            let (ink, shape, dash) = look(place);
            (ink, dash, shape)
        }
    };
    Look {
        name: model_name(id, title).to_owned(),
        stroke: Stroke::new(ink, dash),
        // Listed models but the new one are open: one that is not listed differs from all with its dash.
        mark: if id == NEW || listed.is_none() {
            Mark::filled(shape, ink)
        } else {
            Mark::open(shape, ink)
        },
    }
}

/// Colour, mark and dash of an isobar: the same for a pressure in every figure.
pub fn of_isobar(pressure_kpa: f64) -> (Ink, Shape, Dash) {
    look(((pressure_kpa / 100.0).round() as usize).saturating_sub(1))
}

/// So many specimens have a mark of their own; beyond, marks repeat.
pub const MOST_SPECIMENS: usize = 12;

/// The mark of the n-th of many specimens: open in the first seven looks, then filled.
pub fn of_specimen(n: usize, width_mm: f64) -> Mark {
    const OPEN: usize = 7;
    let (ink, shape, _) = look(n);
    let line_shape = matches!(shape, Shape::Plus | Shape::Cross);
    let mark = if (n / OPEN).is_multiple_of(2) || line_shape {
        Mark::open(shape, ink)
    } else {
        Mark::filled(shape, ink)
    };
    mark.wide(width_mm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pipeline_mechanics::models::published;
    use std::collections::BTreeSet;

    #[test]
    fn every_model_has_its_own_dash_and_mark_whatever_the_colour() {
        let ids = published().into_iter().map(|m| (m.id(), m.title()));
        let all = ids.chain([(NEW, "")]).enumerate();
        let all = all.filter(|(_, (id, _))| LOOKS.iter().any(|l| l.0 == *id));
        let looks: Vec<Look> = all.map(|(k, (id, title))| of_model(id, title, k)).collect();
        assert_eq!(looks.len(), LOOKS.len(), "every line is of a model");
        for (i, a) in looks.iter().enumerate() {
            for b in &looks[i + 1..] {
                assert_ne!(a.stroke.dash, b.stroke.dash, "{} and {}", a.name, b.name);
                assert_ne!(a.mark, b.mark);
                assert_ne!(a.name, b.name);
            }
        }
    }

    #[test]
    fn the_marks_of_specimens_differ_as_far_as_they_are_said_to() {
        let marks: BTreeSet<Mark> = (0..MOST_SPECIMENS).map(|k| of_specimen(k, 1.0)).collect();
        assert_eq!(marks.len(), MOST_SPECIMENS);
        assert!(marks.contains(&of_specimen(MOST_SPECIMENS, 1.0)));
    }

    #[test]
    fn a_model_that_is_new_here_is_drawn_all_the_same() {
        let next = of_model("next", "Next 2030 (implicit)", LOOKS.len());
        assert_eq!(next.name, "Next 2030 (implicit)");
        let drawn = |l: &Look| (l.stroke.dash, l.mark.shape, l.mark.filled);
        for (id, ..) in LOOKS {
            assert_ne!(drawn(&next), drawn(&of_model(id, "", 0)), "{id}");
        }
    }
}
