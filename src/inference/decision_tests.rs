//! The decisions of the engine, each just on either side of its boundary, in a problem that is solved on paper.
//!
//! y = a + terms + intercept of the group + noise: 4 groups of 4 readings, standard deviations of intercept and noise known to be 1. Everything is
//! given by its coordinates on the 16 Walsh functions, which are of length 1 and stand at right angles to one another. Of these, number 0 is
//! constant, numbers 4, 8 and 12 differ between groups only (their variance is 1 + 4 x 1 = 5), all others within groups only (their variance is 1).
//! A term along a unit vector u within groups therefore has the likelihood ratio (u'y)^2, the estimate u'y and the standard error 1.

use crate::decisions::IDENTIFIABLE;
use crate::fit::{Fitted, Setting};
use crate::form::{Answer, Bootstrap, GRID, answers};
use crate::heldout::Unseen;
use crate::power::{Power, strength};
use crate::problem::{Coefficient, Component, Direction, Linearised, Point, Problem, Term};
use crate::profile::{Profile, Profiles};
use crate::query;
use crate::screen::{Normal, Screen};
use crate::search::{Decision, Found, Search};
use crate::statistic::{deviate, likelihood_ratio};
use crate::system::Factor;
use crate::system::Variances;
use crate::tree::{Block, Tree};
use crate::variance::{Prior, Scale};
use std::f64::consts::TAU;

const GROUPS: usize = 4;
const EACH: usize = 4;
/// A little, by which the tests go to either side of a boundary.
const LITTLE: f64 = 1e-6;

/// Coordinates on Walsh functions: number and length.
type Coordinates<'c> = &'c [(usize, f64)];

/// A vector of all readings.
fn along(coordinates: Coordinates) -> Vec<f64> {
    let walsh = |i: usize, w: usize| {
        if (i & w).count_ones().is_multiple_of(2) {
            0.25
        } else {
            -0.25
        }
    };
    let at = |i| coordinates.iter().map(|(w, x)| x * walsh(i, *w)).sum();
    (0..GROUPS * EACH).map(at).collect()
}

/// A term with its columns, one an amplitude.
#[derive(Clone)]
struct Form {
    term: Term,
    columns: Vec<Vec<f64>>,
    /// Where it acts by the square of its value, which no tangent at nothing shows: a value to start from.
    far: Option<f64>,
    /// How the predictions change where its size bends, for a value of 1.
    bends: Vec<Vec<f64>>,
    /// How they change where its size scatters.
    scatters: Vec<Vec<f64>>,
}

/// A named term of one amplitude.
fn form(kind: usize, column: Coordinates) -> Form {
    Form {
        term: Term {
            kind,
            named: true,
            whole: true,
            decoy: false,
            bounds: vec![(-1e6, 1e6)],
            amplitudes: 1,
            usual: f64::INFINITY,
        },
        columns: vec![along(column)],
        far: None,
        bends: Vec::new(),
        scatters: Vec::new(),
    }
}

impl Form {
    fn decoy(mut self) -> Self {
        self.term.decoy = true;
        self.without_name()
    }

    fn of_some(mut self) -> Self {
        self.term.whole = false;
        self
    }

    fn without_name(mut self) -> Self {
        self.term.named = false;
        self
    }

    fn usual(mut self, size: f64) -> Self {
        self.term.usual = size;
        self
    }

    fn up_to(mut self, bound: f64) -> Self {
        self.term.bounds[0].1 = bound;
        self
    }

    fn within(mut self, bound: f64) -> Self {
        self.term.bounds.fill((-bound, bound));
        self
    }

    fn squared_from(mut self, far: f64) -> Self {
        self.far = Some(far);
        self
    }

    fn bending(mut self, column: Coordinates) -> Self {
        self.bends.push(along(column));
        self
    }

    fn scattering(mut self, column: Coordinates) -> Self {
        self.scatters.push(along(column));
        self
    }

    fn and(mut self, column: Coordinates) -> Self {
        self.term.amplitudes += 1;
        self.shaped(column)
    }

    /// With a shape that shows along a column.
    fn shaped(mut self, column: Coordinates) -> Self {
        self.term.bounds.push((-1e6, 1e6));
        self.columns.push(along(column));
        self
    }
}

struct Line {
    tree: Tree,
    node: Vec<usize>,
    class: Vec<usize>,
    noise: Vec<Scale>,
    components: Vec<Component>,
    coefficients: Vec<Coefficient>,
    observed: Vec<f64>,
    terms: Vec<Term>,
    columns: Vec<Vec<Vec<f64>>>,
    far: Vec<Option<f64>>,
    bends: Vec<Vec<Vec<f64>>>,
    scatters: Vec<Vec<Vec<f64>>>,
}

impl Line {
    /// By what a term changes the predictions for a unit of its columns, and the derivative of that by its value.
    fn acting(&self, term: usize, value: f64) -> (f64, f64) {
        match self.far[term] {
            Some(_) => (value * value, 2.0 * value),
            None => (value, 1.0),
        }
    }
}

fn line(observed: Coordinates, forms: &[Form]) -> Line {
    let mut tree = Tree::new(Vec::new());
    let mut node = Vec::new();
    for _ in 0..GROUPS {
        let group = tree.add(
            0,
            vec![Block {
                component: 0,
                columns: 1,
            }],
        );
        node.extend([group; EACH]);
    }
    let known = Scale {
        prior: Prior::Fixed(1.0),
        usual: 1.0,
        groups: GROUPS,
    };
    Line {
        tree,
        class: vec![0; node.len()],
        node,
        noise: vec![known],
        components: vec![Component {
            scale: known,
            linear: true,
            calibrates: true,
            misfit: false,
        }],
        coefficients: vec![Coefficient {
            start: 0.0,
            bounds: (-1e6, 1e6),
            free: true,
        }],
        observed: along(observed),
        terms: forms.iter().map(|f| f.term.clone()).collect(),
        columns: forms.iter().map(|f| f.columns.clone()).collect(),
        far: forms.iter().map(|f| f.far).collect(),
        bends: forms.iter().map(|f| f.bends.clone()).collect(),
        scatters: forms.iter().map(|f| f.scatters.clone()).collect(),
    }
}

impl Problem for Line {
    crate::problem::from_fields!();
    fn terms(&self) -> &[Term] {
        &self.terms
    }
    fn predict(&self, point: &Point) -> Vec<f64> {
        let mut predicted = vec![point.coefficients[0]; self.observed.len()];
        for (term, values) in &point.terms {
            for (value, column) in values.iter().zip(&self.columns[*term]) {
                let (change, _) = self.acting(*term, *value);
                for (p, x) in predicted.iter_mut().zip(column) {
                    *p += change * x;
                }
            }
        }
        predicted
    }
    fn linearise(&self, point: &Point) -> Linearised {
        let columns = point.terms.iter().flat_map(|(t, values)| {
            let scaled = move |(v, column): (&f64, &Vec<f64>)| {
                let (_, slope) = self.acting(*t, *v);
                column.iter().map(|x| slope * x).collect()
            };
            values.iter().zip(&self.columns[*t]).map(scaled)
        });
        Linearised {
            predicted: self.predict(point),
            by_coefficients: vec![vec![1.0; self.observed.len()]],
            by_terms: columns.collect(),
            random: vec![vec![1.0]; self.observed.len()],
        }
    }
    fn directions(&self, point: &Point) -> Vec<Direction> {
        let is_new = |t: &usize| point.terms.iter().all(|(known, _)| known != t);
        let of = |term: usize| Direction {
            term,
            start: vec![1.0; self.columns[term].len()],
            columns: match self.far[term] {
                Some(_) => vec![vec![0.0; self.observed.len()]; self.columns[term].len()],
                None => self.columns[term].clone(),
            },
        };
        (0..self.terms.len()).filter(is_new).map(of).collect()
    }
    fn bends(&self, point: &Point, term: usize) -> Vec<Vec<f64>> {
        let in_model = point.terms.iter().find(|(t, _)| *t == term);
        in_model.map_or_else(Vec::new, |(t, values)| {
            let scaled = |column: &Vec<f64>| column.iter().map(|x| values[0] * x).collect();
            self.bends[*t].iter().map(scaled).collect()
        })
    }
    fn scatters(&self, _point: &Point, term: usize) -> Vec<Vec<f64>> {
        self.scatters[term].clone()
    }
    fn far(&self, point: &Point) -> Vec<(usize, Vec<f64>)> {
        let is_new = |t: &usize| point.terms.iter().all(|(known, _)| known != t);
        let from = |t: usize| self.far[t].map(|value| (t, vec![value]));
        (0..self.terms.len())
            .filter(is_new)
            .filter_map(from)
            .collect()
    }
}

