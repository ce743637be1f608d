//! Small embedded tables in CSV: lines that begin with `#` name the source, the first other line the columns.

use pipeline_base::diagnostics::Diagnostic;

/// A table of text cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    file: &'static str,
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// The embedded tables, by name.
const TABLES: &[(&str, &str)] = &[
    ("table1.csv", include_str!("data/table1.csv")),
    (
        "bracket_points.csv",
        include_str!("data/bracket_points.csv"),
    ),
    (
        "measurers_by_hand.csv",
        include_str!("data/measurers_by_hand.csv"),
    ),
    (
        "opensim_bifemsh_moment_arm.csv",
        include_str!("data/opensim_bifemsh_moment_arm.csv"),
    ),
    (
        "opensim_vasti_moment_arm.csv",
        include_str!("data/opensim_vasti_moment_arm.csv"),
    ),
    (
        "opensim_vasti_torque.csv",
        include_str!("data/opensim_vasti_torque.csv"),
    ),
    (
        "human_torque_target_bifemsh.csv",
        include_str!("data/human_torque_target_bifemsh.csv"),
    ),
    (
        "human_torque_target_vasti.csv",
        include_str!("data/human_torque_target_vasti.csv"),
    ),
];

/// Names of the embedded tables.
pub fn names() -> Vec<&'static str> {
    TABLES.iter().map(|(name, _)| *name).collect()
}

/// An embedded table: `table1.csv` and `bracket_points.csv` (coordinates in m), `measurers_by_hand.csv` (errors in N.m), `opensim_*` and `human_torque_target_*` (over `knee_angle_deg`;
/// arms in m, torques in N.m, flexion negative). The head of each file under `src/mechanics/knee/data` has its source.
///
/// # Errors
/// If there is no such table, or a line has not as many cells as there are columns.
pub fn table(name: &str) -> Result<Table, Diagnostic> {
    let Some((file, text)) = TABLES.iter().find(|(known, _)| *known == name) else {
        return Err(Diagnostic::error(
            "src/mechanics/knee/data",
            name,
            format!("one of {}", names().join(", ")),
            "add the file to the list in src/mechanics/knee/data.rs",
        ));
    };
    parse(file, text)
}

fn parse(file: &'static str, text: &str) -> Result<Table, Diagnostic> {
    let mut lines = text.lines().zip(1..).filter(|(l, _)| !l.starts_with('#'));
    let columns = lines.next().map_or(Vec::new(), |(line, _)| cells(line));
    let rows = lines
        .map(|(line, number)| {
            let row = cells(line);
            if row.len() == columns.len() {
                return Ok(row);
            }
            let found = format!("{} cells", row.len());
            let expected = format!("{} cells, one a column", columns.len());
            Err(Diagnostic::error(file, found, expected, "correct the line").at_row(number))
        })
        .collect::<Result<_, _>>()?;
    Ok(Table {
        file,
        columns,
        rows,
    })
}

/// The cells of a line; a comma between double quotes does not part them.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            c => cells.last_mut().into_iter().for_each(|cell| cell.push(c)),
        }
    }
    cells
}

impl Table {
    /// A column as text.
    ///
    /// # Errors
    /// If there is no such column.
    pub fn text(&self, column: &str) -> Result<Vec<&str>, Diagnostic> {
        let Some(k) = self.columns.iter().position(|c| c == column) else {
            return Err(Diagnostic::error(
                self.file,
                column,
                format!("one of {}", self.columns.join(", ")),
                "ask for a column that the table has",
            ));
        };
        Ok(self.rows.iter().map(|row| row[k].as_str()).collect())
    }

    /// A column as numbers; an empty cell is NaN.
    ///
    /// # Errors
    /// If there is no such column, or a cell is no number.
    pub fn numbers(&self, column: &str) -> Result<Vec<f64>, Diagnostic> {
        let number = |text: &str| match text {
            "" => Ok(f64::NAN),
            _ => text.parse().map_err(|_| {
                Diagnostic::error(self.file, text, "a number", "correct the cell").in_column(column)
            }),
        };
        self.text(column)?.into_iter().map(number).collect()
    }
}
