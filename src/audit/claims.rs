//! The papers' numeric claims, as data: the TOML files below `claims/`, one a section of a paper.
//!
//! Strict: an unknown key, an id used twice, a name that no claim has, a claim that says nothing of how it is recomputed, or a circle
//! of recomputations is an error. Nothing in the code of the audit knows a particular claim.

use super::expression::Expression;
use super::printed::Printed;
use serde::Deserialize;
use std::collections::BTreeSet;
use std::sync::LazyLock;

/// The embedded files, in the order of the report: name and text.
pub const SOURCES: &[(&str, &str)] = &[
    (
        "force-1-background.toml",
        include_str!("claims/force-1-background.toml"),
    ),
    (
        "force-2-methods.toml",
        include_str!("claims/force-2-methods.toml"),
    ),
    (
        "force-3-maximum-force.toml",
        include_str!("claims/force-3-maximum-force.toml"),
    ),
    (
        "force-4-surface.toml",
        include_str!("claims/force-4-surface.toml"),
    ),
    (
        "force-5-discussion.toml",
        include_str!("claims/force-5-discussion.toml"),
    ),
    (
        "force-6-table-1.toml",
        include_str!("claims/force-6-table-1.toml"),
    ),
    (
        "force-7-table-2.toml",
        include_str!("claims/force-7-table-2.toml"),
    ),
    (
        "force-8-comparison.toml",
        include_str!("claims/force-8-comparison.toml"),
    ),
    (
        "knee-1-actuators.toml",
        include_str!("claims/knee-1-actuators.toml"),
    ),
    (
        "knee-2-force-fits.toml",
        include_str!("claims/knee-2-force-fits.toml"),
    ),
];

/// The embedded claims.
///
/// The files are part of the program and a unit test parses them, so that a mistake in them cannot reach a user.
pub static EMBEDDED: LazyLock<ClaimList> =
    LazyLock::new(|| ClaimList::parse(SOURCES).expect("the embedded claims are valid"));

/// One file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Paper and section, as a heading.
    pub title: String,
    /// The paper, in one word.
    pub paper: String,
    /// Its claims, in the order of the text.
    #[serde(default, rename = "claim")]
    pub claims: Vec<Claim>,
    /// The fits whose statistics are claimed.
    #[serde(default, rename = "fit")]
    pub fits: Vec<Fit>,
    /// Expressions that must agree.
    #[serde(default, rename = "pair")]
    pub pairs: Vec<Pair>,
}

/// One number that a paper prints.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// Unique name, by which expressions refer to it.
    pub id: String,
    /// Equation, table cell or paragraph.
    pub at: String,
    /// The words or the cell, shortened.
    pub quote: String,
    /// The number, in `unit`.
    pub printed: Printed,
    /// Its unit; empty for pure numbers.
    #[serde(default)]
    pub unit: String,
    /// What the paper says of the recomputed number.
    #[serde(default)]
    pub relation: Relation,
    /// How far the recomputed number may lie from it, where the text says "about"; half a unit of the last digit otherwise.
    pub within: Option<f64>,
    /// What it is the value of, where other places give that too, in the same unit.
    pub quantity: Option<String>,
    /// How it is recomputed.
    pub recompute: Option<Expression>,
    /// Why it cannot be.
    pub cannot: Option<Cannot>,
    /// Something to be shown beside a number that cannot be recomputed.
    pub beside: Option<Expression>,
    /// Which statistic of which fit it is.
    pub statistic: Option<Statistic>,
    /// Which model's error at which length it is.
    pub error_of: Option<ErrorOf>,
    /// Values that it rests on, of quantities for which a paper states ranges.
    #[serde(default)]
    pub uses: Vec<Use>,
    /// Which end of a stated range it is.
    pub bounds: Option<Bound>,
}

impl Claim {
    /// How far a recomputed number may lie from it.
    pub fn tolerance(&self) -> f64 {
        self.within.unwrap_or(self.printed.half_unit)
    }
}

/// What a paper says of a recomputed number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Relation {
    /// It is the printed one.
    #[default]
    Equal,
    /// It is not more.
    AtMost,
}