/// Standard normal numbers that make of draw `k` the response `of(k)`: intercepts of 0, then the readings.
fn normal(
    of: impl Fn(usize) -> Vec<f64> + Sync,
) -> impl Fn(usize) -> Box<dyn FnMut() -> f64> + Sync {
    move |k| {
        let mut numbers = [0.0; GROUPS].into_iter().chain(of(k));
        Box::new(move || numbers.next().unwrap_or(0.0))
    }
}

const DECISION: Decision = Decision {
    level: 0.05,
    draws: 19,
    alike: 2.0,
    most_terms: 4,
    thorough: true,
};
const QUICK: Decision = Decision {
    thorough: false,
    ..DECISION
};

fn null(setting: &Setting) -> Fitted {
    setting.fit(&setting.problem.start(), &setting.fresh())
}

/// Draws that give a critical value: that of this likelihood ratio of one amplitude.
fn known(ratio: f64) -> Vec<f64> {
    vec![deviate(ratio, 1); 19]
}

/// Which search.
#[derive(Clone, Copy)]
enum By {
    Run,
    Exchanging,
}

/// What a search finds; draws that it makes itself are of the responses `own`.
fn searched(
    problem: &Line,
    decision: Decision,
    by: By,
    known: Option<&[f64]>,
    own: &Normal,
) -> Found {
    let setting = Setting::new(problem);
    let search = Search {
        setting: &setting,
        decision,
        tried: None,
    };
    match by {
        By::Run => search.run(null(&setting), own, known),
        By::Exchanging => search.run_exchanging(null(&setting), own, known),
    }
}

/// The same with a known critical value; in draws of its own there is nothing at all.
fn found_by(by: By, problem: &Line, decision: Decision, ratio: f64) -> Found {
    let nothing = normal(|_| along(&[]));
    searched(problem, decision, by, Some(&known(ratio)), &nothing)
}

fn found(problem: &Line, decision: Decision, ratio: f64) -> Found {
    found_by(By::Run, problem, decision, ratio)
}

/// Terms in the order in which they came in.
fn accepted(found: &Found) -> Vec<usize> {
    let of_model: Vec<usize> = found.model.point.terms.iter().map(|(t, _)| *t).collect();
    let accepted: Vec<usize> = found.accepted.iter().map(|a| a.term).collect();
    let sorted = |mut of: Vec<usize>| {
        of.sort_unstable();
        of
    };
    assert_eq!(sorted(of_model), sorted(accepted.clone()));
    accepted
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} against {b}");
}

/// Both sides of a boundary: below it, and above.
fn sides(boundary: f64) -> [(f64, bool); 2] {
    [(boundary - LITTLE, false), (boundary + LITTLE, true)]
}

#[test]
fn the_likelihood_ratio_is_the_square_of_the_projection() {
    // y = 7 + 3 w1 + 2 w4: u = w1 has the ratio 3^2, estimate 3; w4, between groups, 2^2/5 and estimate 2; w2 has none.
    let forms = [
        form(0, &[(1, 1.0)]),
        form(1, &[(4, 1.0)]),
        form(2, &[(2, 1.0)]),
    ];
    let problem = line(&[(0, 28.0), (1, 3.0), (4, 2.0)], &forms);
    let setting = Setting::new(&problem);
    let model = null(&setting);
    close(model.point.coefficients[0], 7.0, 1e-12);
    let screen = Screen::new(&setting, &model);
    let shown = screen.shown(4);
    for (s, (term, ratio, estimate)) in
        shown
            .iter()
            .zip([(0, 9.0, 3.0), (1, 0.8, 2.0), (2, 0.0, 0.0)])
    {
        assert_eq!(screen.directions[s.direction].term, term);
        close(s.likelihood_ratio, ratio, 1e-9);
        close(s.estimate[0], estimate, 1e-9);
    }
    // -(16 log 2 pi + 4 log 5 + 3^2 + 2^2/5)/2.
    let expected = -0.5 * (16.0 * libm::log(TAU) + 4.0 * libm::log(5.0) + 9.8);
    close(model.log_likelihood, expected, 1e-9);
}

#[test]
fn a_term_comes_in_from_the_critical_value() {
    for (ratio, comes_in) in sides(9.0) {
        let problem = line(&[(1, ratio.sqrt())], &[form(0, &[(1, 1.0)])]);
        for decision in [DECISION, QUICK] {
            let found = found(&problem, decision, 9.0);
            assert_eq!(!accepted(&found).is_empty(), comes_in, "{ratio}");
            if comes_in {
                close(found.accepted[0].gain, 0.5 * ratio, 1e-9);
                // None of the draws of its own reaches it: a batch of 40, beside the 19 that decide nothing at this level where these are made first.
                let draws = if decision.thorough { 59.0 } else { 40.0 };
                assert_eq!(found.accepted[0].p, 1.0 / (1.0 + draws));
            }
        }
    }
}

#[test]
fn what_is_known_to_be_nothing_is_tested_and_never_comes_in() {
    // So strong that no draws of its own are asked.
    let strong = form(0, &[(1, 1.0)]).decoy();
    let weak = form(1, &[(2, 1.0)]);
    for (ratio, comes_in) in sides(9.0) {
        let problem = line(
            &[(1, 7.0), (2, ratio.sqrt())],
            &[strong.clone(), weak.clone()],
        );
        let found = found(&problem, DECISION, 9.0);
        assert_eq!(accepted(&found) == [1], comes_in, "{ratio}");
        assert_eq!(found.tested[0].0, 0);
        let mut instead = found.accepted.iter().flat_map(|a| &a.in_its_place);
        assert!(instead.all(|i| i.term != 0));
    }
}

#[test]
fn several_amplitudes_are_measured_by_their_deviate() {
    // deviate(9, 1) = (9^(1/3) - 1 + 2/9)/sqrt(2/9) = 2.7627; of two amplitudes 2 (1 - 1/9 + 2.7627/3)^3 = 11.857 has the same.
    for (ratio, comes_in) in [(11.84, false), (11.87, true)] {
        let each = (0.5_f64 * ratio).sqrt();
        let forms = [form(0, &[(1, 1.0)]).and(&[(2, 1.0)])];
        let found = found(&line(&[(1, each), (2, each)], &forms), DECISION, 9.0);
        assert_eq!(!accepted(&found).is_empty(), comes_in, "{ratio}");
    }
}

#[test]
fn draws_of_its_own_decide_what_is_in_doubt() {
    // Given draws say 4, those of the model 9: between 4 and what is clear these decide.
    let own = normal(|_| along(&[(1, 3.0)]));
    for (ratio, comes_in) in sides(9.0) {
        let problem = line(&[(1, ratio.sqrt())], &[form(0, &[(1, 1.0)])]);
        let found = searched(&problem, DECISION, By::Run, Some(&known(4.0)), &own);
        assert_eq!(!accepted(&found).is_empty(), comes_in, "{ratio}");
    }
    // Clear is twice the deviate: deviate(4, 1) = 1.7176, and 3.4351 is that of (1 - 2/9 + 3.4351 sqrt(2/9))^3 = 13.773.
    let clear = likelihood_ratio(2.0 * deviate(4.0, 1), 1);
    close(clear, 13.773, 1e-3);
    let own = normal(|_| along(&[(1, 10.0)]));
    for (ratio, comes_in) in sides(clear) {
        let problem = line(&[(1, ratio.sqrt())], &[form(0, &[(1, 1.0)])]);
        let found = searched(&problem, DECISION, By::Run, Some(&known(4.0)), &own);
        assert_eq!(!accepted(&found).is_empty(), comes_in, "{ratio}");
    }
}

/// The data have so little between groups that the intercept's standard deviation is 0 by the full likelihood (3.5/4 < 1) and 0.2 by the restricted
/// one (3.5/3 = 1 + 4 x 0.2^2). A draw with 5 along each of the three functions between groups has v = 1 + 4 s^2 = 75/4 in its null and 50/4 beside a
/// direction along one of them: a likelihood ratio of 4 ln(75/50) = 1.622, not of 5^2.
#[test]
fn what_a_draw_has_between_groups_is_scatter_in_its_null_too() {
    let little = (3.5_f64 / 3.0).sqrt();
    let between = |size: f64| along(&[(4, size), (8, size), (12, size)]);
    let mut problem = line(
        &[(4, little), (8, little), (12, little)],
        &[form(0, &[(4, 1.0)])],
    );
    problem.components[0].scale.prior = Prior::Free;
    let setting = Setting::new(&problem);
    let null = null(&setting);
    assert!(null.variances.components[0] < 0.05);
    let restricted = null.restricted(&setting).components[0];
    close(restricted, (3.5_f64 / 3.0 - 1.0).sqrt() / 2.0, 1e-3);
    let draws = Screen::new(&setting, &null).draws(1, &normal(move |_| between(5.0)));
    close(draws[0], deviate(4.0 * libm::log(1.5), 1), 1e-3);
}

