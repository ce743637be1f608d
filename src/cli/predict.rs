//! `pipeline predict`.

use crate::args::ResultArgs;
use crate::places::Places;
use crate::predict_leg::{self, LegArgs};
use crate::{DONE, laws, predict_calibrate, predict_print, summary, values};
use pipeline_base::error::{Error, Result};
use pipeline_base::units::Quantity;
use pipeline_compare::NEW;
use pipeline_diagnose::mixed_law::MixedLaw;
use pipeline_predict::inverse::{self, Wanted};
use pipeline_predict::law::choose;
use pipeline_predict::sweep::{self, Around, Axis, Steps};
use pipeline_predict::{Choice, Contraction, FreeLength, Law, Muscle, Predictor};
use pipeline_report::figures::{Named, files, prediction as drawing};
use pipeline_report::render::Renderer;
use pipeline_report::render::csv::Csv;
use pipeline_report::table::Table;
use pipeline_report::tables::prediction as tables;
use std::path::{Path, PathBuf};

/// Resolution of a PNG plot, dots per inch.
pub const PNG_DPI: f64 = 200.0;

/// What is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Swept {
    /// Gauge pressure
    Pressure,
    /// Contraction
    Contraction,
    /// Resting length, at the same contraction and contraction at 620 kPa
    RestLength,
}

/// Arguments of `predict`.
#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("state").args(["contraction", "length", "relative_contraction"])))]
pub struct PredictArgs {
    /// Nominal diameter, mm: 10, 20 or 40, or one that the last run has fitted
    #[arg(long, value_name = "MM", allow_hyphen_values = true, required_unless_present_any = ["specimen", "calibrate"])]
    pub diameter: Option<String>,
    /// Resting length, clamp to clamp, without pressure
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, required_unless_present_any = ["specimen", "calibrate"])]
    pub rest_length: Option<String>,
    /// A specimen of the last run: its lengths, and its gain as estimated from its readings
    #[arg(long, value_name = "ID", conflicts_with_all = ["diameter", "rest_length", "contracted_length", "contraction_620", "knee"])]
    pub specimen: Option<String>,
    /// Folder of a session with a few readings of the muscle, which need not be in the raw directory; may be given several times
    #[arg(long, value_name = "DIR", conflicts_with_all = ["diameter", "rest_length", "contracted_length", "contraction_620", "knee"])]
    pub calibrate: Vec<PathBuf>,
    /// Free length at 620 kPa
    #[arg(
        long,
        value_name = "LENGTH",
        allow_hyphen_values = true,
        conflicts_with = "contraction_620"
    )]
    pub contracted_length: Option<String>,
    /// Contraction of the free muscle at 620 kPa [default: the mean of the fitted specimens]
    #[arg(long, value_name = "FRACTION", allow_hyphen_values = true)]
    pub contraction_620: Option<String>,
    /// Gauge pressure
    #[arg(long, value_name = "PRESSURE", allow_hyphen_values = true)]
    pub pressure: Option<String>,
    /// Contraction, as a fraction of the resting length
    #[arg(long, value_name = "FRACTION", allow_hyphen_values = true)]
    pub contraction: Option<String>,
    /// Current length, instead of a contraction
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub length: Option<String>,
    /// Contraction as a fraction of that at 620 kPa, instead of a contraction
    #[arg(long, value_name = "FRACTION", allow_hyphen_values = true)]
    pub relative_contraction: Option<String>,
    /// "new" (the mixed model of an earlier run), "new_least_squares" (the plain fit of that run) or the id of a published model
    #[arg(long, value_name = "ID", default_value = "new")]
    pub model: String,
    /// Campaign whose model is used [default: of those with a mixed model, the pool of this diameter, else the one with most specimens]
    #[arg(long, value_name = "ID")]
    pub campaign: Option<String>,
    /// The reading of the rig instead of the force of the muscle: with the rig's effects, its zeros and its noise
    #[arg(long, conflicts_with = "knee")]
    pub as_read: bool,
    /// How well the length is known, as a standard deviation [default: as lengths are set on the rig]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub length_sd: Option<String>,
    /// Where an earlier run left fits.json and mixed_laws.json
    #[command(flatten)]
    pub results: ResultArgs,
    /// The pressure for this force, at a contraction or length
    #[arg(long, value_name = "FORCE", allow_hyphen_values = true, conflicts_with_all = ["pressure", "sweep", "table", "knee", "length_for"])]
    pub pressure_for: Option<String>,
    /// The length for this force, at a pressure
    #[arg(long, value_name = "FORCE", allow_hyphen_values = true, conflicts_with_all = ["state", "sweep", "table", "knee"])]
    pub length_for: Option<String>,
    /// Vary one quantity
    #[arg(long, value_name = "QUANTITY", conflicts_with = "table")]
    pub sweep: Option<Swept>,
    /// First value of the sweep, with its unit
    #[arg(
        long,
        value_name = "VALUE",
        requires = "sweep",
        allow_hyphen_values = true
    )]
    pub from: Option<String>,
    /// Last value of the sweep
    #[arg(
        long,
        value_name = "VALUE",
        requires = "sweep",
        allow_hyphen_values = true
    )]
    pub to: Option<String>,
    /// Step of the sweep
    #[arg(
        long,
        value_name = "VALUE",
        requires = "sweep",
        allow_hyphen_values = true
    )]
    pub step: Option<String>,
    /// A table of contraction by pressure
    #[arg(long)]
    pub table: bool,
    /// Write the sweep or table as CSV
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Draw the sweep or table (.svg, .pdf or .png)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Print everything as JSON
    #[arg(long)]
    pub json: bool,
    /// Where the muscle is built in
    #[command(flatten)]
    pub leg: LegArgs,
}

