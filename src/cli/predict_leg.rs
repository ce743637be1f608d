//! `pipeline predict --knee`: the torque of a muscle in a leg, beside a human muscle.

use crate::columns::{Align, aligned};
use crate::predict::{PredictArgs, draw, write_csv};
use crate::print::{line, print_json};
use crate::{predict_head, predict_print, values};
use pipeline_base::diagnostics::nearest;
use pipeline_base::error::{Error, Result};
use pipeline_base::units::Quantity;
use pipeline_mechanics::knee::{Knee, Leg, choice, human};
use pipeline_predict::Predictor;
use pipeline_predict::torque::{self, AtAngle, Built, Target};
use pipeline_report::figures::leg_prediction as drawing;
use pipeline_report::tables::prediction as tables;
use serde_json::json;

/// Steps of the printed table, of the CSV and of the plot, degrees.
const PRINTED_DEG: f64 = 10.0;
const FINE_DEG: f64 = 1.0;

/// Arguments that say how a muscle is built into a leg.
#[derive(Debug, clap::Args)]
pub struct MountArgs {
    /// The route over the knee [default: the only one]
    #[arg(long, value_name = "NAME", requires = "knee")]
    pub route: Option<String>,
    /// Length of one end fitting
    #[arg(
        long,
        value_name = "LENGTH",
        default_value = "25.4mm",
        requires = "knee"
    )]
    pub fitting: String,
    /// Length of the tendon
    #[arg(long, value_name = "LENGTH", default_value = "0mm", requires = "knee")]
    pub tendon: String,
}

/// Arguments that say where the muscle is built in.
#[derive(Debug, clap::Args)]
pub struct LegArgs {
    /// Torque about a knee instead of force: pinned, biomimetic, or a file that describes a leg (TOML)
    #[arg(long, value_name = "NAME|FILE", conflicts_with_all = ["sweep", "table", "state"])]
    pub knee: Option<String>,
    /// How it is built in
    #[command(flatten)]
    pub mount: MountArgs,
    /// The human muscle to match: bifemsh, vasti, vas_int, vas_lat, vas_med [default: by the direction of the pull]
    #[arg(long, value_name = "NAME", requires = "knee")]
    pub human: Option<String>,
}

/// Predicts over the range of the knee, and prints or writes what was asked for.
pub fn command(args: &PredictArgs, name: &str, predictor: &Predictor) -> Result<()> {
    let knee = knee(name)?;
    let leg = leg(&knee, args.leg.mount.route.as_deref())?;
    let length = |option, text: &str| values::quantity(option, text, Quantity::Length);
    let built = Built {
        leg,
        fitting_m: length("--fitting", &args.leg.mount.fitting)?,
        tendon_m: length("--tendon", &args.leg.mount.tendon)?,
    };
    let target = match &args.leg.human {
        Some(name) => Some(target(name)?),
        None => Target::usual(&leg),
    };
    let pressure = args
        .pressure
        .as_deref()
        .ok_or_else(|| Error::Usage("--knee needs a pressure: give --pressure".to_owned()))?;
    let pressure = values::quantity("--pressure", pressure, Quantity::Pressure)?;
    let over = |step| torque::over_the_range(predictor, &built, target.as_ref(), pressure, step);
    let fine = over(FINE_DEG)?;
    write_csv(args, &tables::torque(&fine))?;
    if let Some(file) = &args.plot {
        let human = target.as_ref().map(|t| t.name.as_str());
        draw(
            file,
            drawing::figure(predictor, &built, human, pressure, &fine),
        )?;
    }
    let human = target.as_ref().map(|t| t.name.as_str());
    if args.json {
        let value = json!({
            "knee": knee.name,
            "route": leg.route.name,
            "pressure_kpa": pressure,
            "human": human,
            "met_deg": torque::met(&fine),
            "met_within_data_deg": torque::met_within_data(&fine),
            "falls_short": torque::shortest(&fine),
            "angles": fine,
        });
        return print_json(&predict_print::with_head(predictor, "torque", value));
    }
    predict_head::head(predictor);
    print_leg(&knee, &built, pressure);
    print_rows(&over(PRINTED_DEG)?, human);
    print_verdict(&fine, human);
    Ok(())
}

/// A shipped knee, or one that a file describes.
pub(super) fn knee(name: &str) -> Result<Knee> {
    if let Some(knee) = choice::named(name) {
        return Ok(knee);
    }
    let text = std::fs::read_to_string(name).map_err(|e| {
        Error::Usage(format!(
            "--knee {name} is not a shipped knee (pinned, biomimetic, gait2392), and cannot be read as a file: {e}"
        ))
    })?;
    Knee::parse("described", name, &text).map_err(Error::Config)
}

/// A route of a knee.
pub(super) fn leg<'a>(knee: &'a Knee, route: Option<&str>) -> Result<Leg<'a>> {
    let names: Vec<&str> = knee.routes.iter().map(|r| r.name.as_str()).collect();
    let wanted = match (route, names.as_slice()) {
        (Some(route), _) => route,
        (None, [only]) => only,
        (None, _) => {
            return Err(Error::Usage(format!(
                "the knee has several routes: give --route with one of {}",
                names.join(", ")
            )));
        }
    };
    knee.leg(wanted).ok_or_else(|| {
        let hint = nearest(wanted, names.iter().copied())
            .map_or_else(String::new, |near| format!("; did you mean {near}?"));
        Error::Usage(format!(
            "the knee has no route {wanted}, only {}{hint}",
            names.join(", ")
        ))
    })
}

