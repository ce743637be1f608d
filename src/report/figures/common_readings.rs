//! Measured against predicted force on common readings, the new model beside those with which it is ranked: the figure of the first page.

use crate::figures::Named;
use crate::figures::formatting::{listed, plain};
use crate::input::{GroupInput, ReportInput};
use crate::opening::SHOWN;
use crate::plot::{
    Anchor, Axis, DOUBLE_MM, Figure, Layer, Level, Mark, Panel, Place, Series, Side, look,
};
use crate::predictions::Predicted;
use crate::wording::name::model_name;
use pipeline_base::columns::predicted;
use pipeline_base::row::Row;
use pipeline_compare::NEW;
use pipeline_fit::is_usable;

/// Name of its files.
pub const NAME: &str = "common-readings";
/// Of a row of panels, and what the legend takes above all.
const ROW_MM: f64 = 36.0;
const ABOVE_MM: f64 = 6.0;
/// Groups with a mark of their own: those of most specimens, then readings.
const MOST_GROUPS: usize = 6;
/// Rows of panels.
const MOST_DIAMETERS: usize = 2;

/// The figure, one row of panels a diameter; none where no reading is common to the new model and another one. Groups are those that were measured,
/// where there are any, and no pools, whose readings are those of their members.
pub fn figure(input: &ReportInput) -> Option<Named> {
    let groups = input.with_section().map(|(g, _)| g);
    let mut groups: Vec<&GroupInput> = groups.filter(|g| g.fit.group.members.len() == 1).collect();
    let measured = groups.iter().any(|g| !g.fit.group.simulated);
    groups.retain(|g| g.fit.group.simulated != measured);
    groups.sort_by_key(|g| std::cmp::Reverse((g.fit.specimens.len(), g.fit.rows)));
    groups.truncate(MOST_GROUPS);
    let clouds = groups.into_iter().map(|g| Cloud::new(input, g));
    let mut clouds: Vec<Cloud> = clouds.filter(|c| !c.readings.is_empty()).collect();
    let mut diameters: Vec<u32> = Vec::new();
    for cloud in &clouds {
        if !diameters.contains(&cloud.diameter_mm) {
            diameters.push(cloud.diameter_mm);
        }
    }
    diameters.truncate(MOST_DIAMETERS);
    diameters.sort_unstable();
    clouds.retain(|c| diameters.contains(&c.diameter_mm));
    let has_some = |k: &usize| clouds.iter().any(|c| c.answers[*k]);
    let models: Vec<usize> = (0..SHOWN.len()).filter(has_some).collect();
    if models.len() < 2 {
        return None;
    }
    let title = "Measured against predicted force on common readings";
    let height = ABOVE_MM + ROW_MM * diameters.len() as f64;
    let figure = Figure::new(title, DOUBLE_MM, height)
        .grid(models.len())
        .shared_legend();
    let panels = diameters.iter().flat_map(|diameter| {
        let clouds = &clouds;
        models
            .iter()
            .map(move |model| panel(clouds, *diameter, *model))
    });
    Some(Named {
        name: NAME.to_owned(),
        caption: caption(&clouds, &models),
        figure: panels.fold(figure, Figure::with),
    })
}

/// The largest force of a diameter's panels: a little more than was measured.
fn most(clouds: &[Cloud], diameter_mm: u32) -> f64 {
    let own = clouds.iter().filter(|c| c.diameter_mm == diameter_mm);
    let measured = own.flat_map(|c| &c.readings).map(|r| r.measured);
    1.1 * measured.fold(0.0, f64::max)
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
    diameter_mm: u32,
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
            diameter_mm: of.diameter_mm,
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

fn panel(clouds: &[Cloud], diameter_mm: u32, model: usize) -> Panel {
    let most = most(clouds, diameter_mm);
    let axis = |name: &str| Axis::new(name).fixed(0.0, most);
    let panel = Panel::new(axis("Predicted (N)"), axis("Measured (N)"))
        .title(model_name(SHOWN[model], SHOWN[model]))
        .with(Layer::identity(""));
    let all = clouds.iter().enumerate();
    let mut own = all
        .filter(|(_, c)| c.diameter_mm == diameter_mm && c.answers[model])
        .peekable();
    if own.peek().is_none() {
        return panel.with(Layer::Text {
            text: "no coefficients".to_owned(),
            place: Place::Data(0.05 * most, 0.9 * most),
            anchor: Anchor::new(Side::Left, Level::Center),
        });
    }
    own.fold(panel, |panel, (k, cloud)| {
        let (ink, shape, _) = look(k);
        let points = cloud
            .readings
            .iter()
            .map(|r| (r.predicted[model], r.measured));
        let mark = Mark::open(shape, ink).wide(0.8);
        panel.with(Series::marks(&cloud.name, points.collect(), mark))
    })
}

fn caption(clouds: &[Cloud], models: &[usize]) -> String {
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
        let most = most(clouds, c.diameter_mm);
        let predicted = c.readings.iter().flat_map(|r| &r.predicted);
        predicted.filter(|force| **force > most).count()
    };
    let beyond: usize = clouds.iter().map(beyond).sum();
    let beyond = if beyond > 0 {
        format!(" {beyond} predictions lie beyond the panels.")
    } else {
        String::new()
    };
    format!(
        "{simulated}Measured against predicted force on the common readings of each group ({}); on the line both agree.{how}{beyond}",
        listed(&counts)
    )
}
