//! Errors on readings that took no part, summed over groups: what a model says of groups that it has not seen, for forces and torques.

use pipeline_findings::{BudgetEntry, EffectFinding, Errors};
use pipeline_inference::decisions::NORMAL_95;
use pipeline_inference::heldout::Unseen;
use pipeline_numerics::distributions::{NORMAL_50, normal_cdf};
use std::collections::BTreeMap;

/// How many readings of each set-up are given, where a few are.
const GIVEN: [usize; 4] = [1, 2, 3, 5];
/// Bins of the probability integral transform.
const BINS: usize = 10;

/// The readings of a problem, as errors on them are summed.
pub struct Scored<'a> {
    /// Whether a reading is scored.
    pub takes: &'a dyn Fn(usize) -> bool,
    /// Number of the set-up (session, test) of a reading: its first few are given.
    pub setup: &'a dyn Fn(usize) -> usize,
    /// Measured less predicted where the misfit of the law is no part of the prediction; none where it is.
    pub alone: Option<&'a dyn Fn(usize) -> f64>,
}

/// Sums over readings that took no part.
#[derive(Default)]
pub struct Tally {
    /// Readings.
    pub count: usize,
    /// Sum of squared errors.
    pub squares: f64,
    /// Sum of squares that the model expects.
    pub expected: f64,
    /// How many are inside their 50 and 95% intervals.
    pub inside: (usize, usize),
    /// Measured less predicted, by reading.
    pub left: Vec<(usize, f64)>,
    calibrated: f64,
    largest: f64,
    log_density: f64,
    after: BTreeMap<usize, (f64, usize)>,
    spread: BTreeMap<usize, (f64, usize)>,
    bins: [usize; BINS],
    /// Expected squares by component, estimation and noise.
    sources: Vec<f64>,
    /// Squares of the misfit of the law, where it is no part of the prediction.
    misfit: f64,
}

impl Tally {
    /// Of the readings below a node, with the errors once its own values or a few of its readings are known.
    pub fn new(model: &Unseen, node: usize, scored: &Scored) -> Self {
        let mut tally = Self::unseen(model, node, scored);
        let squares = |errors: Vec<(usize, f64)>, known: &[usize]| -> (f64, usize) {
            let of = errors
                .iter()
                .filter(|(i, _)| (scored.takes)(*i) && !known.contains(i));
            of.fold((0.0, 0), |(sum, n), (_, e)| (sum + e * e, n + 1))
        };
        tally.calibrated = squares(model.errors_calibrated(node), &[]).0;
        let sizes = model.sizes(node, scored.takes);
        let places: Vec<usize> = sizes.iter().map(|(i, _)| *i).collect();
        for k in GIVEN {
            let after = |known: Vec<usize>| squares(model.errors_after(node, &known), &known);
            let first = after(first_readings(&places, scored.setup, k));
            tally.after.insert(k, first);
            let spread = after(spread_readings(&sizes, scored.setup, k));
            tally.spread.insert(k, spread);
        }
        tally
    }

    /// Of the readings below a node, as one sees them who knows nothing of it.
    pub fn unseen(model: &Unseen, node: usize, scored: &Scored) -> Self {
        let predicted = model.predict_where(node, scored.takes);
        let mut tally = Self {
            count: predicted.errors.len(),
            log_density: predicted.log_density,
            sources: predicted.sources.clone(),
            ..Self::default()
        };
        let readings = predicted.places.iter().zip(&predicted.errors);
        for ((i, e), sd) in readings.zip(&predicted.sd) {
            let alone = scored.alone.map_or(*e, |of| of(*i));
            let misfit = alone - e;
            tally.squares += alone * alone;
            tally.misfit += misfit * misfit;
            tally.expected += sd * sd + misfit * misfit;
            tally.largest = tally.largest.max(alone.abs());
            tally.left.push((*i, alone));
            tally.inside.0 += usize::from(e.abs() <= NORMAL_50 * sd);
            tally.inside.1 += usize::from(e.abs() <= NORMAL_95 * sd);
            let bin = (normal_cdf(e / sd) * BINS as f64) as usize;
            tally.bins[bin.min(BINS - 1)] += 1;
        }
        for s in &mut tally.sources {
            *s *= tally.count as f64;
        }
        tally
    }