fn target(name: &str) -> Result<Target> {
    Target::named(name).ok_or_else(|| {
        let hint = nearest(name, human::NAMES)
            .map_or_else(String::new, |near| format!("; did you mean {near}?"));
        Error::Usage(format!(
            "--human {name} is not one of {}{hint}",
            human::NAMES.join(", ")
        ))
    })
}

fn print_leg(knee: &Knee, built: &Built, pressure_kpa: f64) {
    line(format!(
        "leg      {} knee, route {}: fittings of {:.1} mm, tendon {:.1} mm; rigid",
        knee.name,
        built.leg.route.name,
        1e3 * built.fitting_m,
        1e3 * built.tendon_m
    ));
    line(format!("state    {pressure_kpa:.1} kPa"));
    line("");
}

fn print_rows(found: &[AtAngle], human: Option<&str>) {
    let with_intervals = found.iter().any(|a| a.interval_nm.is_some());
    let mut heads = vec![
        "angle (deg)",
        "length (mm)",
        "eps*",
        "arm (mm)",
        "force (N)",
        "torque (N.m)",
    ];
    let mut columns = vec![Align::Right; heads.len() + 1];
    if with_intervals {
        heads.extend(["from", "to"]);
        columns.extend([Align::Right; 2]);
    }
    heads.extend([human.unwrap_or("human"), ""]);
    columns.push(Align::Left);
    let mut rows: Vec<Vec<String>> = vec![heads.into_iter().map(str::to_owned).collect()];
    rows.extend(found.iter().map(|a| row(a, with_intervals)));
    for text in aligned(&rows, &columns) {
        line(text);
    }
    line("");
    if with_intervals {
        line("from, to: 95% interval for an unmeasured muscle on a rigid leg");
    }
}

fn row(a: &AtAngle, with_interval: bool) -> Vec<String> {
    let number =
        |x: Option<f64>, digits: usize| x.map_or_else(String::new, |x| format!("{x:.digits$}"));
    let star = if a.warnings.is_empty() { "" } else { "*" };
    let force = a.force_n.map(|f| format!("{f:.1}{star}"));
    let mut cells = vec![
        format!("{:.1}", a.angle_deg),
        format!("{:.1}", 1e3 * a.length_m),
        number(a.contraction_rel, 2),
        format!("{:.1}", 1e3 * a.arm_m),
        force.unwrap_or_else(|| "none".to_owned()),
        number(a.torque_nm, 2),
    ];
    if with_interval {
        cells.push(number(a.interval_nm.map(|i| i.0), 2));
        cells.push(number(a.interval_nm.map(|i| i.1), 2));
    }
    let short = if a.meets == Some(false) { "short" } else { "" };
    cells.extend([number(a.human_nm, 2), short.to_owned()]);
    cells
}

/// Whether a human muscle is met, where not, and where only a prediction beyond what was measured says so.
fn verdict(fine: &[AtAngle], human: &str) -> String {
    if fine.iter().all(|a| a.meets.is_none()) {
        return format!(
            "meets {human}: unknown, because at no angle are both torques known; check the lengths (in m) and the reasons below"
        );
    }
    let words = |met: Vec<(f64, f64)>| {
        let stretches: Vec<String> = met
            .iter()
            .map(|(a, b)| format!("{a:.0} to {b:.0} deg"))
            .collect();
        stretches.join(" and ")
    };
    let (all, measured) = (
        words(torque::met(fine)),
        words(torque::met_within_data(fine)),
    );
    let within = if all == measured || all.is_empty() {
        String::new()
    } else if measured.is_empty() {
        "; all of that is extrapolated (*)".to_owned()
    } else {
        format!("; within the measured range at {measured}")
    };
    match (all.is_empty(), torque::shortest(fine)) {
        (_, None) => format!("meets {human} wherever both are known{within}"),
        (true, Some((at, missing))) => {
            format!("meets {human} nowhere: falls short by {missing:.1} N.m at {at:.0} deg")
        }
        (false, Some((at, missing))) => {
            format!(
                "meets {human} at {all}{within}; falls furthest short at {at:.0} deg, by {missing:.1} N.m"
            )
        }
    }
}

/// Whether the human muscle is met, and where not; what was extrapolated.
fn print_verdict(fine: &[AtAngle], human: Option<&str>) {
    if let Some(human) = human {
        line(verdict(fine, human));
    }
    let outside: Vec<&AtAngle> = fine.iter().filter(|a| !a.warnings.is_empty()).collect();
    if let (Some(first), Some(last)) = (outside.first(), outside.last()) {
        line(format!(
            "* {} of {} angles lie outside the measured or permitted range:",
            outside.len(),
            fine.len()
        ));
        let mut said = first.warnings.clone();
        let others = last.warnings.iter();
        said.extend(others.filter(|w| !first.warnings.contains(w)).cloned());
        for warning in said {
            line(format!("warning: {warning}"));
        }
    }
    let inferred = fine.iter().find_map(|a| Some((a, a.inferred.as_ref()?)));
    if let Some((at, why)) = inferred {
        line(format!("warning: as at {:.0} deg, {why}", at.angle_deg));
    }
}
