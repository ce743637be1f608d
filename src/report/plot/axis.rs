//! Axes: labels, ranges that leave the data room, and ticks at round numbers.

/// Which values an axis covers.
#[derive(Clone, Debug, PartialEq)]
pub enum Span {
    /// All of the data and these values, with a margin.
    Around(Vec<f64>),
    /// Exactly from here to there.
    Fixed(f64, f64),
}

/// Where ticks stand.
#[derive(Clone, Debug, PartialEq)]
pub enum Ticks {
    /// At round numbers.
    Round,
    /// At these places, with these labels in markup: for categories.
    Named(Vec<(f64, String)>),
}

/// An axis of a panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit in markup, `F_{620} (N)`; empty for none.
    pub label: String,
    /// Values covered.
    pub span: Span,
    /// Ticks.
    pub ticks: Ticks,
    /// Whether ticks carry their values: off for all but the lowest of stacked panels.
    pub numbered: bool,
}

impl Axis {
    /// An axis around its data.
    pub fn new(label: &str) -> Axis {
        Axis {
            label: label.into(),
            span: Span::Around(Vec::new()),
            ticks: Ticks::Round,
            numbered: true,
        }
    }

    /// From `low` to `high` exactly; what lies beyond is cut off.
    pub fn fixed(mut self, low: f64, high: f64) -> Axis {
        self.span = Span::Fixed(low, high);
        self
    }

    /// Around the data and `value`.
    pub fn including(mut self, value: f64) -> Axis {
        match &mut self.span {
            Span::Around(values) => values.push(value),
            Span::Fixed(low, high) => (*low, *high) = (low.min(value), high.max(value)),
        }
        self
    }

    /// Categories at 0, 1, 2 and so on, with half a step of margin at both ends.
    pub fn categories(label: &str, names: &[&str]) -> Axis {
        let place = |(i, name): (usize, &&str)| (i as f64, name.to_string());
        Axis {
            span: Span::Fixed(-0.5, names.len() as f64 - 0.5),
            ticks: Ticks::Named(names.iter().enumerate().map(place).collect()),
            ..Axis::new(label)
        }
    }

    /// Without label and numbers, for a panel that shares the axis of the one below.
    pub fn bare(mut self) -> Axis {
        self.label = String::new();
        self.numbered = false;
        self
    }

    /// The range for data between `low` and `high`, with about `count` steps.
    pub fn range(&self, data: Option<(f64, f64)>, count: usize) -> (f64, f64) {
        match &self.span {
            Span::Fixed(low, high) if low < high => (*low, *high),
            Span::Fixed(value, _) => widened(*value, *value, count),
            Span::Around(values) => {
                let all = data.into_iter().chain(values.iter().map(|v| (*v, *v)));
                let (low, high) = all
                    .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
                    .unwrap_or((0.0, 1.0));
                widened(low, high, count)
            }
        }
    }

    /// Ticks within the range: places and labels.
    pub fn ticks(&self, (low, high): (f64, f64), count: usize) -> Vec<(f64, String)> {
        match &self.ticks {
            Ticks::Named(ticks) => ticks
                .iter()
                .filter(|(at, _)| (low..=high).contains(at))
                .cloned()
                .collect(),
            Ticks::Round => round_ticks(low, high, count),
        }
    }
}

/// A margin of 4 %; no margin at zero where the data begin or end there; up to the next tick where that is near.
fn widened(low: f64, high: f64, count: usize) -> (f64, f64) {
    if low == high {
        let half = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
        return (low - half, high + half);
    }
    let margin = 0.04 * (high - low);
    let step = step(high - low, count);
    let down = to_tick(low, margin, step, -1.0);
    let up = to_tick(high, margin, step, 1.0);
    (down, up)
}