    /// Adds another group's.
    pub fn add(&mut self, other: &Self) {
        self.squares += other.squares;
        self.calibrated += other.calibrated;
        self.count += other.count;
        self.left.extend_from_slice(&other.left);
        self.largest = self.largest.max(other.largest);
        self.log_density += other.log_density;
        self.expected += other.expected;
        self.misfit += other.misfit;
        self.inside.0 += other.inside.0;
        self.inside.1 += other.inside.1;
        for (a, b) in self.bins.iter_mut().zip(other.bins) {
            *a += b;
        }
        self.sources
            .resize(other.sources.len().max(self.sources.len()), 0.0);
        for (a, b) in self.sources.iter_mut().zip(&other.sources) {
            *a += b;
        }
        add_all(&mut self.after, &other.after);
        add_all(&mut self.spread, &other.spread);
    }

    /// The errors, those on readings that took part not filled in.
    pub fn errors(&self) -> Errors {
        let n = self.count as f64;
        let any = self.count > 0;
        let mean = |sum: f64| any.then(|| (sum / n).sqrt());
        let means = |of: &BTreeMap<usize, (f64, usize)>| {
            let any = of.iter().filter(|(_, (_, n))| *n > 0);
            any.map(|(k, (squares, n))| (k.to_string(), (squares / *n as f64).sqrt()))
                .collect()
        };
        Errors {
            rmse_train: None,
            rmse_heldout: mean(self.squares),
            max_abs_error_heldout: any.then_some(self.largest),
            rmse_heldout_calibrated: mean(self.calibrated),
            rmse_heldout_after: means(&self.after),
            rmse_heldout_spread: means(&self.spread),
            log_density_heldout: any.then(|| self.log_density / n),
        }
    }

    /// Measured less predicted of so many readings; NaN of those that were not held out.
    pub fn left_of(&self, readings: usize) -> Vec<f64> {
        let mut all = vec![f64::NAN; readings];
        for (reading, left) in &self.left {
            all[*reading] = *left;
        }
        all
    }

    /// Shares inside the 50 and 95% intervals; none where nothing was held out.
    pub fn shares_inside(&self) -> Option<(f64, f64)> {
        let share = |n: usize| n as f64 / self.count as f64;
        (self.count > 0).then(|| (share(self.inside.0), share(self.inside.1)))
    }

    /// Histogram of the probability integral transform, as shares; empty where nothing was held out.
    pub fn pit(&self) -> Vec<f64> {
        let any = self.bins.iter().filter(|_| self.count > 0);
        any.map(|b| *b as f64 / self.count as f64).collect()
    }

    /// The expected squared error by source, largest first: `source` names a component, or none to call it estimation.
    pub fn budget(
        &self,
        unit: &str,
        source: impl Fn(usize) -> Option<&'static str>,
    ) -> Vec<BudgetEntry> {
        if self.count == 0 {
            return Vec::new();
        }
        let noise = self.sources.len() - 1;
        let mut sums: BTreeMap<&str, f64> = BTreeMap::new();
        if self.misfit > 0.0 {
            sums.insert("common_misfit", self.misfit / self.count as f64);
        }
        for (k, variance) in self.sources.iter().enumerate() {
            let name = if k == noise { Some("noise") } else { source(k) };
            *sums.entry(name.unwrap_or("estimation")).or_default() += variance / self.count as f64;
        }
        let mut budget: Vec<BudgetEntry> = sums
            .into_iter()
            .map(|(source, variance)| BudgetEntry {
                source: source.to_owned(),
                variance,
                rmse: variance.sqrt(),
                unit: unit.to_owned(),
            })
            .collect();
        budget.sort_by(|a, b| b.variance.total_cmp(&a.variance));
        budget
    }
}

/// Notes the share of the searches that found each effect again, given what each found; nothing where there were none. What a search found stands
/// for one effect only: for itself, or else for the first that leaves the same trace.
pub fn note_found_again(effects: &mut [EffectFinding], searches: &[Vec<String>]) {
    if searches.is_empty() {
        return;
    }
    let mut again = vec![0; effects.len()];
    for found in searches {
        let mut left: Vec<&String> = found.iter().collect();
        let mut take = |stands_for: &dyn Fn(&String) -> bool| {
            let place = left.iter().position(|id| stands_for(id));
            place.map(|k| left.remove(k)).is_some()
        };
        let itself: Vec<bool> = effects.iter().map(|e| take(&|id| *id == e.id)).collect();
        for ((e, count), itself) in effects.iter().zip(&mut again).zip(itself) {
            *count += usize::from(itself || take(&|id| e.class.contains(id)));
        }
    }
    for (e, count) in effects.iter_mut().zip(again) {
        e.found_in_folds = Some(count as f64 / searches.len() as f64);
    }
}

