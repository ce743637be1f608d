//! Measured against predicted force on common readings, the new model beside those with which it is ranked: the figure of the first page.

use crate::figures::Named;
use crate::figures::formatting::{listed, number, plain};
use crate::input::{GroupInput, ReportInput};
use crate::opening::SHOWN;
use crate::plot::{Axis, DOUBLE_MM, Figure, Layer, Mark, Panel, Series, look};
use crate::predictions::Predicted;
use crate::wording::name::model_name;
use pipeline_base::columns::predicted;
use pipeline_base::row::Row;
use pipeline_compare::NEW;
use pipeline_fit::is_usable;

/// Name of its files.
pub const NAME: &str = "common-readings";
const HEIGHT_MM: f64 = 66.0;
/// Groups with a mark of their own; those with most readings come first.
const MOST_GROUPS: usize = 6;

/// The figure; none where no reading is common to the new model and another one. Groups are those that were measured, where there are any, and no
/// pools, whose readings are those of their members.
pub fn figure(input: &ReportInput) -> Option<Named> {
    let groups = input.with_section().map(|(g, _)| g);
    let mut groups: Vec<&GroupInput> = groups.filter(|g| g.fit.group.members.len() == 1).collect();
    let measured = groups.iter().any(|g| !g.fit.group.simulated);
    groups.retain(|g| g.fit.group.simulated != measured);
    groups.sort_by_key(|g| std::cmp::Reverse((g.fit.specimens.len(), g.fit.rows)));
    groups.truncate(MOST_GROUPS);
    let clouds: Vec<Cloud> = groups.into_iter().map(|g| Cloud::new(input, g)).collect();
    let clouds: Vec<Cloud> = clouds
        .into_iter()
        .filter(|c| !c.readings.is_empty())
        .collect();
    if clouds.is_empty() {
        return None;
    }
    let has_some = |k: &usize| clouds.iter().any(|c| c.answers[*k]);
    let models: Vec<usize> = (0..SHOWN.len()).filter(has_some).collect();
    let title = "Measured against predicted force on common readings";
    let figure = Figure::new(title, DOUBLE_MM, HEIGHT_MM)
        .grid(models.len())
        .shared_legend();
    let most = clouds.iter().flat_map(|c| &c.readings).map(|r| r.measured);
    let most = 1.05 * most.fold(0.0, f64::max);
    let panels = models.iter().map(|k| panel(&clouds, *k, most));
    Some(Named {
        name: NAME.to_owned(),
        caption: caption(&clouds, &models, most),
        figure: panels.fold(figure, Figure::with),
    })
}

/// One reading, N.
struct Reading {
    measured: f64,
    /// By the models of the first page.
    predicted: [f64; SHOWN.len()],
}

/// The common readings of one group.
struct Cloud {
    name: String,
    simulated: bool,
    /// Which of the models answer.
    answers: [bool; SHOWN.len()],
    readings: Vec<Reading>,
}

impl Cloud {
    fn new(input: &ReportInput, group: &GroupInput) -> Self {
        let of = &group.fit.group;
        let columns = SHOWN.map(|model| column(&input.predicted, model));
        let is_own = |row: &Row| {
            is_usable(row)
                && row.campaign == of.campaign
                && row.diameter_mm.round() as u32 == of.diameter_mm
        };
        let own = input.rows.iter().enumerate().filter(|(_, row)| is_own(row));
        let readings = own.map(|(k, row)| Reading {
            measured: row.force_n,
            predicted: columns.map(|column| column.map_or(f64::NAN, |c| c[k])),
        });
        let mut readings: Vec<Reading> = readings.collect();
        let mut answers = [false; SHOWN.len()];
        for (k, answers) in answers.iter_mut().enumerate() {
            *answers = readings.iter().any(|r| r.predicted[k].is_finite());
        }
        let is_common = |r: &Reading| {
            let both = r.predicted.iter().zip(answers);
            both.filter(|(_, answers)| *answers)
                .all(|(force, _)| force.is_finite())
        };
        readings.retain(is_common);
        Self {
            name: format!("{}, {} mm", plain(&of.campaign), of.diameter_mm),
            simulated: of.simulated,
            answers,
            readings,
        }
    }
}

/// What a model predicts of all rows; the new one where it has not seen the specimen.
fn column<'a>(columns: &'a Predicted, model: &str) -> Option<&'a Vec<f64>> {
    let model = if model == NEW { "new_unseen" } else { model };
    columns.get(&predicted(model))
}

fn panel(clouds: &[Cloud], model: usize, most: f64) -> Panel {
    let axis = |name: &str| Axis::new(name).fixed(0.0, most);
    let panel = Panel::new(axis("Predicted (N)"), axis("Measured (N)"))
        .title(model_name(SHOWN[model], SHOWN[model]))
        .with(Layer::identity(""));
    let all = clouds.iter().enumerate();
    all.fold(panel, |panel, (k, cloud)| {
        let (ink, shape, _) = look(k);
        let points = cloud
            .readings
            .iter()
            .map(|r| (r.predicted[model], r.measured));
        let points = points.filter(|p| p.0.is_finite()).collect();
        panel.with(Series::marks(
            &cloud.name,
            points,
            Mark::open(shape, ink).wide(0.8),
        ))
    })
}

fn caption(clouds: &[Cloud], models: &[usize], most: f64) -> String {
    let simulated = if clouds.iter().any(|c| c.simulated) {
        "Simulated. "
    } else {
        ""
    };
    let counts: Vec<String> = clouds
        .iter()
        .map(|c| c.readings.len().to_string())
        .collect();
    let how = if SHOWN[models[0]] == NEW {
        " The fitted new model predicts every specimen from the others."
    } else {
        ""
    };
    let beyond = |c: &Cloud| {
        let predicted = c.readings.iter().flat_map(|r| &r.predicted);
        predicted.filter(|force| **force > most).count()
    };
    let beyond: usize = clouds.iter().map(beyond).sum();
    let beyond = if beyond > 0 {
        format!(
            " {beyond} predictions above {} N lie outside.",
            number(most, 0)
        )
    } else {
        String::new()
    };
    format!(
        "{simulated}Measured against predicted force on the common readings of each group ({}); on the line both agree.{how}{beyond}",
        listed(&counts)
    )
}