/// Predicts, and prints or writes what was asked for.
pub fn command(args: &PredictArgs) -> Result<u8> {
    let places = args.results.places()?;
    places.check_outside_raw(args.csv.as_deref(), "--csv")?;
    places.check_outside_raw(args.plot.as_deref(), "--plot")?;
    let read = predict_calibrate::read(args, &places)?;
    let muscle = match &read {
        Some(read) => read.muscle()?,
        None => muscle(args)?,
    };
    let laws = laws::of_run(&places.derived)?;
    let mut choice = choose(
        &laws,
        &args.model,
        args.campaign.as_deref(),
        muscle.diameter_mm,
    )?;
    if read.is_none() {
        choice.why = advised(&choice, &places);
    }
    let mut predictor = Predictor::new(choice, muscle)?;
    if let Ok(fitted) = choose(&laws, NEW, None, muscle.diameter_mm)
        && let Law::Fitted(fitted) = fitted.law
    {
        predictor = predictor.with_specimens_of(fitted.fit);
    }
    if args.as_read {
        predictor = predictor.as_read()?;
    }
    if let Some(read) = read {
        predictor = read.told(predictor, args.model != NEW)?;
    }
    if let Some(text) = &args.length_sd {
        let sd_m = values::quantity("--length-sd", text, Quantity::Length)?;
        predictor = predictor.with_length_sd(sd_m)?;
    }
    if let Some(knee) = &args.leg.knee {
        predict_leg::command(args, knee, &predictor)?;
        return Ok(DONE);
    }
    let around = around(args)?;
    if let Some(wanted) = wanted(args, around)? {
        let (wanted, force_n) = wanted;
        no_file(args, "one answer")?;
        let solved = inverse::solve(&predictor, wanted, force_n)?;
        predict_print::solved(&predictor, wanted, &solved, args.json)?;
        return Ok(DONE);
    }
    match (args.sweep, args.table) {
        (Some(swept), _) => sweep_command(args, predictor, axis(swept), around)?,
        (None, true) => table_command(args, &predictor)?,
        (None, false) => single(args, &predictor, around)?,
    }
    Ok(DONE)
}