/// Why a number cannot be recomputed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cannot {
    /// A reading.
    Measured,
    /// A choice.
    Setting,
    /// From another work.
    Cited,
    /// Asked of the Festo tool.
    Queried,
    /// A fit.
    Fitted,
    /// A construction.
    Designed,
}

impl Cannot {
    /// The reason, for a reader.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Measured => "a measurement; the authors' data are not at hand",
            Self::Setting => "a setting or choice of the experiment",
            Self::Cited => "quoted from another work",
            Self::Queried => {
                "an answer of the Festo tool at that length; the digitised curves know no length"
            }
            Self::Fitted => "fitted to the authors' own points, which are not at hand",
            Self::Designed => "from the solid model of the end caps",
        }
    }
}

/// A statistic of a fit.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Statistic {
    /// Id of the fit.
    pub fit: String,
    /// On which rows.
    pub split: Split,
    /// Which one.
    pub kind: Kind,
    /// Of which coefficient, where it is of one.
    pub symbol: Option<String>,
}

/// Which rows a statistic is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Split {
    /// Those that were fitted.
    Model,
    /// Those that were kept back.
    Validation,
    /// Others (Table 1: data at 620 kPa, or the Festo tool).
    Comparison,
}

impl Split {
    /// For a reader.
    pub fn name(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Validation => "validation",
            Self::Comparison => "comparison",
        }
    }
}

/// What a statistic says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A coefficient.
    Value,
    /// Lower end of its 95% interval.
    CiLow,
    /// Upper end.
    CiHigh,
    /// Adjusted R2.
    AdjR2,
    /// RMSE.
    Rmse,
    /// Sum of squared errors.
    Sse,
    /// Largest absolute residual.
    MaxError,
}

/// A model's error at one resting length.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorOf {
    /// Model id.
    pub model: String,
    /// Diameter, mm.
    pub diameter_mm: u32,
    /// l_rest, m.
    pub rest_length_m: f64,
}

/// A value that a claim rests on.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Use {
    /// Of which quantity.
    pub quantity: String,
    /// The value, in the unit of the range.
    pub value: f64,
}

/// One end of a range.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bound {
    /// Of which quantity.
    pub quantity: String,
    /// Which end.
    pub end: End,
}

/// An end of a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// The lower one.
    Low,
    /// The upper one.
    High,
}

/// A fit whose statistics a paper prints.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fit {
    /// Unique name.
    pub id: String,
    /// For a reader.
    pub title: String,
    /// The program's id of the equation ([`pipeline_fit::equations`]).
    pub equation: String,
    /// Diameter, mm.
    pub diameter_mm: u32,
    /// How many coefficients it has.
    pub coefficients: usize,
    /// Whether the text says that it was fitted with least-absolute-residual weights.
    #[serde(default)]
    pub lar: bool,
    /// How many rows were fitted, where the paper lets one know.
    pub rows: Option<Expression>,
    /// How many were kept back.
    pub validation_rows: Option<Expression>,
    /// The fit whose validation judges this one too: the same fit in another place.
    pub validated_as: Option<String>,
    /// Between which values the paper says that the fitted quantity lies.
    pub range: Option<(f64, f64)>,
}

/// Two expressions that must agree, such as two printed forms of one equation at one state.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// Unique name.
    pub id: String,
    /// What both are the value of.
    pub what: String,
    /// Where the first stands.
    pub left_at: String,
    /// The first.
    pub left: Expression,
    /// Where the second stands, or what it is.
    pub right_at: String,
    /// The second.
    pub right: Expression,
    /// Unit of both.
    #[serde(default)]
    pub unit: String,
    /// What must hold of the first.
    #[serde(default)]
    pub relation: Relation,
    /// How far they may differ, as a share of the second, beyond the rounding of printed numbers.
    #[serde(default)]
    pub tolerance: f64,
    /// Why they must agree.
    pub because: String,
}

/// All claims.
#[derive(Clone, Debug, PartialEq)]
pub struct ClaimList {
    /// In the order of the report.
    pub sections: Vec<Section>,
}