/// A term along w1 whose amplitude is given, and 99 draws with amplitudes from 1 to 4, of which the critical one is 1 + 94/33; all further draws
/// have 10.
fn decided_by_further_draws(by: By, decision: Decision, amplitude: f64) -> bool {
    let problem = line(&[(1, amplitude)], &[form(0, &[(1, 1.0)])]);
    let size = |k: usize| if k < 99 { 1.0 + k as f64 / 33.0 } else { 10.0 };
    let own = normal(move |k| along(&[(1, size(k))]));
    let decision = Decision {
        draws: 99,
        ..decision
    };
    !accepted(&searched(&problem, decision, by, None, &own)).is_empty()
}

#[test]
fn a_decision_that_the_draws_leave_open_gets_more_of_them() {
    for by in [By::Run, By::Exchanging] {
        for decision in [DECISION, QUICK] {
            // p = 4/100 by the first 99 draws alone; with the next 40 it is a third.
            assert!(!decided_by_further_draws(by, decision, 3.9));
            // Far above all of the first: no other is asked.
            assert!(decided_by_further_draws(by, decision, 8.0));
        }
    }
}

/// A first term along w1; a second along w1 + w2, of which 12 is left beside the first. 99 draws from the null, of which `wild` have 1000 along
/// w1 and all 4 along w2: the second has 4^2/2 = 8 in those that are not wild, and beside the first 4^2 = 16 in all.
fn with_wild_draws(by: By, wild: usize) -> Vec<usize> {
    let h = 0.5_f64.sqrt();
    let forms = [form(0, &[(1, 1.0)]), form(1, &[(1, h), (2, h)])];
    let problem = line(&[(1, 100.0), (2, 12.0_f64.sqrt())], &forms);
    let own = normal(move |k| along(&[(1, if k < wild { 1000.0 } else { 0.0 }), (2, 4.0)]));
    let decision = Decision {
        level: 0.5,
        draws: 99,
        ..QUICK
    };
    accepted(&searched(&problem, decision, by, None, &own))
}

#[test]
fn a_further_term_is_tested_against_draws_of_its_own_model_where_it_is_close() {
    // Level 0.5: the middle draw, 8, is critical. p = (1 + wild)/100 = 0.1 is not above 0.2 x 0.5: 12 > 8 comes in. p = 0.11 is: 12 < 16 does not.
    for by in [By::Run, By::Exchanging] {
        assert_eq!(with_wild_draws(by, 9), [0, 1]);
        assert_eq!(with_wild_draws(by, 10), [0]);
    }
}

/// A first term along w1; a second of which an eighth is along w2 and the rest along w1, with this likelihood ratio beside the first. All draws
/// have 8 along w2: the second has 8^2/8 = 8 in those from the null, and beside the first 8^2 = 64.
fn beside_a_first(by: By, ratio: f64) -> Vec<usize> {
    let (along_w1, along_w2) = (0.875_f64.sqrt(), 0.125_f64.sqrt());
    let forms = [
        form(0, &[(1, 1.0)]),
        form(1, &[(1, along_w1), (2, along_w2)]),
    ];
    let problem = line(&[(1, 100.0), (2, ratio.sqrt())], &forms);
    let own = normal(|_| along(&[(2, 8.0)]));
    let decision = Decision {
        level: 0.02,
        draws: 99,
        ..QUICK
    };
    accepted(&searched(&problem, decision, by, None, &own))
}

#[test]
fn where_draws_are_few_a_further_term_is_tested_against_draws_of_its_own_model_unless_it_is_clear()
{
    // Level 0.02: of 99 draws none comes to the second, p = 0.01, which is above 0.2 x 0.02. Clear is twice the deviate of what is critical, 8: deviate(8, 1) = 2.5927, and 5.1854 is that of (1 - 2/9 + 5.1854 sqrt(2/9))^3 = 33.455. Up to
    // there the second is beside draws of 64.
    let clear = likelihood_ratio(2.0 * deviate(8.0, 1), 1);
    close(clear, 33.4554, 1e-3);
    for (ratio, comes_in) in sides(clear) {
        for by in [By::Run, By::Exchanging] {
            let terms: &[usize] = if comes_in { &[0, 1] } else { &[0] };
            assert_eq!(beside_a_first(by, ratio), terms, "{ratio}");
        }
    }
    for by in [By::Run, By::Exchanging] {
        assert_eq!(beside_a_first(by, 70.0), [0, 1]);
    }
}

#[test]
fn a_term_is_deleted_where_it_gains_too_little_beside_the_others() {
    // y = (10, 9, r) on w1, w2, w3; A = (1, 1, 1)/sqrt 3 has (19 + r)^2/3 = 147 and comes in first, then B = w1 and C = w2, each for more
    // than 14 (clear). Beside both A has what is left along w3: r^2.
    for (ratio, stays) in sides(4.0) {
        let t = (1.0_f64 / 3.0).sqrt();
        let forms = [
            form(0, &[(1, t), (2, t), (3, t)]),
            form(1, &[(1, 1.0)]),
            form(2, &[(2, 1.0)]),
        ];
        let problem = line(&[(1, 10.0), (2, 9.0), (3, ratio.sqrt())], &forms);
        let found = found(&problem, QUICK, 4.0);
        let mut terms = accepted(&found);
        // Before tidying A is the first in any case.
        assert_eq!(terms.contains(&0), stays, "{ratio}");
        terms.retain(|t| *t != 0);
        assert_eq!(terms.len(), 2);
        if stays {
            assert_eq!(found.accepted[0].term, 0);
            close(found.accepted[0].gain, 0.5 * ratio, 1e-9);
        }
    }
}

#[test]
fn a_term_that_no_longer_shows_beside_the_bends_of_another_is_left_out() {
    // y = 40 w1 + b w2; A = w1, whose bends go along v = cos w2 + sin w3, and B = w2. With the coordinate q = (b cos)^2 along v their standard
    // deviation is best at a variance of q, and they gain q - 1 - ln q in likelihood ratio beside A alone, and nothing beside A and B.
    let q: f64 = 16.0;
    let ratio = 4.0;
    let bends = q - 1.0 - libm::log(q);
    for (beside, stays) in [(ratio - 1e-3, false), (ratio + 1e-3, true)] {
        let square = beside + bends;
        let cos = (q / square).sqrt();
        let sin = (1.0 - cos * cos).sqrt();
        let forms = [
            form(0, &[(1, 1.0)]).bending(&[(2, cos), (3, sin)]),
            form(1, &[(2, 1.0)]),
        ];
        let problem = line(&[(1, 40.0), (2, square.sqrt())], &forms);
        for decision in [DECISION, QUICK] {
            let terms = accepted(&found(&problem, decision, ratio));
            assert_eq!(terms.contains(&1), stays, "{beside}");
            assert!(terms.contains(&0));
        }
        // Bends of the weaker term along the stronger do not put that in doubt.
        let forms = [
            form(0, &[(1, 1.0)]),
            form(1, &[(2, 1.0)]).bending(&[(1, 1.0)]),
        ];
        let problem = line(&[(1, 40.0), (2, square.sqrt())], &forms);
        assert_eq!(accepted(&found(&problem, QUICK, ratio)).len(), 2);
    }
}

#[test]
fn a_term_that_tells_groups_apart_shows_beyond_their_scatter() {
    // y = a w1 + b w2; the term is the sum of two groups and goes along w1, their scatter along w1 and w2. Beside the term its variance v = 1 + tau^2
    // is best at b^2/2 = 8, and the term has a likelihood ratio of a^2/v, not of a^2.
    let b = 4.0;
    let square = 4.0 * 0.5 * b * b;
    let scattering = form(0, &[(1, 1.0)])
        .scattering(&[(1, 1.0)])
        .scattering(&[(2, 1.0)]);
    // Gains beside scatter are known to a twentieth.
    for (factor, comes_in) in [(0.9_f64, false), (1.1, true)] {
        let a = (factor * square).sqrt();
        for (form, comes_in) in [(scattering.clone(), comes_in), (form(0, &[(1, 1.0)]), true)] {
            let problem = line(&[(1, a), (2, b)], &[form]);
            for decision in [DECISION, QUICK] {
                let found = found(&problem, decision, 4.0);
                assert_eq!(!accepted(&found).is_empty(), comes_in, "{factor}");
            }
        }
    }
    // A term that does not show beyond its scatter keeps no other out, nor does it take another's place.
    let a = (0.9 * square).sqrt();
    let lesser = form(1, &[(1, 0.95), (3, 0.0975_f64.sqrt())]);
    let problem = line(&[(1, a), (2, b)], &[scattering.clone(), lesser.clone()]);
    for decision in [DECISION, QUICK] {
        assert_eq!(accepted(&found(&problem, decision, 4.0)), [1]);
    }
    // Not even many of them, be they of one kind or of several.
    for kinds in [[1, 1, 1, 1], [1, 2, 3, 4]] {
        let many = kinds.map(|kind| {
            let mut form = scattering.clone();
            form.term.kind = kind;
            form
        });
        let mut forms = many.to_vec();
        let mut last = lesser.clone();
        last.term.kind = 5;
        forms.push(last);
        let problem = line(&[(1, a), (2, b)], &forms);
        for decision in [DECISION, QUICK] {
            assert_eq!(accepted(&found(&problem, decision, 4.0)), [4], "{kinds:?}");
        }
    }
}