/// The first readings of each set-up in time.
fn first_readings(places: &[usize], setup: &dyn Fn(usize) -> usize, count: usize) -> Vec<usize> {
    let mut given: BTreeMap<usize, usize> = BTreeMap::new();
    let is_given = |i: &&usize| {
        let n = given.entry(setup(**i)).or_default();
        *n += 1;
        *n <= count
    };
    places.iter().filter(is_given).copied().collect()
}

/// Adds sums of squares and counts, by the number of readings given.
fn add_all(sums: &mut BTreeMap<usize, (f64, usize)>, others: &BTreeMap<usize, (f64, usize)>) {
    for (k, (squares, n)) in others {
        let sum = sums.entry(*k).or_default();
        sum.0 += squares;
        sum.1 += n;
    }
}

/// Readings of each set-up spread over what it shows: the one of which the largest size is expected, and evenly spaced ones below it in the order
/// of these sizes. Somebody who takes few readings takes them so; the first ones in time are often of an actuator that hardly pulls.
fn spread_readings(
    sizes: &[(usize, f64)],
    setup: &dyn Fn(usize) -> usize,
    count: usize,
) -> Vec<usize> {
    let mut of_setup: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
    for (i, size) in sizes {
        of_setup.entry(setup(*i)).or_default().push((*i, *size));
    }
    let mut places = Vec::new();
    for mut readings in of_setup.into_values() {
        readings.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let (n, taken) = (readings.len(), count.min(readings.len()));
        places.extend((0..taken).map(|j| readings[j * n / taken].0));
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_readings_begin_with_the_largest_and_stand_evenly_below_it() {
        let sizes: Vec<(usize, f64)> = (0..12).map(|i| (i, f64::from(i as u32 % 6))).collect();
        let setup = |i: usize| i / 6;
        assert_eq!(spread_readings(&sizes, &setup, 1), [5, 11]);
        assert_eq!(spread_readings(&sizes, &setup, 2), [5, 2, 11, 8]);
        assert_eq!(spread_readings(&sizes, &setup, 3), [5, 3, 1, 11, 9, 7]);
        // No more than there are.
        assert_eq!(spread_readings(&sizes[..2], &setup, 5), [1, 0]);
    }

    /// An effect whose alias set is these ids, the first its own.
    fn effect(class: &[&str]) -> EffectFinding {
        let text = r#"{"id": "", "class": [], "acts_on": "all", "column": null, "from": null, "parameters": [],
            "form": "constant", "equation": "", "p_familywise": 0.005, "log_likelihood_gain": 9.0, "found_in_folds": null,
            "negligible": false, "rms": 1.0, "by_specimen": {}, "profile": [], "free_form": null, "in_its_place": [], "explained_as_well_by": [],
            "measurement": "", "source": ""}"#;
        let plain: EffectFinding = pipeline_base::json::from_slice(text.as_bytes()).unwrap();
        EffectFinding {
            id: class[0].to_owned(),
            class: class.iter().map(|id| (*id).to_owned()).collect(),
            ..plain
        }
    }

    #[test]
    fn what_a_search_found_stands_for_one_effect_only() {
        let both = [
            effect(&["hysteresis", "drift"]),
            effect(&["offset", "drift"]),
        ];
        let shares = |searches: &[&[&str]]| -> Vec<Option<f64>> {
            let mut effects = both.to_vec();
            let named = searches
                .iter()
                .map(|s| s.iter().map(|id| (*id).to_owned()).collect());
            note_found_again(&mut effects, &named.collect::<Vec<Vec<String>>>());
            effects.iter().map(|e| e.found_in_folds).collect()
        };
        // The drift of a search stands for an effect that it did not find itself.
        assert_eq!(shares(&[&["drift", "hysteresis"]]), [Some(1.0), Some(1.0)]);
        assert_eq!(shares(&[&["offset", "drift"]]), [Some(1.0), Some(1.0)]);
        assert_eq!(shares(&[&["drift"]]), [Some(1.0), Some(0.0)]);
        assert_eq!(
            shares(&[&["hysteresis"], &["zero"]]),
            [Some(0.5), Some(0.0)]
        );
        assert_eq!(
            shares(&[&["offset"], &["drift", "offset"]]),
            [Some(0.5), Some(1.0)]
        );
        assert_eq!(shares(&[]), [None, None]);
    }

    #[test]
    fn readings_of_one_size_are_taken_in_their_order() {
        let sizes = [(4, 1.0), (2, 1.0), (9, 1.0)];
        assert_eq!(spread_readings(&sizes, &|_| 0, 1), [2]);
    }
}