/// Why a law was chosen, and that the published coefficients do better, where they do.
fn advised(choice: &Choice, places: &Places) -> String {
    let fitted = match choice.law {
        Law::Fitted(fitted) if fitted.mixed.is_none_or(MixedLaw::has_fitted_law) => fitted,
        _ => return choice.why.clone(),
    };
    let mixed_n = fitted.mixed.and_then(|law| law.unseen_n);
    let advice = summary::better_published(&places.reports, &fitted.fit.group, mixed_n);
    let said = [choice.why.clone(), advice.unwrap_or_default()];
    let said: Vec<String> = said.into_iter().filter(|text| !text.is_empty()).collect();
    said.join("; ")
}

/// What an inverse looks for, and the force, N; none where a force is predicted.
fn wanted(args: &PredictArgs, around: Around) -> Result<Option<(Wanted, f64)>> {
    let force = |option, text: &str| values::quantity(option, text, Quantity::Force);
    if let Some(text) = &args.pressure_for {
        let contraction = around.contraction.ok_or_else(|| {
            missing("a contraction with --pressure-for: give --contraction, --length or --relative-contraction")
        })?;
        let force_n = force("--pressure-for", text)?;
        return Ok(Some((Wanted::Pressure(contraction), force_n)));
    }
    let Some(text) = &args.length_for else {
        return Ok(None);
    };
    let pressure = around.pressure_kpa;
    let pressure =
        pressure.ok_or_else(|| missing("a pressure with --length-for: give --pressure"))?;
    Ok(Some((
        Wanted::Length(pressure),
        force("--length-for", text)?,
    )))
}

fn single(args: &PredictArgs, predictor: &Predictor, around: Around) -> Result<()> {
    no_file(args, "one state")?;
    let contraction = around.contraction.ok_or_else(|| {
        missing("a contraction: give --contraction, --length or --relative-contraction, or --sweep contraction")
    })?;
    let pressure = around
        .pressure_kpa
        .ok_or_else(|| missing("a pressure: give --pressure, or --sweep pressure"))?;
    let answer = predictor.at(contraction, pressure)?;
    predict_print::single(predictor, &answer, args.json)
}

/// One answer fills no file.
fn no_file(args: &PredictArgs, what: &str) -> Result<()> {
    let file = args.csv.as_ref().or(args.plot.as_ref());
    file.map_or(Ok(()), |file| {
        Err(Error::Usage(format!(
            "{what} gives neither a table nor a curve for {}: add --sweep or --table",
            file.display()
        )))
    })
}

fn sweep_command(
    args: &PredictArgs,
    predictor: Predictor,
    axis: Axis,
    around: Around,
) -> Result<()> {
    if axis == Axis::RestLength && predictor.calibrated().is_some() {
        return Err(Error::Usage(
            "readings of a muscle do not apply to one of another length: leave out --specimen and --calibrate with --sweep rest-length"
                .to_owned(),
        ));
    }
    if axis == Axis::RestLength && matches!(around.contraction, Some(Contraction::Length(_))) {
        return Err(Error::Usage(
            "a length is a different contraction at each resting length: give --contraction or --relative-contraction with --sweep rest-length"
                .to_owned(),
        ));
    }
    let given = match axis {
        Axis::Pressure => around.pressure_kpa.map(|_| "--pressure"),
        Axis::Contraction => around.contraction.map(|_| "a contraction"),
        Axis::RestLength => None,
    };
    if let Some(given) = given {
        return Err(Error::Usage(format!(
            "{given} is what the sweep varies: leave it out (--from and --to set the range)"
        )));
    }
    let steps = steps(args, axis, &predictor)?;
    let answers = sweep::sweep(&predictor, axis, &steps.values()?, around)?;
    write_csv(args, &tables::force(&answers))?;
    if let Some(file) = &args.plot {
        let fine = sweep::sweep(&predictor, axis, &steps.fine(), around)?;
        draw(file, drawing::sweep(&predictor, axis, &fine))?;
    }
    predict_print::sweep(&predictor, axis, &answers, args.json)
}

fn table_command(args: &PredictArgs, predictor: &Predictor) -> Result<()> {
    let contractions = sweep::table_contractions(predictor)?;
    let rows = sweep::table(predictor, &contractions)?;
    write_csv(args, &tables::force(rows.iter().flatten()))?;
    if let Some(file) = &args.plot {
        let fine = Steps::usual(Axis::Contraction, predictor).fine();
        let fine = sweep::table(predictor, &fine)?;
        draw(file, drawing::isobars(predictor, &fine))?;
    }
    predict_print::table(predictor, &rows, args.json)
}