/// y = 10 w1 + e w2. A term along y itself, and one along w1: their log-likelihoods differ by e^2/2.
fn rivals(square: f64) -> (Line, [Form; 2]) {
    let e = square.sqrt();
    let n = (100.0 + square).sqrt();
    let forms = [form(0, &[(1, 10.0 / n), (2, e / n)]), form(1, &[(1, 1.0)])];
    (line(&[(1, 10.0), (2, e)], &forms), forms)
}

#[test]
fn a_name_and_what_acts_on_all_readings_are_preferred_where_both_are_alike() {
    // e^2/2 against 2.
    for less_simple in [Form::without_name, Form::of_some] {
        for (square, differs) in sides(4.0) {
            let (problem, [best, other]) = rivals(square);
            let problem = Line {
                terms: vec![less_simple(best).term, other.term],
                ..problem
            };
            for decision in [DECISION, QUICK] {
                let found = found(&problem, decision, 9.0);
                assert_eq!(accepted(&found), [usize::from(!differs)], "{square}");
            }
        }
    }
}

#[test]
fn a_swap_has_to_gain_a_tenth() {
    // y = (10, 12, r) on w1, w2, w3. Of the forms of one kind A = (0.96, 0.28, 0) has 12.96^2 = 168, B = (10, 0, r)/|..| 100 + r^2: A comes in, then
    // C = w2 for 244 - 168 = 76. Beside C form A explains 10^2, form B 10^2 + r^2: in log-likelihood r^2/2 against 0.1.
    for (square, swaps) in sides(0.2) {
        let r = square.sqrt();
        let n = (100.0 + square).sqrt();
        let forms = [
            form(0, &[(1, 0.96), (2, 0.28)]),
            form(0, &[(1, 10.0 / n), (3, r / n)]),
            form(1, &[(2, 1.0)]),
        ];
        let problem = line(&[(1, 10.0), (2, 12.0), (3, r)], &forms);
        let expected = if swaps { [1, 2] } else { [0, 2] };
        assert_eq!(accepted(&found(&problem, DECISION, 9.0)), expected);
        // In folds there are no swaps, but the other search exchanges forms by the same bar.
        assert_eq!(accepted(&found(&problem, QUICK, 9.0)), [0, 2]);
        let exchanged = found_by(By::Exchanging, &problem, QUICK, 9.0);
        assert_eq!(accepted(&exchanged), expected);
    }
}

#[test]
fn what_is_alike_is_listed_in_its_place() {
    // e^2/2 against 2.
    for (square, beyond) in sides(4.0) {
        let (problem, [best, other]) = rivals(square);
        let of = |problem: &Line, decision| {
            let found = found(problem, decision, 9.0);
            assert_eq!(accepted(&found), [0]);
            found.accepted[0].in_its_place.clone()
        };
        let listed = of(&problem, DECISION);
        let terms: Vec<usize> = listed.iter().map(|other| other.term).collect();
        assert_eq!(terms, if beyond { vec![] } else { vec![1] }, "{square}");
        for other in listed {
            close(other.log_likelihood, -0.5 * square, 1e-9);
        }
        // Not in folds, and not forms of its own kind.
        assert!(of(&problem, QUICK).is_empty());
        let of_one_kind = Line {
            terms: vec![
                best.term.clone(),
                Term {
                    kind: 0,
                    ..other.term
                },
            ],
            ..problem
        };
        assert!(of(&of_one_kind, DECISION).is_empty());
    }
}

#[test]
fn of_alike_terms_that_with_the_more_usual_size_is_chosen() {
    // e = 1: 0.5 in favour of the first, whose amplitude is sqrt 101: with usual size u this costs 101/(2 u^2), 0.5 for u = sqrt 101.
    for (usual, is_usual) in sides(101.0_f64.sqrt()) {
        let (problem, [best, other]) = rivals(1.0);
        let problem = Line {
            terms: vec![best.usual(usual).term, other.term],
            ..problem
        };
        for decision in [DECISION, QUICK] {
            let found = found(&problem, decision, 9.0);
            assert_eq!(accepted(&found), [usize::from(!is_usual)], "{usual}");
        }
    }
}

#[test]
fn no_test_depends_on_the_usual_size() {
    // Its cost is 9/(2 x 0.001^2), a million times what it gains.
    for (ratio, comes_in) in sides(9.0) {
        let problem = line(&[(1, ratio.sqrt())], &[form(0, &[(1, 1.0)]).usual(0.001)]);
        let found = found(&problem, DECISION, 9.0);
        assert_eq!(!accepted(&found).is_empty(), comes_in, "{ratio}");
    }
}

#[test]
fn no_test_depends_on_the_usual_size_beside_what_shows_nothing() {
    // A has 100, half of which its unusual size costs; B has 1, which is below the critical value of 9 and must not keep A out.
    let forms = [form(0, &[(1, 1.0)]).usual(1.0), form(1, &[(2, 1.0)])];
    let problem = line(&[(1, 10.0), (2, 1.0)], &forms);
    for decision in [DECISION, QUICK] {
        assert_eq!(accepted(&found(&problem, decision, 9.0)), [0]);
    }
}

#[test]
fn a_term_at_its_bound_is_not_chosen() {
    // The estimate is 10.
    for (bound, comes_in) in sides(10.0) {
        let problem = line(&[(1, 10.0)], &[form(0, &[(1, 1.0)]).up_to(bound)]);
        let found = found(&problem, DECISION, 9.0);
        assert_eq!(!accepted(&found).is_empty(), comes_in, "{bound}");
    }
    // e = 1: the first term, whose estimate is sqrt 101, is 0.5 better than the other. At its bound it does not come in by a swap or an exchange of
    // forms, and is not listed.
    for (bound, is_inside) in sides(101.0_f64.sqrt()) {
        for kind in [0, 1] {
            let (problem, [best, other]) = rivals(1.0);
            let problem = Line {
                terms: vec![best.up_to(bound).term, Term { kind, ..other.term }],
                ..problem
            };
            for by in [By::Run, By::Exchanging] {
                for decision in [DECISION, QUICK] {
                    let found = found_by(by, &problem, decision, 9.0);
                    assert_eq!(accepted(&found), [usize::from(!is_inside)], "{bound}");
                    let is_listed = is_inside && decision.thorough && kind == 1;
                    let listed = found.accepted[0].in_its_place.len();
                    assert_eq!(listed, usize::from(is_listed));
                }
            }
        }
    }
}

#[test]
fn what_the_fixed_effects_span_is_not_shown() {
    // sqrt(1 - q) w0 + sqrt q w1: c'V^-1 c = (1 - q)/5 + q, of which q is left. q/((1 - q)/5 + q) = s for q = s/(5 - 4 s).
    for (share, is_shown) in sides(IDENTIFIABLE) {
        let q = share / (5.0 - 4.0 * share);
        let forms = [form(0, &[(0, (1.0 - q).sqrt()), (1, q.sqrt())])];
        let problem = line(&[(1, 10.0)], &forms);
        let setting = Setting::new(&problem);
        let model = null(&setting);
        let shown = Screen::new(&setting, &model).shown(1);
        assert_eq!(!shown.is_empty(), is_shown, "{share}");
        for s in shown {
            close(s.share, share, 1e-9);
            close(s.length, q.sqrt(), 1e-9);
        }
        let found = found(&problem, DECISION, 9.0);
        assert_eq!(!accepted(&found).is_empty(), is_shown, "{share}");
    }
}

#[test]
fn a_search_ends_where_no_candidate_is_left() {
    // None at all; and the only one, without a name, where those with names are tried by themselves.
    for by in [By::Run, By::Exchanging] {
        let problem = line(&[(1, 10.0)], &[]);
        assert!(accepted(&found_by(by, &problem, DECISION, 9.0)).is_empty());
        let problem = line(&[(1, 10.0)], &[form(0, &[(1, 1.0)]).without_name()]);
        assert_eq!(accepted(&found_by(by, &problem, DECISION, 9.0)), [0]);
    }
}

#[test]
fn what_no_tangent_at_nothing_shows_is_found_from_afar() {
    // The square of its value is along w1: the likelihood ratio of a term is that of w1, its value the root.
    for (square, is_there) in sides(9.0) {
        let problem = line(
            &[(1, square.sqrt())],
            &[form(0, &[(1, 1.0)]).squared_from(3.0)],
        );
        let found = found(&problem, DECISION, 9.0);
        assert_eq!(!accepted(&found).is_empty(), is_there, "{square}");
        if let Some(values) = found.model.values(0) {
            close(values[0] * values[0], square.sqrt(), 1e-3);
        }
        assert!(accepted(&found_by(By::Run, &problem, QUICK, 9.0)).is_empty());
    }
}

