//! `pipeline design`: the shortest muscle that meets a curve of force or torque.

use crate::args::DerivedArgs;
use crate::columns::{Align, aligned};
use crate::design_curve::{self, Quantities, Read};
use crate::predict_leg::{MountArgs, knee, leg};
use crate::print::{line, print_json};
use crate::{DONE, laws, predict, values};
use pipeline_base::error::{Error, Result};
use pipeline_base::units::Quantity;
use pipeline_compare::NEW;
use pipeline_fit::GroupFit;
use pipeline_mechanics::knee::Knee;
use pipeline_predict::design::{self, AtPoint, Curve, Design, Joint, Surety, Terms};
use pipeline_predict::law::choose;
use pipeline_report::figures::design as drawing;
use pipeline_report::tables::prediction as tables;
use serde_json::json;
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Exit code where no muscle meets the curve.
const UNMET: u8 = 1;

/// Arguments of `design`.
#[derive(Debug, clap::Args)]
pub struct DesignArgs {
    /// The curve, with a header: contraction,force_n; travel_mm,force_n; or angle_deg,torque_nm
    pub curve: PathBuf,
    /// Gauge pressure
    #[arg(long, value_name = "PRESSURE", default_value = "620kPa")]
    pub pressure: String,
    /// Contraction of the free muscle at 620 kPa [default: the mean of the fitted specimens]
    #[arg(long, value_name = "FRACTION")]
    pub contraction_620: Option<String>,
    /// This diameter only, mm [default: every one that was measured]
    #[arg(long, value_name = "MM")]
    pub diameter: Option<String>,
    /// Campaign whose fit is used [default: as for `predict`]
    #[arg(long, value_name = "ID")]
    pub campaign: Option<String>,
    /// Meet the curve with the law itself, as half of the muscles do, instead of the lower end of the interval
    #[arg(long)]
    pub nominal: bool,
    /// How well lengths are known, as a standard deviation [default: as lengths are set on the rig]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub length_sd: Option<String>,
    /// For a torque curve: the leg (pinned, biomimetic, or a file that describes one)
    #[arg(long, value_name = "NAME|FILE")]
    pub knee: Option<String>,
    /// How it is built in
    #[command(flatten)]
    pub mount: MountArgs,
    /// Where an earlier run left fits.json and mixed_laws.json
    #[command(flatten)]
    pub cache: DerivedArgs,
    /// Write the muscles at every point as CSV
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Draw the curve and the muscles (.svg, .pdf or .png)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Print everything as JSON
    #[arg(long)]
    pub json: bool,
}

/// Finds the muscles, and prints or writes what was asked for.
pub fn command(args: &DesignArgs) -> Result<u8> {
    let places = args.cache.places()?;
    places.check_outside_raw(args.csv.as_deref(), "--csv")?;
    places.check_outside_raw(args.plot.as_deref(), "--plot")?;
    let read = design_curve::read(&args.curve)?;
    let leg = leg_of(args, read.quantities)?;
    let joint = leg.as_ref().map(|l| joint(args, l)).transpose()?;
    let curve = match (read.quantities, joint) {
        (Quantities::Contraction, _) => Curve::Contraction,
        (Quantities::Travel, _) => Curve::Travel,
        (Quantities::Angle, Some(joint)) => Curve::Angle(joint),
        (Quantities::Angle, None) => return Err(Error::internal("a torque without a joint")),
    };
    let found = designs(args, curve, &read)?;
    if let Some(file) = &args.csv {
        let table = tables::design(&found, read.column(), read.needed(), surety(args));
        predict::write_table(file, &table)?;
    }
    if let Some(file) = &args.plot {
        predict::draw(
            file,
            drawing::figure(&read.label(), read.unit(), read.scale(), &found),
        )?;
    }
    if args.json {
        let pressure = values::quantity("--pressure", &args.pressure, Quantity::Pressure)?;
        print_json(&json!({
            "curve": read.points,
            "pressure_kpa": pressure,
            "met_by": surety(args),
            "shortest": found.iter().position(|d| d.meets),
            "designs": found,
        }))?;
    } else {
        print(args, &read, &found);
    }
    Ok(if found.iter().any(|d| d.meets) {
        DONE
    } else {
        UNMET
    })
}

