//! What a problem tells the engine: readings with their groups, a forward model with derivatives, nuisance components, candidate terms.
//!
//! The engine knows nothing else of it. Force and torque are two problems.

use crate::tree::Tree;
use crate::variance::Scale;

/// A component of the random part: an operator with a value for each group, or a smooth misfit.
#[derive(Clone, Debug)]
pub struct Component {
    /// What is known of its standard deviation, in the unit of the component.
    pub scale: Scale,
    /// Whether the forward model is linear in it: its columns are then frozen within an outer iteration, and it takes no part in
    /// [`Problem::predict`].
    pub linear: bool,
    /// Whether a new specimen's own value may be learnt from its readings and used where the errors with known gain and lengths are asked
    /// for; a misfit may not.
    pub calibrates: bool,
    /// Whether [`crate::fit::Setting::misfit_factor`] scales its prior.
    pub misfit: bool,
}

/// A coefficient of the base law.
#[derive(Clone, Debug, PartialEq)]
pub struct Coefficient {
    /// Where fits start.
    pub start: f64,
    /// Where it may go.
    pub bounds: (f64, f64),
    /// Whether it is fitted.
    pub free: bool,
}

/// Something that may be added to the law: a form of an effect, with what it acts on; or a smooth function of a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// What it is a form of: terms of one kind are alternatives to one another.
    pub kind: usize,
    /// Whether it has a physical name.
    pub named: bool,
    /// Whether it acts on all readings alike: of two terms that explain alike it is the simpler one than one that acts on some.
    pub whole: bool,
    /// Whether it is known to be nothing: it is tested as every other, so that its probability can be read, and never comes in.
    pub decoy: bool,
    /// Bounds of every value: amplitudes first, then the shape, if it has one.
    pub bounds: Vec<(f64, f64)>,
    /// How many of the values are amplitudes.
    pub amplitudes: usize,
    /// Up to which size its amplitudes are usual; infinite where nobody knows. Of models that explain alike the one with the more usual sizes is
    /// chosen; no test depends on it.
    pub usual: f64,
}

/// A way in which a term shows: the change of the predictions for unit amplitude.
#[derive(Clone, Debug)]
pub struct Direction {
    /// Number of the term.
    pub term: usize,
    /// Values at which a fit of the term starts, should the direction be chosen; each amplitude times its estimate is taken.
    pub start: Vec<f64>,
    /// One column an amplitude.
    pub columns: Vec<Vec<f64>>,
}

/// Where the forward model is evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// All coefficients, free or not.
    pub coefficients: Vec<f64>,
    /// Terms in the model, each with its values.
    pub terms: Vec<(usize, Vec<f64>)>,
    /// Random effects, all columns of the tree.
    pub random: Vec<f64>,
}

/// The forward model and its derivatives at a point.
#[derive(Clone, Debug)]
pub struct Linearised {
    /// Predictions with the random effects of the point, those of linear components left out.
    pub predicted: Vec<f64>,
    /// Derivatives by the coefficients, one column each (also of those that are not free).
    pub by_coefficients: Vec<Vec<f64>>,
    /// Derivatives by the values of the terms, in their order.
    pub by_terms: Vec<Vec<f64>>,
    /// For each reading the derivatives by the random effects of its path.
    pub random: Vec<Vec<f64>>,
}

/// A problem for the engine.
pub trait Problem: Sync {
    /// The groups.
    fn tree(&self) -> &Tree;
    /// Node of each reading.
    fn node(&self) -> &[usize];
    /// Class of noise of each reading.
    fn class(&self) -> &[usize];
    /// What is known of the noise of each class.
    fn noise(&self) -> &[Scale];
    /// The readings.
    fn observed(&self) -> &[f64];
    /// The components.
    fn components(&self) -> &[Component];
    /// The coefficients of the law.
    fn coefficients(&self) -> &[Coefficient];
    /// All terms that may be added.
    fn terms(&self) -> &[Term];
    /// Predictions at a point, linear components left out.
    fn predict(&self, point: &Point) -> Vec<f64>;
    /// Predictions and derivatives at a point.
    fn linearise(&self, point: &Point) -> Linearised;
    /// Predictions at some readings, and for each of them the derivatives by the random effects of its path: a problem may know a shorter way than
    /// by all readings.
    fn linearise_some(&self, point: &Point, readings: &[usize]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let mut all = self.linearise(point);
        let predicted = readings.iter().map(|&i| all.predicted[i]).collect();
        let rows = readings.iter().map(|&i| std::mem::take(&mut all.random[i]));
        (predicted, rows.collect())
    }
    /// Predictions at some readings.
    fn predict_some(&self, point: &Point, readings: &[usize]) -> Vec<f64> {
        let all = self.predict(point);
        readings.iter().map(|&i| all[i]).collect()
    }
    /// How the terms that are not in the model would show at a point.
    fn directions(&self, point: &Point) -> Vec<Direction>;

    /// Terms that are not in the model, with values at which they show in another form than at small ones, whatever the coefficients of the law:
    /// where fits start as well. A tangent says little of these.
    fn far(&self, _point: &Point) -> Vec<(usize, Vec<f64>)> {
        Vec::new()
    }

    /// How the predictions change where the size of a term in the model is not one number but bends along the term's own argument: a few columns.
    /// None where the term has no argument.
    fn bends(&self, _point: &Point, _term: usize) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// How the predictions change where the size of a term scatters among the groups between which the term tells differences, in a way that the null
    /// model does not know: one column a group. None where the term does not act between groups.
    fn scatters(&self, _point: &Point, _term: usize) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// How one term that is not in the model would show at a point: a problem may know a shorter way than to ask for all.
    fn directions_of(&self, point: &Point, term: usize) -> Vec<Direction> {
        let mut all = self.directions(point);
        all.retain(|d| d.term == term);
        all
    }

    /// The coefficients where fits start, no terms, random effects 0.
    fn start(&self) -> Point {
        Point {
            coefficients: self.coefficients().iter().map(|c| c.start).collect(),
            terms: Vec::new(),
            random: vec![0.0; self.tree().columns()],
        }
    }
}

/// What a problem of a test keeps in fields of these names.
#[cfg(test)]
macro_rules! from_fields {
    () => {
        fn tree(&self) -> &$crate::tree::Tree {
            &self.tree
        }
        fn node(&self) -> &[usize] {
            &self.node
        }
        fn class(&self) -> &[usize] {
            &self.class
        }
        fn noise(&self) -> &[$crate::variance::Scale] {
            &self.noise
        }
        fn observed(&self) -> &[f64] {
            &self.observed
        }
        fn components(&self) -> &[$crate::problem::Component] {
            &self.components
        }
        fn coefficients(&self) -> &[$crate::problem::Coefficient] {
            &self.coefficients
        }
    };
}
#[cfg(test)]
pub(crate) use from_fields;