#[test]
fn a_term_with_a_name_stands_for_one_without_where_only_its_far_start_shows_it() {
    // Both lie along w1; the tangent shows the nameless one alone.
    let forms = [
        form(0, &[(1, 1.0)]).without_name(),
        form(1, &[(1, 1.0)]).squared_from(3.0),
    ];
    let problem = line(&[(1, 10.0)], &forms);
    assert_eq!(accepted(&found(&problem, DECISION, 9.0)), [1]);
    assert_eq!(accepted(&found(&problem, QUICK, 9.0)), [0]);
}

#[test]
fn the_smallest_size_found_is_that_of_students_test() {
    // Without intercepts the noise alone is estimated, from 16 readings with a sum of squares of 16: the likelihood ratio of a size a along w1 is
    // 16 ln(1 + a^2/16), and at the smallest size that is found it is (3 + 0.84)^2.
    let scale = |prior| Scale {
        prior,
        usual: 1.0,
        groups: GROUPS,
    };
    let of = |along_w1: f64| {
        let mut problem = line(&[(1, along_w1), (2, 4.0)], &[form(0, &[(1, 1.0)])]);
        problem.components[0].scale = scale(Prior::Fixed(0.0));
        problem.noise = vec![scale(Prior::Free)];
        problem
    };
    let problem = of(0.0);
    let setting = Setting::new(&problem);
    let nothing = null(&setting);
    close(nothing.variances.noise[0], 1.0, 1e-3);
    let size = Power::new(&setting, &nothing).smallest(&along(&[(1, 1.0)]), 1.0, 9.0);
    let wanted = (3.0 + 0.841_621_233_6) * (3.0 + 0.841_621_233_6);
    close(size * size, 16.0 * libm::expm1(wanted / 16.0), 0.01);
    let problem = of(size);
    let setting = Setting::new(&problem);
    let mut from = problem.start();
    from.terms.push((0, vec![size]));
    let with = setting.fit(&from, &setting.fresh()).log_likelihood;
    let ratio = 2.0 * (with - null(&setting).log_likelihood);
    close(ratio, wanted, 0.02);
    // The same by a fit to readings that hold it.
    let problem = of(0.0);
    let setting = Setting::new(&problem);
    let nothing = null(&setting);
    for values in [vec![vec![size]], vec![vec![size], vec![-size]]] {
        let shown = strength(&setting, &nothing, 0, &values);
        close(shown * shown, wanted, 0.02);
    }
    // Where all variances are known it is that of the normal test.
    let problem = line(&[(2, 4.0)], &[form(0, &[(1, 1.0)])]);
    let setting = Setting::new(&problem);
    let size = Power::new(&setting, &null(&setting)).smallest(&along(&[(1, 1.0)]), 1.0, 9.0);
    close(size * size, wanted, 1e-6);
}

#[test]
fn an_amplitude_that_cannot_be_a_standard_error_within_its_bounds_is_no_candidate() {
    // A standard error of an amplitude along w1 is 1.
    for (bound, candidates) in [(0.99, 0), (1.01, 1)] {
        let problem = line(&[(1, 10.0)], &[form(0, &[(1, 1.0)]).within(bound)]);
        let setting = Setting::new(&problem);
        let shown = Screen::new(&setting, &null(&setting)).shown(0);
        assert_eq!(shown.len(), candidates, "{bound}");
        let directions = problem.directions(&problem.start());
        assert_eq!(
            Screen::of(&setting, &null(&setting), directions)
                .shown(0)
                .len(),
            1
        );
    }
    // Of two nearly parallel columns the second shows beside the first only by w2, a hundredth of it.
    for (bound, amplitudes) in [(99.0, 1), (101.0, 2)] {
        let two = form(0, &[(1, 1.0)]).and(&[(1, 1.0), (2, 0.01)]);
        let problem = line(&[(1, 10.0)], &[two.within(bound)]);
        let setting = Setting::new(&problem);
        let shown = Screen::new(&setting, &null(&setting)).shown(0);
        assert_eq!(shown[0].amplitudes, amplitudes, "{bound}");
        assert_eq!(shown[0].estimate.len(), 2);
    }
}

#[test]
fn there_are_no_more_than_most_terms() {
    let forms = [1, 2, 3].map(|w| form(w, &[(w, 1.0)]));
    let problem = line(&[(1, 10.0), (2, 12.0), (3, 11.0)], &forms);
    for (most_terms, expected) in [
        (0, vec![]),
        (1, vec![1]),
        (2, vec![1, 2]),
        (3, vec![1, 2, 0]),
        (4, vec![1, 2, 0]),
    ] {
        let decision = Decision {
            most_terms,
            ..DECISION
        };
        for by in [By::Run, By::Exchanging] {
            let found = found_by(by, &problem, decision, 9.0);
            assert_eq!(accepted(&found), expected);
        }
    }
}

#[test]
fn two_forms_of_one_kind_never_stand_in_one_model() {
    for (kind, expected) in [(0, vec![0]), (1, vec![0, 1])] {
        let forms = [form(0, &[(1, 1.0)]), form(kind, &[(2, 1.0)])];
        let problem = line(&[(1, 12.0), (2, 11.0)], &forms);
        for by in [By::Run, By::Exchanging] {
            for decision in [DECISION, QUICK] {
                assert_eq!(accepted(&found_by(by, &problem, decision, 9.0)), expected);
            }
        }
        // Nor where the other form is in the model that is tried.
        let setting = Setting::new(&problem);
        let mut from = problem.start();
        from.terms.push((1, vec![11.0]));
        let tried = setting.fit(&from, &setting.fresh());
        let search = Search {
            setting: &setting,
            decision: QUICK,
            tried: Some(&tried),
        };
        let nothing = normal(|_| along(&[]));
        let found = search.run(null(&setting), &nothing, Some(&known(9.0)));
        assert_eq!(accepted(&found), expected);
    }
}

#[test]
fn every_further_amplitude_has_to_be_worth_it_where_terms_of_two_kinds_stand_for_one_another() {
    // Beside w1 alone the second amplitude gains e^2/2, against 2.
    for (square, is_worth_it) in sides(4.0) {
        let forms = [form(0, &[(1, 1.0)]).and(&[(2, 1.0)]), form(1, &[(1, 1.0)])];
        let problem = line(&[(1, 10.0), (2, square.sqrt())], &forms);
        for by in [By::Run, By::Exchanging] {
            let found = found_by(by, &problem, QUICK, 9.0);
            assert_eq!(accepted(&found), [usize::from(!is_worth_it)]);
        }
    }
}

#[test]
fn every_further_amplitude_has_to_be_worth_it_among_forms_of_one_kind() {
    for (square, is_worth_it) in sides(4.0) {
        let forms = [form(0, &[(1, 1.0)]).and(&[(2, 1.0)]), form(0, &[(1, 1.0)])];
        let problem = line(&[(1, 10.0), (2, square.sqrt())], &forms);
        let exchanged = found_by(By::Exchanging, &problem, QUICK, 9.0);
        assert_eq!(accepted(&exchanged), [usize::from(!is_worth_it)]);
    }
}

/// y = (10, 10, r) on w1, w2, w3; terms with names along w1 and w2, one without along y: in log-likelihood this is r^2/2 better than both.
fn flexible(square: f64) -> Line {
    let r = square.sqrt();
    let n = (200.0 + square).sqrt();
    let forms = [
        form(0, &[(1, 1.0)]),
        form(1, &[(2, 1.0)]),
        form(2, &[(1, 10.0 / n), (2, 10.0 / n), (3, r / n)]).without_name(),
    ];
    line(&[(1, 10.0), (2, 10.0), (3, r)], &forms)
}

#[test]
fn two_terms_come_in_for_one_where_neither_does_alone() {
    // y = a (w1 + w2): (w1 + w2 + w3)/sqrt 3 comes first, with 4 a^2/3. Beside it either of w1 and w2 gains a^2/6, in its place they lose; both in its
    // place gain 2 a^2/3.
    let forms = [
        form(0, &[(1, 1.0), (2, 1.0), (3, 1.0)]),
        form(1, &[(1, 1.0)]),
        form(2, &[(2, 1.0)]),
    ];
    for (ratio, comes_in) in sides(9.0) {
        let a = (1.5 * ratio).sqrt();
        let problem = line(&[(1, a), (2, a)], &forms);
        for decision in [DECISION, QUICK] {
            let exchanged = found_by(By::Exchanging, &problem, decision, 9.0);
            let expected: &[usize] = if comes_in { &[1, 2] } else { &[0] };
            let mut terms = accepted(&exchanged);
            terms.sort_unstable();
            assert_eq!(terms, expected, "{ratio}");
            assert_eq!(accepted(&found(&problem, decision, 9.0)), [0]);
        }
    }
}