fn muscle(args: &PredictArgs) -> Result<Muscle> {
    let length = |option, text: &str| values::quantity(option, text, Quantity::Length);
    let free = match (&args.contracted_length, &args.contraction_620) {
        (Some(text), _) => FreeLength::Length(length("--contracted-length", text)?),
        (None, Some(text)) => FreeLength::Contraction(values::fraction("--contraction-620", text)?),
        (None, None) => FreeLength::Unknown,
    };
    let given = |option, text: &Option<String>| {
        let asked = || missing(&format!("{option}, or --specimen or --calibrate"));
        text.clone().ok_or_else(asked)
    };
    let rest_length = length("--rest-length", &given("--rest-length", &args.rest_length)?)?;
    let diameter = given("--diameter", &args.diameter)?;
    Muscle::new(values::diameter_mm(&diameter)?, rest_length, free)
}

fn around(args: &PredictArgs) -> Result<Around> {
    let given = (&args.contraction, &args.length, &args.relative_contraction);
    let contraction = match given {
        (Some(text), _, _) => Some(Contraction::Fraction(values::fraction(
            "--contraction",
            text,
        )?)),
        (_, Some(text), _) => {
            let length = values::quantity("--length", text, Quantity::Length)?;
            Some(Contraction::Length(length))
        }
        (_, _, Some(text)) => {
            let relative = values::fraction("--relative-contraction", text)?;
            Some(Contraction::Relative(relative))
        }
        _ => None,
    };
    let pressure = args.pressure.as_deref();
    let pressure = pressure.map(|text| values::quantity("--pressure", text, Quantity::Pressure));
    Ok(Around {
        contraction,
        pressure_kpa: pressure.transpose()?,
    })
}

fn axis(swept: Swept) -> Axis {
    match swept {
        Swept::Pressure => Axis::Pressure,
        Swept::Contraction => Axis::Contraction,
        Swept::RestLength => Axis::RestLength,
    }
}

fn steps(args: &PredictArgs, axis: Axis, predictor: &Predictor) -> Result<Steps> {
    let read = |option: &str, text: &Option<String>, usual: f64| match (text, axis) {
        (None, _) => Ok(usual),
        (Some(text), Axis::Pressure) => values::quantity(option, text, Quantity::Pressure),
        (Some(text), Axis::Contraction) => values::fraction(option, text),
        (Some(text), Axis::RestLength) => values::quantity(option, text, Quantity::Length),
    };
    let usual = Steps::usual(axis, predictor);
    Ok(Steps {
        from: read("--from", &args.from, usual.from)?,
        to: read("--to", &args.to, usual.to)?,
        step: read("--step", &args.step, usual.step)?,
    })
}

/// Writes a table where one was asked for.
pub fn write_csv(args: &PredictArgs, table: &Table) -> Result<()> {
    let file = args.csv.as_ref();
    file.map_or(Ok(()), |file| write_table(file, table))
}

/// Writes a table as CSV.
pub(super) fn write_table(file: &Path, table: &Table) -> Result<()> {
    std::fs::write(file, Csv.render(table)).map_err(Error::io("write", file))
}

/// Draws a figure in the format that the name of the file asks for.
pub fn draw(file: &Path, figure: Named) -> Result<()> {
    let extension = file
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    let all = files(&figure.draw()?, PNG_DPI)?;
    let wanted = all
        .into_iter()
        .find(|(name, _)| name.ends_with(&format!(".{extension}")));
    match wanted {
        Some((_, bytes)) => std::fs::write(file, bytes).map_err(Error::io("write", file)),
        None => Err(Error::Usage(format!(
            "--plot {}: the name must end with .svg, .pdf or .png",
            file.display()
        ))),
    }
}

fn missing(what: &str) -> Error {
    Error::Usage(format!("there has to be {what}"))
}
