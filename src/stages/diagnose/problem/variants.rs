//! The same readings under other assumptions: the scale and floor of the misfit, strokes, correlated noise, declared lengths, another form of the base law.

use super::{ForceProblem, OfStrokes, component};
use crate::base::Base;
use crate::settings;
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::problem::Problem;
use pipeline_inference::query;
use pipeline_inference::variance::{Prior, Scale};
use pipeline_numerics::statistics::median;
use std::collections::BTreeSet;

impl<'a> ForceProblem<'a> {
    /// The same with the misfit scaled by the predictions of a fit without it.
    pub fn with_reference(mut self) -> Self {
        let setting = Setting {
            misfit_factor: 0.0,
            ..Setting::new(&self).usual()
        };
        let fit = setting.fit(&self.start(), &setting.fresh()[..1]);
        let linear = self.linearise(&fit.point);
        self.reference = linear.predicted;
        self.reference_coefficients = fit.point.coefficients;
        let columns = linear.by_coefficients.into_iter().enumerate();
        let (sloped, slopes) = columns.filter(|(k, _)| self.coefficients[*k].free).unzip();
        (self.sloped, self.slopes) = (sloped, slopes);
        self.common_misfit = self.beside_the_law();
        self
    }

    /// The same with another floor of the scale of the misfit, a share of the largest force.
    pub fn with_floor(&self, share: f64) -> Self {
        let mut other = Self {
            floor: share * self.largest,
            ..self.rebuilt(self.base, self.of_strokes)
        };
        other.common_misfit = other.beside_the_law();
        other
    }

    /// The same with a misfit of every stroke; none where no session has several strokes, whose own that would be.
    pub fn with_strokes(&self) -> Option<Self> {
        let strokes = self.data.strokes().into_iter().max()? + 1;
        let misfit = OfStrokes {
            misfit: true,
            ..self.of_strokes
        };
        (strokes > self.sessions.len()).then(|| self.rebuilt(self.base, misfit))
    }

    /// The same with noise that is correlated in time within every stroke; none where no stroke has a time.
    pub fn with_wander(&self) -> Option<Self> {
        let wander = OfStrokes {
            wander: true,
            ..self.of_strokes
        };
        let mut with = self.rebuilt(self.base, wander);
        with.components.clone_from(&self.components);
        let strokes = with.data.strokes().into_iter().zip(&with.wander_basis);
        let in_time = strokes.filter(|(_, basis)| basis.iter().any(|b| *b != 0.0));
        let in_time: BTreeSet<usize> = in_time.map(|(stroke, _)| stroke).collect();
        let component = component::wander(in_time.len(), with.largest);
        with.components.push(component);
        (!in_time.is_empty()).then_some(with)
    }

    /// The same with the scatter of the declared set lengths estimated, for readings that contradict what was declared.
    pub fn with_declared_estimated(mut self) -> Self {
        let declared = self.data.set_length_sd_mm.iter().copied();
        let declared: Vec<f64> = declared.filter(|sd| sd.is_finite()).collect();
        let usual = settings::USUAL_SET_LENGTH_MM / median(&declared);
        self.components[component::DECLARED_LENGTH].scale = Scale {
            prior: Prior::HalfNormal(settings::LARGEST_SCATTER * usual),
            usual,
            groups: declared.len(),
        };
        self
    }

    /// Whether somebody declared the standard deviations of a component.
    pub fn is_declared(&self, c: usize) -> bool {
        let of_specimens = |k: usize| {
            let mut all = self.data.specimen_lengths_sd_mm.iter();
            all.any(|sd| sd[k].is_finite())
        };
        match c {
            component::DECLARED_LENGTH => {
                self.data.set_length_sd_mm.iter().any(|sd| sd.is_finite())
            }
            component::REST_LENGTH => of_specimens(0),
            component::CONTRACTED_LENGTH => of_specimens(1),
            _ => false,
        }
    }

    /// Whether the readings contradict the set lengths that were declared, beside a model.
    pub fn contradicts_declared(&self, setting: &Setting, model: &Fitted) -> bool {
        let c = component::DECLARED_LENGTH;
        self.is_declared(c) && query::is_too_small(setting, model, &model.restricted(setting), c)
    }

    /// The same readings and terms with another form of the base law.
    pub fn with_base<'b>(&self, base: &'b Base) -> ForceProblem<'b>
    where
        'a: 'b,
    {
        ForceProblem {
            components: self.components.clone(),
            ..self.rebuilt(base, self.of_strokes)
        }
    }

    /// The same readings, terms and scale of the misfit.
    fn rebuilt<'b>(&self, base: &'b Base, of_strokes: OfStrokes) -> ForceProblem<'b>
    where
        'a: 'b,
    {
        ForceProblem {
            reference: self.reference.clone(),
            slopes: self.slopes.clone(),
            sloped: self.sloped.clone(),
            reference_coefficients: self.reference_coefficients.clone(),
            common_misfit: self.common_misfit.clone(),
            floor: self.floor,
            ..ForceProblem::built(base, self.data, self.library, of_strokes)
        }
    }
}