#[test]
fn another_kind_comes_in_first_as_well_where_several_came_in() {
    // y = a (w1 + w2), twice the log-likelihood of both is 2 a^2. (w1 + w2 + w3)/sqrt 3, another form of the first, comes first with 4 a^2/3 and hides w2,
    // which gains a^2/6 beside it; (w1 + w2 - 2 w3 + sqrt 2 w5)/sqrt 8 gains a^2/2. In the place of either alone, w1 or w2 lose.
    let a = 6.0;
    let forms = [
        form(0, &[(1, 1.0)]),
        form(0, &[(1, 1.0), (2, 1.0), (3, 1.0)]),
        form(1, &[(2, 1.0)]),
        form(2, &[(1, 1.0), (2, 1.0), (3, -2.0), (5, 2.0_f64.sqrt())]),
    ];
    let problem = line(&[(1, a), (2, a)], &forms);
    for (decision, expected) in [(DECISION, [0, 2]), (QUICK, [1, 3])] {
        let mut terms = accepted(&found(&problem, decision, 9.0));
        terms.sort_unstable();
        assert_eq!(terms, expected);
    }
    // With a third term that both answers have.
    let forms = [&forms[..], &[form(3, &[(6, 1.0)])]].concat();
    let problem = line(&[(1, a), (2, a), (6, 5.0)], &forms);
    let mut terms = accepted(&found(&problem, DECISION, 9.0));
    terms.sort_unstable();
    assert_eq!(terms, [0, 2, 4]);
}

#[test]
fn names_by_themselves_are_preferred_to_a_curve_where_forms_are_exchanged() {
    // r^2/2 against 2.
    for (square, differs) in sides(4.0) {
        let mut terms = accepted(&found_by(By::Exchanging, &flexible(square), QUICK, 9.0));
        terms.sort_unstable();
        assert_eq!(terms, if differs { vec![2] } else { vec![0, 1] });
    }
}

#[test]
fn a_point_is_judged_with_linear_components_following_it() {
    // Readings of 0 and a coefficient of 3: in a group of n readings the intercept, with a standard deviation as large as the noise, takes
    // n/(n + 1) of the -3 and leaves 9 n/(n + 1). With the intercepts held at 0 it would be 9 n.
    let problem = line(&[], &[]);
    let setting = Setting::new(&problem);
    let model = null(&setting);
    let alone = setting.linear_only(&model.variances);
    let factor = Factor::new(&model.design.tree, &model.gram, &alone);
    let mut point = problem.start();
    point.coefficients[0] = 3.0;
    let predicted = problem.predict(&point);
    let sum = setting.objective(
        &point,
        &predicted,
        (&model.design, &factor),
        &model.variances,
    );
    let n = EACH as f64;
    close(sum, GROUPS as f64 * 9.0 * n / (n + 1.0), 1e-9);
}

#[test]
fn a_comparison_is_given_up_where_it_is_out_of_reach() {
    // From 1000 the square takes ten halvings to its maximum at 5; what is wanted far beyond that is out of reach before.
    let problem = line(&[(1, 25.0)], &[form(0, &[(1, 1.0)]).squared_from(1e3)]);
    let setting = Setting::new(&problem);
    let mut from = problem.start();
    from.terms.push((0, vec![1e3]));
    let there = setting.fit(&from, &setting.fresh());
    let reached = setting.compare(&from, &setting.fresh(), there.log_likelihood - 1.0);
    close(reached.log_likelihood, there.log_likelihood, 0.02);
    let given_up = setting.compare(&from, &setting.fresh(), there.log_likelihood + 1e9);
    assert!(!given_up.converged);
}

#[test]
fn a_better_model_without_terms_takes_the_place_of_the_null() {
    // The null's log-likelihood is said to be lower than it is, by about 0.1.
    for (short, is_better) in sides(0.1) {
        let problem = line(&[(1, 10.0)], &[form(0, &[(1, 1.0)])]);
        let setting = Setting::new(&problem);
        let search = Search {
            setting: &setting,
            decision: DECISION,
            tried: None,
        };
        let best = null(&setting);
        let mut poor = best.clone();
        poor.log_likelihood -= short;
        let nothing = normal(|_| along(&[]));
        let found = search.run(poor, &nothing, Some(&known(9.0)));
        assert_eq!(accepted(&found), [0]);
        let missing = best.log_likelihood - found.null.log_likelihood;
        close(missing, if is_better { 0.0 } else { short }, 1e-9);
    }
}

#[test]
fn a_name_is_kept_where_both_are_alike() {
    for (square, differs) in sides(4.0) {
        let (problem, [best, other]) = rivals(square);
        let problem = Line {
            terms: vec![best.without_name().term, other.term],
            ..problem
        };
        let found = found(&problem, DECISION, 9.0);
        assert_eq!(accepted(&found), [usize::from(!differs)], "{square}");
        let mut terms = accepted(&found_by(By::Exchanging, &flexible(square), DECISION, 9.0));
        terms.sort_unstable();
        assert_eq!(terms, if differs { vec![2] } else { vec![0, 1] });
    }
}

#[test]
fn a_weak_term_with_a_name_is_preferred_where_both_are_alike() {
    // 12 and 9.2: in log-likelihood they differ by 1.4 < 2, but 9.2 < 0.8 x 12.
    let (a, b) = (9.2_f64.sqrt(), 2.8_f64.sqrt());
    let n = 12.0_f64.sqrt();
    let forms = [
        form(0, &[(1, a / n), (2, b / n)]).without_name(),
        form(1, &[(1, 1.0)]),
    ];
    let problem = line(&[(1, a), (2, b)], &forms);
    assert_eq!(accepted(&found(&problem, QUICK, 9.0)), [1]);
}

#[test]
fn what_draws_of_its_own_let_in_stays() {
    // Draws from the null have 10^2 along w1, which is nothing beside the first term: there the second has 36 against 0.
    let forms = [form(0, &[(1, 1.0)]), form(1, &[(2, 1.0)])];
    let problem = line(&[(1, 100.0), (2, 6.0)], &forms);
    let own = normal(|_| along(&[(1, 10.0)]));
    for by in [By::Run, By::Exchanging] {
        let decision = Decision {
            level: 0.5,
            draws: 9,
            ..DECISION
        };
        let found = searched(&problem, decision, by, None, &own);
        assert_eq!(accepted(&found), [0, 1]);
    }
}

/// A null model with this sum of squares between groups, and the variances with this standard deviation of the intercepts.
fn between(square: f64, sd: f64, check: impl Fn(&Setting, &Fitted, &Variances)) {
    let problem = line(&[(4, square.sqrt()), (1, 2.0)], &[]);
    let setting = Setting::new(&problem);
    let model = null(&setting);
    let mut variances = model.variances.clone();
    variances.components[0] = sd;
    check(&setting, &model, &variances);
}

#[test]
fn a_known_standard_deviation_is_too_small_from_the_cut() {
    // Between groups there are three degrees of freedom of variance v = 1 + 4 sd^2: -(3 log v + B/v)/2. Of what is tried, twice the sd comes first:
    // v = 17 instead of 5, (B (1/5 - 1/17) - 3 log(17/5))/2 = 1.9207 for B = 53.216 (1.5 times needs 59.2, 3 times 56.9).
    let boundary = (3.841_458_820_694_124 + 3.0 * libm::log(3.4)) / (0.2 - 1.0 / 17.0);
    close(boundary, 53.216, 1e-3);
    for (square, is_too_small) in sides(boundary) {
        between(square, 1.0, |setting, model, variances| {
            let found = query::is_too_small(setting, model, variances, 0);
            assert_eq!(found, is_too_small, "{square}");
        });
    }
}

#[test]
fn an_interval_of_a_standard_deviation_ends_at_the_cut() {
    // B = 15 is most likely with v = 5, sd = 1. For u = v/5 the fall is 3 (log u + 1/u - 1)/2: 1.9207 at u = 0.28203 and 8.7197, sd =
    // sqrt((5 u - 1)/4) = 0.3202 and 3.2637. The ends are looked for in steps of 1.05.
    let fall = |u: f64| 1.5 * (libm::log(u) + 1.0 / u - 1.0);
    let sd = |u: f64| (0.25 * (5.0 * u - 1.0)).sqrt();
    let (low, high) = (0.28203, 8.7197);
    close(fall(low), 1.920_73, 1e-3);
    close(fall(high), 1.920_73, 1e-3);
    between(15.0, 1.0, |setting, model, variances| {
        let (a, b) = query::interval(setting, model, variances, 0);
        assert!(a <= sd(low) * 1.001 && a >= sd(low) / 1.051, "{a}");
        let b = b.unwrap_or(f64::NAN);
        assert!(b >= sd(high) / 1.001 && b <= sd(high) * 1.051, "{b}");
    });
}