fn surety(args: &DesignArgs) -> Surety {
    if args.nominal {
        Surety::Law
    } else {
        Surety::Interval
    }
}

/// The leg of a torque; a force has none.
fn leg_of(args: &DesignArgs, quantities: Quantities) -> Result<Option<Knee>> {
    match (quantities, &args.knee) {
        (Quantities::Angle, Some(name)) => knee(name).map(Some),
        (Quantities::Angle, None) => Err(Error::Usage(format!(
            "{} is a torque against an angle, which needs a leg: give --knee, and --route if it has several",
            args.curve.display()
        ))),
        (_, Some(_)) => Err(Error::Usage(format!(
            "--knee is for a torque against an angle, and {} is a force",
            args.curve.display()
        ))),
        (_, None) => Ok(None),
    }
}

fn joint<'a>(args: &DesignArgs, knee: &'a Knee) -> Result<Joint<'a>> {
    let length = |option, text: &str| values::quantity(option, text, Quantity::Length);
    Ok(Joint {
        leg: leg(knee, args.mount.route.as_deref())?,
        fitting_m: length("--fitting", &args.mount.fitting)?,
        tendon_m: length("--tendon", &args.mount.tendon)?,
    })
}

/// One muscle of every diameter, those that meet the curve first, the shortest one first.
fn designs(args: &DesignArgs, curve: Curve, read: &Read) -> Result<Vec<Design>> {
    let derived = args.cache.places()?.derived;
    let laws = laws::of_run(&derived)?;
    let pressure = values::quantity("--pressure", &args.pressure, Quantity::Pressure)?;
    let free = args.contraction_620.as_deref();
    let free = free
        .map(|text| values::fraction("--contraction-620", text))
        .transpose()?;
    let length_sd = args.length_sd.as_deref();
    let length_sd = length_sd.map(|text| values::quantity("--length-sd", text, Quantity::Length));
    let terms = Terms {
        pressure_kpa: pressure,
        surety: surety(args),
        length_sd_m: length_sd.transpose()?,
    };
    let mut found = Vec::new();
    for diameter_mm in diameters(args, &laws.fits)? {
        let choice = choose(&laws, NEW, args.campaign.as_deref(), diameter_mm)?;
        found.push(design::shortest(
            &choice,
            free,
            curve,
            &read.points,
            &terms,
        )?);
    }
    if found.is_empty() {
        return Err(Error::Usage(format!(
            "there are no fits in {}{}: `pipeline run` makes them from sessions",
            derived.display(),
            args.campaign
                .as_ref()
                .map_or_else(String::new, |c| format!(" of a campaign {c}"))
        )));
    }
    let key = |d: &Design| (!d.meets, d.rest_length_m, d.diameter_mm);
    found.sort_by(|a, b| {
        let ((x, l, d), (y, m, e)) = (key(a), key(b));
        x.cmp(&y).then(l.total_cmp(&m)).then(d.cmp(&e))
    });
    Ok(found)
}

/// The diameters with a fit, or the one that was asked for.
fn diameters(args: &DesignArgs, fits: &[GroupFit]) -> Result<BTreeSet<u32>> {
    let asked = args
        .diameter
        .as_deref()
        .map(values::diameter_mm)
        .transpose()?;
    if let Some(diameter) = asked {
        return Ok(BTreeSet::from([diameter.round() as u32]));
    }
    let of_campaign = |f: &&GroupFit| {
        args.campaign
            .as_ref()
            .is_none_or(|c| *c == f.group.campaign)
    };
    Ok(fits
        .iter()
        .filter(of_campaign)
        .map(|f| f.group.diameter_mm)
        .collect())
}

fn print(args: &DesignArgs, read: &Read, found: &[Design]) {
    line(format!(
        "curve    {}: {} points, at {}",
        args.curve.display(),
        read.points.len(),
        args.pressure
    ));
    line(match surety(args) {
        Surety::Interval => {
            "met by   the lower end of the 95% interval for an unmeasured muscle (--nominal: by the law)"
        }
        Surety::Law => "met by   the law, as by half of the muscles",
    });
    line("");
    print_table(read, found);
    print_remarks(args, found);
    let closest = || found.iter().max_by(|a, b| a.margin.total_cmp(&b.margin));
    if let Some(chosen) = found.iter().find(|d| d.meets).or_else(closest) {
        if chosen.points.iter().all(AtPoint::is_opposite) {
            line(
                "no torque of this route has the sign of the curve: torques of flexors are negative, of extensors positive",
            );
        }
        print_points(read, chosen, surety(args));
    }
}