/// The end of an axis beyond `value` in the direction of `sign`.
fn to_tick(value: f64, margin: f64, step: f64, sign: f64) -> f64 {
    let inside_zero = value * sign <= 0.0;
    let padded = value + sign * margin;
    if inside_zero && padded * sign >= 0.0 {
        return 0.0;
    }
    let next = (value * sign / step - 1e-9).ceil() * step * sign;
    if (next - padded) * sign < 0.25 * step && (next - value) * sign >= 0.4 * margin {
        next
    } else {
        padded
    }
}

/// The round step (1, 2, 2.5 or 5 times a power of ten) with at most `count` steps in `span`.
fn step(span: f64, count: usize) -> f64 {
    let raw = span / count.max(1) as f64;
    let decade = libm::pow(10.0, libm::log10(raw).floor());
    [1.0, 2.0, 2.5, 5.0]
        .map(|m| m * decade)
        .into_iter()
        .find(|s| *s >= raw * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// At most `count` steps, but two ticks at least: one says nothing of the size.
fn round_ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let places = |count: usize| {
        let step = step(high - low, count);
        let first = (low / step - 1e-6).ceil() as i64;
        let last = (high / step + 1e-6).floor() as i64;
        (step, first..=last)
    };
    let enough = (count..=4 * count.max(1)).map(places);
    let mut enough = enough.filter(|(_, at)| at.clone().count() >= 2);
    let (step, at) = enough.next().unwrap_or_else(|| places(count));
    let decimals = decimals(step);
    at.map(|k| {
        let value = k as f64 * step;
        (value, number(value, decimals))
    })
    .collect()
}

/// Decimals that write a step in full.
fn decimals(step: f64) -> usize {
    (0..12)
        .find(|d| {
            let scaled = step * libm::pow(10.0, *d as f64);
            (scaled - scaled.round()).abs() < 1e-6 * scaled
        })
        .unwrap_or(12)
}

fn number(value: f64, decimals: usize) -> String {
    crate::number::Rounding::Decimals(decimals)
        .round(value)
        .map_or_else(String::new, |n| n.typeset())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, count: usize) -> String {
        let ticks = round_ticks(low, high, count);
        ticks.into_iter().map(|t| t.1).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn there_are_two_ticks_at_least() {
        assert_eq!(labels(-90.0, 90.0, 1), "\u{2212}50 0 50");
    }

    #[test]
    fn ticks_stand_at_round_numbers() {
        assert_eq!(labels(0.0, 620.0, 7), "0 100 200 300 400 500 600");
        assert_eq!(labels(-0.02, 0.17, 4), "0.00 0.05 0.10 0.15");
        assert_eq!(
            labels(-30.0, 30.0, 6),
            "\u{2212}30 \u{2212}20 \u{2212}10 0 10 20 30"
        );
        assert_eq!(labels(0.0, 1.0, 4), "0.00 0.25 0.50 0.75 1.00");
    }

    #[test]
    fn ranges_leave_a_margin_and_begin_at_zero_where_the_data_do() {
        let axis = Axis::new("x");
        assert_eq!(axis.range(Some((0.0, 610.0)), 7), (0.0, 634.4));
        let (low, high) = axis.range(Some((120.0, 519.0)), 5);
        assert!((100.0..120.0).contains(&low) && high > 519.0);
        assert_eq!(axis.range(None, 5), (0.0, 1.04));
        assert_eq!(
            Axis::new("x").fixed(1.0, 2.0).range(Some((0.0, 9.0)), 5),
            (1.0, 2.0)
        );
    }

    #[test]
    fn a_single_value_gets_a_range() {
        let (low, high) = Axis::new("x").range(Some((5.0, 5.0)), 5);
        assert!(low < 5.0 && high > 5.0);
    }

    #[test]
    fn categories_are_ticks() {
        let axis = Axis::categories("", &["a", "b"]);
        assert_eq!(axis.range(None, 3), (-0.5, 1.5));
        assert_eq!(axis.ticks((-0.5, 1.5), 3).len(), 2);
    }
}