impl ClaimList {
    /// Reads files, given as names and texts.
    ///
    /// # Errors
    /// What is wrong with the first file or claim that is wrong.
    pub fn parse(sources: &[(&str, &str)]) -> Result<Self, String> {
        let section = |(name, text): &(&str, &str)| {
            toml::from_str(text).map_err(|error| format!("{name}: {error}"))
        };
        let sections = sources.iter().map(section).collect::<Result<_, _>>()?;
        let list = Self { sections };
        list.check().map(|()| list)
    }

    /// Every claim.
    pub fn claims(&self) -> impl Iterator<Item = &Claim> {
        self.sections.iter().flat_map(|s| &s.claims)
    }

    /// Every fit.
    pub fn fits(&self) -> impl Iterator<Item = &Fit> {
        self.sections.iter().flat_map(|s| &s.fits)
    }

    /// Every pair.
    pub fn pairs(&self) -> impl Iterator<Item = &Pair> {
        self.sections.iter().flat_map(|s| &s.pairs)
    }

    /// A claim by its id.
    pub fn claim(&self, id: &str) -> Option<&Claim> {
        self.claims().find(|c| c.id == id)
    }

    /// A fit by its id.
    pub fn fit(&self, id: &str) -> Option<&Fit> {
        self.fits().find(|f| f.id == id)
    }

    /// A statistic of a fit that is not of one coefficient.
    pub fn statistic(&self, fit: &str, split: Split, kind: Kind) -> Option<&Claim> {
        let wanted = |s: &Statistic| s.fit == fit && s.split == split && s.kind == kind;
        self.claims()
            .find(|c| c.statistic.as_ref().is_some_and(wanted))
    }

    fn check(&self) -> Result<(), String> {
        let mut ids = BTreeSet::new();
        for id in self
            .claims()
            .map(|c| &c.id)
            .chain(self.fits().map(|f| &f.id))
        {
            if !ids.insert(id) {
                return Err(format!("the id {id} is used twice"));
            }
        }
        for claim in self.claims() {
            self.check_claim(claim)
                .map_err(|why| format!("claim {}: {why}", claim.id))?;
        }
        let of_fits = self.fits().flat_map(|f| [&f.rows, &f.validation_rows]);
        let of_pairs = self.pairs().flat_map(|p| [&p.left, &p.right]);
        for expression in of_fits.flatten().chain(of_pairs) {
            self.check_names(expression)?;
        }
        Ok(())
    }

    fn check_claim(&self, claim: &Claim) -> Result<(), String> {
        match (&claim.recompute, claim.cannot) {
            (None, None) => return Err("needs `recompute` or `cannot`".into()),
            (Some(_), Some(_)) => return Err("has both `recompute` and `cannot`".into()),
            _ => {}
        }
        if let Some(fit) = claim.statistic.as_ref().map(|s| &s.fit)
            && self.fit(fit).is_none()
        {
            return Err(format!("there is no fit {fit}"));
        }
        for expression in [&claim.recompute, &claim.beside].into_iter().flatten() {
            self.check_names(expression)?;
        }
        self.check_circle(claim, claim, &mut BTreeSet::new())
    }

    fn check_names(&self, expression: &Expression) -> Result<(), String> {
        match expression
            .claims()
            .iter()
            .find(|id| self.claim(id).is_none())
        {
            Some(id) => Err(format!("\"{}\": there is no claim {id}", expression.text)),
            None => Ok(()),
        }
    }

    fn check_circle<'a>(
        &'a self,
        from: &Claim,
        at: &'a Claim,
        seen: &mut BTreeSet<&'a str>,
    ) -> Result<(), String> {
        for id in at.recompute.iter().flat_map(Expression::claims) {
            if id == from.id {
                return Err(format!("is recomputed from itself, through {}", at.id));
            }
            if let Some(next) = self.claim(id).filter(|_| seen.insert(id)) {
                self.check_circle(from, next, seen)?;
            }
        }
        Ok(())
    }
}
