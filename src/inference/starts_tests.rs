//! Own values of an unseen group with more than one optimum, in closed form.

use crate::fit::Setting;
use crate::heldout::Unseen;
use crate::problem::{Coefficient, Component, Direction, Linearised, Point, Problem, Term};
use crate::tree::{Block, Tree};
use crate::variance::{Prior, Scale};

const GROUPS: usize = 4;
const EACH: usize = 4;
const NOISE: f64 = 0.1;

/// y = a + b^2 + e, b standard normal for each group, e of standard deviation [`NOISE`]; y = 1 in the last group, else 0. At b = 0 nothing pulls b
/// anywhere.
struct Squared {
    tree: Tree,
    node: Vec<usize>,
    class: Vec<usize>,
    noise: [Scale; 1],
    components: [Component; 1],
    coefficients: [Coefficient; 1],
    observed: Vec<f64>,
}

impl Squared {
    fn new() -> Self {
        let mut tree = Tree::new(Vec::new());
        let block = || Block {
            component: 0,
            columns: 1,
        };
        let groups: Vec<usize> = (0..GROUPS).map(|_| tree.add(0, vec![block()])).collect();
        let known = |sd| Scale {
            prior: Prior::Fixed(sd),
            usual: sd,
            groups: GROUPS,
        };
        let node: Vec<usize> = groups.iter().flat_map(|g| [*g; EACH]).collect();
        let last = groups[GROUPS - 1];
        Self {
            observed: node.iter().map(|n| f64::from(*n == last)).collect(),
            class: vec![0; node.len()],
            tree,
            node,
            noise: [known(NOISE)],
            components: [Component {
                scale: known(1.0),
                linear: false,
                calibrates: true,
                misfit: false,
            }],
            coefficients: [Coefficient {
                start: 0.0,
                bounds: (-1.0, 1.0),
                free: true,
            }],
        }
    }

    fn own(&self, point: &Point, i: usize) -> f64 {
        let (first, _) = self.tree.columns_of(self.node[i], 0).unwrap();
        point.random[first]
    }
}

impl Problem for Squared {
    crate::problem::from_fields!();
    fn terms(&self) -> &[Term] {
        &[]
    }
    fn predict(&self, point: &Point) -> Vec<f64> {
        let own = (0..self.node.len()).map(|i| self.own(point, i));
        own.map(|b| point.coefficients[0] + b * b).collect()
    }
    fn linearise(&self, point: &Point) -> Linearised {
        let own = (0..self.node.len()).map(|i| self.own(point, i));
        Linearised {
            predicted: self.predict(point),
            by_coefficients: vec![vec![1.0; self.node.len()]],
            by_terms: Vec::new(),
            random: own.map(|b| vec![2.0 * b]).collect(),
        }
    }
    fn directions(&self, _: &Point) -> Vec<Direction> {
        Vec::new()
    }
}

#[test]
fn own_values_are_found_though_nothing_leads_to_them_from_nothing() {
    let problem = Squared::new();
    let mut setting = Setting::new(&problem);
    let last = problem.node[problem.node.len() - 1];
    for (node, active) in setting.active.iter_mut().enumerate() {
        *active = node != last;
    }
    let model = setting.fit(&problem.start(), &setting.fresh());
    let unseen = Unseen::new(&setting, &model);
    let errors = unseen.errors_calibrated(last);
    assert_eq!(errors.len(), EACH);
    // Of n (1 - s)^2 / e^2 + s with s = b^2 the lowest is at 1 - s = e^2 / (2 n).
    let expected = NOISE * NOISE / (2.0 * EACH as f64);
    for (_, error) in errors {
        assert!((error - expected).abs() < 1e-4, "{error} for {expected}");
    }
}
