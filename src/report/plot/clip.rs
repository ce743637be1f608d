//! Cuts curves at the edges of a panel and thins those with more points than paper can show.

/// Smallest and largest visible `x` and `y`, in data units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Visible `x`.
    pub x: (f64, f64),
    /// Visible `y`.
    pub y: (f64, f64),
}

impl Window {
    /// Whether a point is visible; never for what is not finite.
    pub fn contains(&self, (x, y): (f64, f64)) -> bool {
        x >= self.x.0 && x <= self.x.1 && y >= self.y.0 && y <= self.y.1
    }

    /// The visible part of a segment (Liang and Barsky 1984).
    pub fn segment(&self, a: (f64, f64), b: (f64, f64)) -> Option<[(f64, f64); 2]> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let sides = [
            (-dx, a.0 - self.x.0),
            (dx, self.x.1 - a.0),
            (-dy, a.1 - self.y.0),
            (dy, self.y.1 - a.1),
        ];
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (slope, room) in sides {
            if !(slope.is_finite() && room.is_finite()) || (slope == 0.0 && room < 0.0) {
                return None;
            }
            if slope < 0.0 {
                enter = enter.max(room / slope);
            } else if slope > 0.0 {
                leave = leave.min(room / slope);
            }
        }
        // The ends themselves come back bit for bit, so that a curve's segments join again.
        let at = |t: f64| match t {
            0.0 => a,
            1.0 => b,
            _ => self.clamp((a.0 + t * dx, a.1 + t * dy)),
        };
        (enter <= leave).then(|| [at(enter), at(leave)])
    }

    /// The visible point nearest to `p`.
    pub fn clamp(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (x.clamp(self.x.0, self.x.1), y.clamp(self.y.0, self.y.1))
    }

    /// The visible pieces of a curve, parted at its edges and at points that are not finite.
    pub fn curve(&self, points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
        let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
        for pair in points.windows(2) {
            let Some([from, to]) = self.segment(pair[0], pair[1]) else {
                continue;
            };
            match pieces.last_mut() {
                Some(piece) if piece.last() == Some(&from) => piece.push(to),
                _ => pieces.push(vec![from, to]),
            }
        }
        pieces
    }

    /// The visible part of a band: cut at both sides, its edges held within the window.
    pub fn band(&self, points: &[(f64, f64, f64)]) -> Vec<(f64, f64, f64)> {
        let finite = |p: &&(f64, f64, f64)| p.0.is_finite() && p.1.is_finite() && p.2.is_finite();
        let points: Vec<_> = points.iter().filter(finite).copied().collect();
        let mut visible = Vec::new();
        for (i, &p) in points.iter().enumerate() {
            let inside = (self.x.0..=self.x.1).contains(&p.0);
            if let Some(&before) = i.checked_sub(1).and_then(|k| points.get(k)) {
                let edges = [self.x.0, self.x.1].into_iter();
                let cuts = edges.filter(|e| before.0 < *e && *e < p.0);
                visible.extend(cuts.map(|edge| between(before, p, edge)));
            }
            visible.extend(inside.then_some(p));
        }
        let held = |v: f64| v.clamp(self.y.0, self.y.1);
        visible
            .into_iter()
            .map(|(x, low, high)| (x, held(low), held(high)))
            .collect()
    }
}

fn between(a: (f64, f64, f64), b: (f64, f64, f64), x: f64) -> (f64, f64, f64) {
    let t = (x - a.0) / (b.0 - a.0);
    (x, a.1 + t * (b.1 - a.1), a.2 + t * (b.2 - a.2))
}

/// Thins a curve by columns `width` wide: of the points in a column the first, lowest, highest and last remain, in their order.
/// What is seen does not change; a curve that runs back is left alone.
pub fn thin(points: Vec<(f64, f64)>, width: f64) -> Vec<(f64, f64)> {
    if points.len() < 1000 || points.windows(2).any(|w| w[1].0 < w[0].0) {
        return points;
    }
    let column = |p: &(f64, f64)| (p.0 / width).floor();
    let mut kept = Vec::new();
    for group in points.chunk_by(|a, b| column(a) == column(b)) {
        let by_value = |a: &&usize, b: &&usize| group[**a].1.total_cmp(&group[**b].1);
        let numbers: Vec<usize> = (0..group.len()).collect();
        let extremes = [
            numbers.iter().min_by(by_value),
            numbers.iter().max_by(by_value),
        ];
        let mut keep: Vec<usize> = extremes.into_iter().flatten().copied().collect();
        keep.extend([0, group.len() - 1]);
        keep.sort_unstable();
        keep.dedup();
        kept.extend(keep.into_iter().map(|i| group[i]));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Window = Window {
        x: (0.0, 1.0),
        y: (0.0, 1.0),
    };

    #[test]
    fn segments_are_cut_at_the_edges() {
        assert_eq!(
            UNIT.segment((-1.0, 0.5), (0.5, 0.5)),
            Some([(0.0, 0.5), (0.5, 0.5)])
        );
        assert_eq!(UNIT.segment((-1.0, 2.0), (2.0, 2.0)), None);
        assert_eq!(UNIT.segment((f64::NAN, 0.0), (1.0, 1.0)), None);
    }

    #[test]
    fn curves_are_parted_where_they_leave_or_are_unknown() {
        let curve = [
            (0.1, 0.1),
            (0.2, 3.0),
            (0.3, 0.1),
            (f64::NAN, 0.2),
            (0.5, 0.5),
            (0.6, 0.5),
        ];
        assert_eq!(UNIT.curve(&curve).len(), 3);
    }

    #[test]
    fn bands_are_cut_and_held() {
        let band = UNIT.band(&[(-1.0, 0.0, 0.5), (1.0, 1.0, 2.5), (2.0, 0.0, 0.0)]);
        assert_eq!(band, [(0.0, 0.5, 1.0), (1.0, 1.0, 1.0)]);
    }

    #[test]
    fn thinning_keeps_the_extremes() {
        let wave: Vec<(f64, f64)> = (0..10_000)
            .map(|i| (i as f64, ((i * 37) % 101) as f64))
            .collect();
        let thinned = thin(wave, 100.0);
        assert!(thinned.len() <= 400);
        assert_eq!(thinned.iter().map(|p| p.1).fold(0.0, f64::max), 100.0);
    }
}