#[test]
fn an_interval_of_a_standard_deviation_begins_at_0_where_that_is_above_the_cut() {
    // sd = 0 is v = 1: with B = 3 v its fall is 3 (B/3 - log(B/3) - 1)/2, 1.9207 for B = 3/0.28203 = 10.637.
    for (square, is_above) in [(10.62, false), (10.66, true)] {
        let sd = (0.25 * (square / 3.0 - 1.0_f64)).sqrt();
        between(square, sd, |setting, model, variances| {
            let (low, _) = query::interval(setting, model, variances, 0);
            assert_eq!(low > 0.0, is_above, "{square}");
        });
    }
}

#[test]
fn an_interval_of_a_standard_deviation_has_no_end_beyond_its_range() {
    // The upper end is between 3.2637 and 1.05 times that; the range is a hundred usual sizes.
    for (usual, has_end) in [(0.0326, false), (0.0345, true)] {
        let mut problem = line(&[(4, 15.0_f64.sqrt())], &[]);
        problem.components[0].scale.usual = usual;
        let setting = Setting::new(&problem);
        let model = null(&setting);
        let (_, high) = query::interval(&setting, &model, &model.variances, 0);
        assert_eq!(high.is_some(), has_end, "{usual}");
    }
}

#[test]
fn a_component_gains_nothing_where_the_groups_are_alike() {
    // Restricted likelihood, three degrees: (B - B/5 - 3 log 5)/2, 0 for B = 3.75 log 5 = 6.035.
    let zero = 3.75 * libm::log(5.0);
    for (square, gain) in [(zero - 1.0, 0.0), (zero, 0.0), (zero + 1.0, 0.4)] {
        between(square, 1.0, |setting, model, _| {
            close(query::gain_of(setting, model, 0), gain, 1e-9);
        });
    }
}

#[test]
fn a_term_is_sensitive_under_the_critical_value() {
    // The ratio is 16, whatever the misfit's prior: there is none.
    let problem = line(&[(1, 4.0)], &[form(0, &[(1, 1.0)])]);
    let setting = Setting::new(&problem);
    for (ratio, is_sensitive) in sides(16.0) {
        let mut found = found(&problem, DECISION, 9.0);
        found.accepted[0].critical = deviate(ratio, 1);
        assert_eq!(!query::sensitive(&setting, &found).is_empty(), is_sensitive);
    }
}

#[test]
fn groups_that_do_not_show_a_term_have_no_estimate_of_it() {
    // (w1 + w9)/sqrt 2 has 4 readings of 1/sqrt 8 in groups 0 and 1 each, nothing in 2 and 3. w5 is w1 with the sign turned in groups 1 and 3:
    // y = (4 w1 + 4 w9 + w5 + w13) is 5 w1 + 5 w9 in group 0, 3 w1 + 3 w9 in group 1. Standard error sqrt 2.
    let h = 0.5_f64.sqrt();
    let problem = line(
        &[(1, 4.0), (9, 4.0), (5, 1.0), (13, 1.0)],
        &[form(0, &[(1, h), (9, h)])],
    );
    let found = found(&problem, DECISION, 9.0);
    assert_eq!(accepted(&found), [0]);
    let group: Vec<usize> = problem.node.iter().map(|n| n - 1).collect();
    let setting = Setting::new(&problem);
    let all = query::by_group(&setting, &found.model, 0, 0, &group);
    for (estimate, value) in all.iter().zip([Some(5.0 / h), Some(3.0 / h), None, None]) {
        assert_eq!(estimate.map(|e| e.value).is_some(), value.is_some());
        if let (Some(estimate), Some(value)) = (estimate, value) {
            close(estimate.value, value, 1e-9);
            close(estimate.standard_error, 2.0_f64.sqrt(), 1e-9);
        }
    }
}

#[test]
fn groups_share_the_shape_of_a_term() {
    // As above, with a shape along (w5 + w13)/sqrt 2: the amplitude in group 0, its opposite in group 1. With amplitude 4 sqrt 2 and shape sqrt 2 as
    // found, both groups have that amplitude; with the shape free beside them neither had one.
    let h = 0.5_f64.sqrt();
    let problem = line(
        &[(1, 4.0), (9, 4.0), (5, 1.0), (13, 1.0)],
        &[form(0, &[(1, h), (9, h)]).shaped(&[(5, h), (13, h)])],
    );
    let setting = Setting::new(&problem);
    let mut from = problem.start();
    from.terms.push((0, vec![1.0, 1.0]));
    let model = setting.fit(&from, &setting.fresh());
    let group: Vec<usize> = problem.node.iter().map(|n| n - 1).collect();
    let all = query::by_group(&setting, &model, 0, 0, &group);
    for estimate in &all[..2] {
        let estimate = estimate.unwrap();
        close(estimate.value, 4.0 / h, 1e-9);
        close(estimate.standard_error, 2.0_f64.sqrt(), 1e-9);
    }
}

/// The profile of a term along a Walsh function, estimate 10, in draws that have `drawn` along it.
fn profiled(w: usize, drawn: f64, bound: f64) -> Option<Profile> {
    let problem = line(&[(w, 10.0)], &[form(0, &[(w, 1.0)]).up_to(bound)]);
    let setting = Setting::new(&problem);
    let mut from = problem.start();
    from.terms.push((0, vec![9.0]));
    let model = setting.fit(&from, &setting.fresh());
    let own = normal(move |_| along(&[(w, drawn)]));
    Profiles::new(&setting, &model, &own).of(0, 0)
}

#[test]
fn a_profile_ends_at_the_cut() {
    // 10 -+ 1.95996 standard errors, times the root of the mean ratio in draws where that is above 1. Within groups the error is 1 and the ratio
    // drawn^2, between groups sqrt 5 and drawn^2/5. Beyond the last step of 4.5 errors the end is where a straight line meets the cut.
    let deviate = 1.959_963_984_540_054;
    for (w, error, drawn, stretch) in [
        (1, 1.0, 0.0, 1.0),
        (1, 1.0, 1.0 - LITTLE, 1.0),
        (1, 1.0, 1.5, 1.5),
        (1, 1.0, 2.2, 2.2),
        (1, 1.0, 2.4, 2.4),
        (4, 5.0_f64.sqrt(), 1.5 * 5.0_f64.sqrt(), 1.5),
    ] {
        let found = profiled(w, drawn, 1e6).expect("its value is free");
        close(found.value, 10.0, 1e-9);
        let half = deviate * error * stretch;
        close(found.low.unwrap_or(f64::NAN), 10.0 - half, 1e-6);
        close(found.high.unwrap_or(f64::NAN), 10.0 + half, 1e-6);
    }
}

#[test]
fn a_profile_has_no_end_beyond_the_bound() {
    // Ends at 10 + 1.95996 stretch, whether the bound is between the steps, before the last or beyond it.
    for stretch in [1.0, 2.0, 2.5, 3.0] {
        let end = 10.0 + 1.959_963_984_540_054 * stretch;
        for (bound, has_end) in sides(end) {
            let found = profiled(1, stretch, bound).expect("its value is free");
            assert_eq!(found.high.is_some(), has_end, "{stretch}");
            close(found.low.unwrap_or(f64::NAN), 20.0 - end, 1e-6);
        }
    }
    // At its bound it is not free.
    for (bound, is_free) in sides(10.0) {
        assert_eq!(profiled(1, 0.0, bound).is_some(), is_free, "{bound}");
    }
}

/// Readings of three groups of mean 2 and of a fourth of readings 3, 4, 5, 8; the fourth took no part.
fn unseen(calibrates: bool, check: impl Fn(&Unseen, usize)) {
    let mut problem = line(&[], &[]);
    problem.components[0].calibrates = calibrates;
    problem.observed[..12].fill(2.0);
    problem.observed[12..].copy_from_slice(&[3.0, 4.0, 5.0, 8.0]);
    let node = problem.node[12];
    let all = Setting::new(&problem);
    let setting = all.without(node);
    let model = null(&setting);
    close(model.point.coefficients[0], 2.0, 1e-12);
    check(&Unseen::new(&setting, &model), node);
}

#[test]
fn further_readings_lower_the_variance_of_the_mean() {
    unseen(true, |unseen, _| {
        // The mean has variance c = 5/12. A reading of a group of its own has v = 2 and takes c^2/(v + c) off: 25/348, which leaves 10/29; the next
        // one then 25/493.
        close(unseen.variance_in_new_groups(0), 2.0, 1e-12);
        let found = unseen.best_additions(&[3, 7], &[12, 13], 2);
        let falls: Vec<f64> = found.iter().map(|(_, fall)| *fall).collect();
        close(falls[0], 25.0 / 348.0, 1e-12);
        close(falls[1], 25.0 / 493.0, 1e-12);
        assert!(unseen.best_additions(&[], &[12], 2).is_empty());
    });
}