/// The muscle of every diameter.
fn print_table(read: &Read, found: &[Design]) {
    let heads = [
        "⌀ (mm)",
        "l_rest (mm)",
        "",
        &format!("margin ({})", read.unit()),
        "tightest at",
        "model",
    ];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    rows.extend(found.iter().map(|d| {
        vec![
            d.diameter_mm.to_string(),
            format!("{:.0}", 1e3 * d.rest_length_m),
            if d.meets { "meets it" } else { "falls short" }.to_owned(),
            format!("{:+.1}", d.margin),
            read.shown(d.tightest.at),
            d.model.clone(),
        ]
    }));
    let (left, right) = (Align::Left, Align::Right);
    for text in aligned(&rows, &[right, right, left, right, right, left]) {
        line(text);
    }
}

/// Which diameters fall short, and which are judged without an interval.
fn print_remarks(args: &DesignArgs, found: &[Design]) {
    let diameters = |is: &dyn Fn(&Design) -> bool| {
        let those = found.iter().filter(|d| is(d));
        let those: Vec<String> = those.map(|d| format!("{} mm", d.diameter_mm)).collect();
        those.join(" and ")
    };
    let short = diameters(&|d| !d.meets);
    if !short.is_empty() {
        line(format!(
            "falls short: no measured length of {short} meets the curve; the one shown comes closest"
        ));
    }
    let has_no_interval = |d: &Design| {
        let mut pulls = d.points.iter().filter(|p| p.available != 0.0).peekable();
        pulls.peek().is_some() && pulls.all(|p| p.low.is_none())
    };
    let by_law = diameters(&has_no_interval);
    if !args.nominal && !by_law.is_empty() {
        line(format!(
            "no interval for {by_law}: judged by the law itself, which half of the muscles fall short of"
        ));
    }
}

/// The chosen muscle at every point.
fn print_points(read: &Read, chosen: &Design, surety: Surety) {
    let unit = read.unit();
    line("");
    line(format!(
        "{} mm, resting length {:.0} mm, contraction at 620 kPa {:.1}%:",
        chosen.diameter_mm,
        1e3 * chosen.rest_length_m,
        100.0 * chosen.contraction_620.unwrap_or(f64::NAN)
    ));
    let heads = [
        read.label(),
        format!("needed ({unit})"),
        "length (mm)".to_owned(),
        format!("muscle ({unit})"),
        "from".to_owned(),
        "to".to_owned(),
        "margin".to_owned(),
    ];
    let mut rows = vec![heads.to_vec()];
    rows.extend(chosen.points.iter().map(|p| point(read, p, surety)));
    for text in aligned(&rows, &[Align::Right; 7]) {
        line(text);
    }
    let outside: Vec<&AtPoint> = chosen
        .points
        .iter()
        .filter(|p| !p.warnings.is_empty())
        .collect();
    if let Some(first) = outside.first() {
        line(format!(
            "* {} of {} points have warnings:",
            outside.len(),
            chosen.points.len()
        ));
        let warnings: BTreeSet<&String> = outside.iter().flat_map(|p| &p.warnings).collect();
        let shown = if warnings.len() > 3 {
            first.warnings.iter().collect()
        } else {
            warnings
        };
        for warning in shown {
            line(format!("warning: {warning}"));
        }
    }
}

fn point(read: &Read, p: &AtPoint, surety: Surety) -> Vec<String> {
    let star = if p.warnings.is_empty() { "" } else { "*" };
    let end = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.1}"));
    vec![
        read.shown(p.point.at),
        format!("{:.1}", p.point.needed),
        format!("{:.1}", 1e3 * p.length_m),
        format!("{:.1}{star}", p.available),
        end(p.low),
        end(p.high),
        format!("{:+.1}", p.margin(surety)),
    ]
}
