//! What all readings share, by its columns or through the forward model: what is said of an unseen group is the same.

use crate::fit::Setting;
use crate::heldout::Unseen;
use crate::problem::{Coefficient, Component, Direction, Linearised, Point, Problem, Term};
use crate::tree::{Block, Tree};
use crate::variance::{Prior, Scale};

const GROUPS: usize = 4;
const EACH: usize = 4;
/// Number of the shared component, and of the groups' own.
const SHARED: usize = 0;
const OWN: usize = 1;

/// y = a + t x + b + e; t is shared, b each group's own, both standard normal, e of standard deviation 0.5.
struct Shared {
    tree: Tree,
    node: Vec<usize>,
    class: Vec<usize>,
    noise: [Scale; 1],
    components: [Component; 2],
    coefficients: [Coefficient; 1],
    observed: Vec<f64>,
    x: Vec<f64>,
}

impl Shared {
    /// `linear` is whether t takes part by its columns.
    fn new(linear: bool) -> Self {
        let block = |component| Block {
            component,
            columns: 1,
        };
        let mut tree = Tree::new(vec![block(SHARED)]);
        let node: Vec<usize> = (0..GROUPS)
            .flat_map(|_| [tree.add(0, vec![block(OWN)]); EACH])
            .collect();
        let known = |sd| Scale {
            prior: Prior::Fixed(sd),
            usual: sd,
            groups: GROUPS,
        };
        let component = |linear| Component {
            scale: known(1.0),
            linear,
            calibrates: true,
            misfit: false,
        };
        let x: Vec<f64> = (0..node.len()).map(|i| (i * i % 7) as f64).collect();
        Self {
            class: vec![0; node.len()],
            observed: x.iter().map(|x| 3.0 + 1.5 * x + (x * x) % 2.0).collect(),
            tree,
            node,
            noise: [known(0.5)],
            components: [component(linear), component(true)],
            coefficients: [Coefficient {
                start: 0.0,
                bounds: (-100.0, 100.0),
                free: true,
            }],
            x,
        }
    }
}

impl Problem for Shared {
    crate::problem::from_fields!();
    fn terms(&self) -> &[Term] {
        &[]
    }
    fn predict(&self, point: &Point) -> Vec<f64> {
        let shared = if self.components[SHARED].linear {
            0.0
        } else {
            point.random[0]
        };
        let of = |x: &f64| point.coefficients[0] + shared * x;
        self.x.iter().map(of).collect()
    }
    fn linearise(&self, point: &Point) -> Linearised {
        Linearised {
            predicted: self.predict(point),
            by_coefficients: vec![vec![1.0; self.x.len()]],
            by_terms: Vec::new(),
            random: self.x.iter().map(|x| vec![*x, 1.0]).collect(),
        }
    }
    fn directions(&self, _: &Point) -> Vec<Direction> {
        Vec::new()
    }
}

/// Errors before and after readings of the last group are known, and its log density.
fn said(linear: bool) -> (Vec<f64>, Vec<f64>, Vec<f64>, f64) {
    let problem = Shared::new(linear);
    let last = problem.node[problem.node.len() - 1];
    let all = Setting::new(&problem);
    let setting = all.without(last);
    let model = setting.fit(&problem.start(), &setting.fresh());
    let unseen = Unseen::new(&setting, &model);
    let predicted = unseen.predict_where(last, |_| true);
    let errors = |known: &[usize]| {
        let errors = unseen.errors_after(last, known).into_iter();
        errors.map(|(_, e)| e).collect()
    };
    let first = predicted.places[0];
    let (nothing, one) = (errors(&[]), errors(&[first]));
    (predicted.errors, nothing, one, predicted.log_density)
}

#[test]
fn what_is_shared_counts_once_whether_by_its_columns_or_through_the_model() {
    let [by_columns, through] = [true, false].map(said);
    let close = |a: &[f64], b: &[f64]| {
        let differ = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        assert!(differ.fold(0.0, f64::max) < 1e-9, "{a:?} {b:?}");
    };
    for (unread, nothing_known, ..) in [&by_columns, &through] {
        close(unread, nothing_known);
    }
    close(&by_columns.0, &through.0);
    close(&by_columns.2, &through.2);
    close(&[by_columns.3], &[through.3]);
    // The slope is told by the other groups.
    assert!(through.0.iter().all(|e| e.abs() < 2.0), "{:?}", through.0);
}