#[test]
fn an_unseen_group_has_its_intercept_the_mean_and_the_noise_for_variance() {
    unseen(true, |unseen, node| {
        let found = unseen.predict_where(node, |_| true);
        assert_eq!(found.places, [12, 13, 14, 15]);
        // The mean of three groups: (1 + 1/4)/3 = 5/12.
        let estimation: f64 = 5.0 / 12.0;
        for (error, expected) in found.errors.iter().zip([1.0, 2.0, 3.0, 6.0]) {
            close(*error, expected, 1e-12);
        }
        for sd in &found.sd {
            close(*sd, (1.0 + 1.0 + estimation).sqrt(), 1e-12);
        }
        for (source, expected) in found.sources.iter().zip([1.0, estimation, 1.0]) {
            close(*source, expected, 1e-12);
        }
        // The mean of the errors is 3, of variance 1/4 + 1 + 5/12 = v/4, v = 20/3; about it the sum of squares is 4 + 1 + 0 + 9 = 14.
        let v: f64 = 20.0 / 3.0;
        let expected = -0.5 * (4.0 * libm::log(TAU) + libm::log(v) + 14.0 + 36.0 / v);
        close(found.log_density, expected, 1e-9);
        // One reading alone: variance 29/12.
        let one = unseen.predict_where(node, |i| i == 15);
        let v: f64 = 29.0 / 12.0;
        let expected = -0.5 * (libm::log(TAU * v) + 36.0 / v);
        close(one.log_density, expected, 1e-9);
    });
}

#[test]
fn new_readings_of_a_class_that_is_held_have_the_noise_that_it_shows() {
    // The noise is held at 3 for the fit. By itself, from 16 readings about their mean with a sum of squares S, its restricted likelihood with the
    // prior has the slope S/s^2 - 15 - 9 s^2/3^2 + (1 - s^2)/(1 + s^2) by ln s: 0 at s = 1 where S is 16.
    let scale = |prior, groups| Scale {
        prior,
        usual: 1.0,
        groups,
    };
    let mut problem = line(&[(2, 4.0)], &[]);
    problem.components[0].scale = scale(Prior::Fixed(0.0), GROUPS);
    problem.noise = vec![scale(Prior::Held(3.0), 9)];
    let setting = Setting::new(&problem);
    let model = null(&setting);
    close(model.variances.noise[0], 3.0, 1e-12);
    // Readings of a group are alike: their mean is that of 4 groups, and new readings scatter about it by a factor of 5/3 more.
    let shown = model.shown(&setting, &model.variances);
    close(shown.noise[0], (5.0_f64 / 3.0).sqrt(), 1e-3);
    let unseen = Unseen::new(&setting, &model);
    close(
        unseen.variance_in_new_groups(0),
        shown.noise[0] * shown.noise[0],
        1e-9,
    );
}

/// Errors on the unseen readings, each by so much less than that of the prediction.
fn shortened(errors: &[(usize, f64)], by: f64) {
    assert_eq!(errors.len(), EACH);
    for ((_, error), predicted) in errors.iter().zip([1.0, 2.0, 3.0, 6.0]) {
        close(*error, predicted - by, 1e-9);
    }
}

#[test]
fn what_is_known_of_an_unseen_group_shrinks_its_errors() {
    unseen(true, |unseen, node| {
        // Intercept and mean have variance 17/12: of the error 1 of the first reading 17/29 are theirs; of the mean error 3 of all four 17/20.
        shortened(&unseen.errors_after(node, &[]), 0.0);
        shortened(&unseen.errors_after(node, &[12]), 17.0 / 29.0);
        let all = [12, 13, 14, 15];
        shortened(&unseen.errors_after(node, &all), 3.0 * 17.0 / 20.0);
    });
}

#[test]
fn only_what_calibrates_shortens_the_calibrated_errors() {
    // The intercept alone, the mean as fitted: 1/(1 + 1/4) of the mean error 3.
    for (calibrates, by) in [(true, 2.4), (false, 0.0)] {
        unseen(calibrates, |unseen, node| {
            shortened(&unseen.errors_calibrated(node), by);
        });
    }
}

/// What further columns gain; in draws of its own the response is `own`.
fn further(observed: Coordinates, sets: &[&[Coordinates]], own: &Normal) -> Vec<Option<Answer>> {
    let problem = line(observed, &[]);
    let setting = Setting::new(&problem);
    let sets: Vec<Vec<Vec<f64>>> = sets
        .iter()
        .map(|set| set.iter().map(|c| along(c)).collect())
        .collect();
    let bootstrap = Bootstrap {
        level: 0.05,
        draws: 19,
    };
    answers(&setting, &null(&setting), &sets, bootstrap, own)
}

#[test]
fn further_columns_gain_from_the_mean_square_of_what_they_explain() {
    // Two unit columns within groups with z = (a, b) and r = (a^2 + b^2)/2: the log-likelihood of tau is r t/(1 + t) - log(1 + t), t = tau^2, at
    // its largest where 1 + t = r, and there r - 1 - log r; nothing from r = 1 downwards. Their size is that of their standard deviation only.
    let nothing = normal(|_| along(&[]));
    for (a, b) in [(3.0, 2.0), (0.5, 3.5), (1.2, 1.1), (1.1, 0.8), (0.3, 0.2)] {
        let r: f64 = (a * a + b * b) / 2.0;
        for size in [1.0, 3.0] {
            let columns: [Coordinates; 2] = [&[(1, size)], &[(2, size)]];
            let found = further(&[(0, 28.0), (1, a), (2, b)], &[&columns], &nothing);
            let answer = found[0].as_ref().expect("they can be told from a constant");
            let gain = if r > 1.0 { r - 1.0 - libm::log(r) } else { 0.0 };
            close(answer.gain, gain, 1e-4);
            if r > 1.5 {
                close(answer.sd * size, (r - 1.0).sqrt(), 1e-2);
            }
            let unit = (r - 1.0).max(1.0).sqrt();
            let (u, square) = averaged(a, r, unit);
            close(answer.mean[0] * size, u, 2e-2);
            let variance = answer.covariance.at(0, 0) * size * size;
            close(variance, square - u * u, 2e-2);
            // The constant: 5/16 of a squared standard error, whatever tau.
            close(answer.mean[2], 0.0, 1e-9);
            close(answer.covariance.at(2, 2), 5.0 / 16.0, 1e-9);
        }
    }
}

/// Mean and mean square of the coefficient of a unit column with the projection `z`, tau averaged over its likelihood.
fn averaged(z: f64, r: f64, unit: f64) -> (f64, f64) {
    let t = |k: usize| unit * unit * GRID[k] * GRID[k];
    let last = GRID.len() - 1;
    let weight = |k: usize| {
        let t = t(k);
        let width = GRID[last.min(k + 1)] - GRID[k.saturating_sub(1)];
        width * libm::exp(r * t / (1.0 + t)) / (1.0 + t)
    };
    let all: f64 = (0..GRID.len()).map(weight).sum();
    let of = |value: &dyn Fn(f64) -> f64| {
        let terms = (0..GRID.len()).map(|k| weight(k) * value(t(k) / (1.0 + t(k))));
        terms.sum::<f64>() / all
    };
    (of(&|kept| z * kept), of(&|kept| kept + z * z * kept * kept))
}

#[test]
fn further_columns_are_asked_about_where_the_fixed_effects_leave_a_share() {
    let nothing = normal(|_| along(&[]));
    for (share, is_asked) in sides(IDENTIFIABLE) {
        // The variance along the constant is 5.
        let column: Coordinates = &[(0, (5.0 * (1.0 - share)).sqrt()), (1, share.sqrt())];
        let found = further(&[(1, 3.0)], &[&[column]], &nothing);
        assert_eq!(found[0].is_some(), is_asked, "{share}");
    }
    assert!(further(&[(1, 3.0)], &[&[]], &nothing)[0].is_none());
}

#[test]
fn a_draw_counts_where_the_largest_gain_of_any_set_reaches_that_of_the_data() {
    let data: Coordinates = &[(1, 3.0), (2, 2.0)];
    let own: [Coordinates; 2] = [&[(1, 1.0)], &[(2, 1.0)]];
    let other: [Coordinates; 2] = [&[(3, 1.0)], &[(5, 1.0)]];
    for (factor, counts) in [(1.0 - 1e-3, false), (1.0 + 1e-3, true)] {
        for (k, l) in [(1, 2), (3, 5)] {
            let drawn = normal(move |draw| {
                if draw == 7 {
                    along(&[(k, 3.0 * factor), (l, 2.0 * factor)])
                } else {
                    along(&[])
                }
            });
            let found = further(data, &[&own, &other], &drawn);
            let p: Vec<f64> = found.iter().flatten().map(|a| a.p).collect();
            assert_eq!(p, [if counts { 0.1 } else { 0.05 }, 1.0], "{factor} {k}");
        }
        // By itself the first set does not see a draw of the second.
        let drawn = normal(move |_| along(&[(3, 3.0 * factor), (5, 2.0 * factor)]));
        let found = further(data, &[&own], &drawn);
        assert_eq!(found[0].as_ref().map(|a| a.p), Some(0.05));
    }
}
