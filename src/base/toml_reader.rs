//! Strict reading of TOML: every mistake of a file in one pass, each with its line, its key and what to write instead.
//!
//! Serde stops at the first mistake and knows no domain; a laboratory that writes forty `session.toml` files by hand wants all of
//! them. A [`Reader`] collects; the caller asks for typed values and at the end closes each table, which reports unknown keys with
//! the nearest known one.

use crate::diagnostics::{Diagnostic, nearest};
use crate::toml_syntax::{self, line_of};
use std::cell::RefCell;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// The mistakes found so far in one TOML file.
pub struct Reader<'a> {
    file: &'a str,
    text: &'a str,
    diagnostics: RefCell<Vec<Diagnostic>>,
}

/// One table of the file, with its dotted path and the keys that were asked for.
pub struct Section<'r, 'a> {
    reader: &'r Reader<'a>,
    path: String,
    line: u64,
    entries: &'r DeTable<'a>,
    known: RefCell<Vec<&'static str>>,
    /// The same table of another file, for keys that this one does not have.
    defaults: Option<Box<Section<'r, 'a>>>,
}

/// A value with the place where it stands.
pub struct Entry<'r, 'a> {
    reader: &'r Reader<'a>,
    /// Dotted path of the key.
    pub path: String,
    /// Line, counted from 1.
    pub line: u64,
    value: &'r DeValue<'a>,
    /// What another file has for the key; of tables it completes this one.
    defaults: Option<Box<Entry<'r, 'a>>>,
}

/// Parses the text; a syntax error becomes one diagnostic.
///
/// # Errors
/// The place and the reason of the first syntax error.
pub fn parse<'a>(file: &str, text: &'a str) -> Result<DeTable<'a>, Diagnostic> {
    let parsed = DeTable::parse(text).map(Spanned::into_inner);
    parsed.map_err(|_| {
        let defect = toml_syntax::defect(file, text);
        defect.unwrap_or_else(|| Diagnostic::error(file, "no TOML", "TOML", "correct the file"))
    })
}

/// The line of a top-level key, counted from 1; none where the text has no such key or is not TOML.
pub fn line_of_key(text: &str, key: &str) -> Option<u64> {
    let table = DeTable::parse(text).ok()?;
    let (found, _) = table.get_ref().get_key_value(key)?;
    Some(line_of(text, found.span().start))
}

impl<'a> Reader<'a> {
    /// A reader of `text`, which messages call `file`.
    pub fn new(file: &'a str, text: &'a str) -> Self {
        Self {
            file,
            text,
            diagnostics: RefCell::new(Vec::new()),
        }
    }

    /// The top-level table.
    pub fn root<'r>(&'r self, entries: &'r DeTable<'a>) -> Section<'r, 'a> {
        self.section(String::new(), 1, entries)
    }

    /// The top-level table, with that of another file for the keys that it does not have.
    pub fn root_over<'r>(
        &'r self,
        entries: &'r DeTable<'a>,
        defaults: Section<'r, 'a>,
    ) -> Section<'r, 'a> {
        Section {
            defaults: Some(Box::new(defaults)),
            ..self.root(entries)
        }
    }

    fn section<'r>(&'r self, path: String, line: u64, entries: &'r DeTable<'a>) -> Section<'r, 'a> {
        Section {
            reader: self,
            path,
            line,
            entries,
            known: RefCell::new(Vec::new()),
            defaults: None,
        }
    }

    /// Records a mistake at a line and key.
    pub fn report(
        &self,
        line: u64,
        key: &str,
        found: impl Into<Box<str>>,
        expected: &str,
        hint: &str,
    ) {
        self.diagnostics.borrow_mut().push(
            Diagnostic::error(self.file, found, expected, hint)
                .at_row(line)
                .in_column(key),
        );
    }

    /// Whether no mistake has been found so far.
    pub fn is_clean(&self) -> bool {
        self.diagnostics.borrow().is_empty()
    }

    /// The mistakes, in the order of their lines.
    pub fn finish(self) -> Vec<Diagnostic> {
        let mut all = self.diagnostics.into_inner();
        all.sort_by_key(|d| d.row);
        all
    }
}

impl<'r, 'a> Section<'r, 'a> {
    /// Dotted path of a key of this table.
    pub fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.path)
        }
    }

    /// The reader that collects this file's mistakes.
    pub fn reader(&self) -> &'r Reader<'a> {
        self.reader
    }

    /// The line on which the table begins.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// The value of a key, if it stands there. The key counts as known from now on.
    pub fn get(&self, key: &'static str) -> Option<Entry<'r, 'a>> {
        let mut known = self.known.borrow_mut();
        if !known.contains(&key) {
            known.push(key);
        }
        drop(known);
        let found = self.entries.iter();
        let mut found = found.filter(|(k, _)| k.get_ref().as_ref() == key);
        let own = found.next().map(|(_, v)| self.entry(key, v));
        let defaults = self.defaults.as_ref().and_then(|d| d.get(key));
        let Some(own) = own else {
            return defaults;
        };
        let defaults = defaults.map(Box::new);
        Some(Entry { defaults, ..own })
    }

    /// The value of a key that must stand there.
    pub fn require(&self, key: &'static str, expected: &str, hint: &str) -> Option<Entry<'r, 'a>> {
        let entry = self.get(key);
        if entry.is_none() {
            self.reader
                .report(self.line, &self.path_of(key), "nothing", expected, hint);
        }
        entry
    }

    /// The same of a key that must stand in this file, whatever another one has.
    pub fn require_own(
        &self,
        key: &'static str,
        expected: &str,
        hint: &str,
    ) -> Option<Entry<'r, 'a>> {
        let is_own = self.entries.keys().any(|k| k.get_ref().as_ref() == key);
        if is_own {
            return self.require(key, expected, hint);
        }
        self.reader
            .report(self.line, &self.path_of(key), "nothing", expected, hint);
        None
    }

    /// Every key with its value, in the order of the file, then what another file has beside them: for tables whose keys the user invents.
    pub fn entries(&self) -> Vec<(String, Entry<'r, 'a>)> {
        let mut all: Vec<(String, Entry<'r, 'a>)> = self
            .entries
            .iter()
            .map(|(k, v)| (k.get_ref().to_string(), self.entry(k.get_ref(), v)))
            .collect();
        all.sort_by_key(|(_, e)| e.line);
        let defaults = self.defaults.iter().flat_map(|d| d.entries());
        let others: Vec<_> = defaults
            .filter(|(key, _)| all.iter().all(|(own, _)| own != key))
            .collect();
        all.extend(others);
        all
    }

    fn entry(&self, key: &str, value: &'r Spanned<DeValue<'a>>) -> Entry<'r, 'a> {
        Entry {
            reader: self.reader,
            path: self.path_of(key),
            line: line_of(self.reader.text, value.span().start),
            value: value.get_ref(),
            defaults: None,
        }
    }

    /// Reports every key that nobody asked for, with the nearest known one.
    pub fn close(&self) {
        self.defaults.iter().for_each(|d| d.close());
        let known = self.known.borrow();
        for (key, _) in self.entries.iter() {
            let name = key.get_ref().as_ref();
            if known.contains(&name) {
                continue;
            }
            let hint = match nearest(name, known.iter().copied()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => "remove it".to_owned(),
            };
            self.reader.report(
                line_of(self.reader.text, key.span().start),
                &self.path_of(name),
                "an unknown key",
                &format!("one of {}", known.join(", ")),
                &hint,
            );
        }
    }
}

impl<'r, 'a> Entry<'r, 'a> {
    /// Records that the value is not what was expected.
    pub fn reject(&self, expected: &str, hint: &str) {
        self.reject_for(&self.describe(), expected, hint);
    }

    /// Records that something in or about the value is not what was expected.
    pub fn reject_for(&self, found: &str, expected: &str, hint: &str) {
        self.reader
            .report(self.line, &self.path, found, expected, hint);
    }

    /// The key of the value, without the tables around it.
    pub fn key(&self) -> &str {
        let key = self.path.rsplit('.').next().unwrap_or_default();
        key.split('[').next().unwrap_or_default()
    }

    /// The value as it stands in the file, for a message.
    pub fn describe(&self) -> String {
        match self.value {
            DeValue::String(s) => format!("\"{s}\""),
            DeValue::Integer(i) => i.to_string(),
            DeValue::Float(x) => x.to_string(),
            DeValue::Boolean(b) => b.to_string(),
            DeValue::Datetime(d) => d.to_string(),
            DeValue::Array(_) => "a list".to_owned(),
            DeValue::Table(_) => "a table".to_owned(),
        }
    }

    /// The number, finite, or a recorded mistake.
    pub fn number(&self) -> Option<f64> {
        let number = self.as_number();
        if number.is_none() {
            self.reject(
                "a finite number",
                "write it without quotes and without unit",
            );
        }
        number
    }

    /// The number if it is one; no mistake is recorded otherwise.
    pub fn as_number(&self) -> Option<f64> {
        let parsed = match self.value {
            DeValue::Integer(i) if i.radix() == 10 => i.as_str().parse::<f64>().ok(),
            DeValue::Float(x) => x.as_str().parse::<f64>().ok(),
            _ => None,
        };
        parsed.filter(|x| x.is_finite())
    }

    /// The number if it lies above zero, or a recorded mistake.
    pub fn positive(&self, unit: &str, hint: &str) -> Option<f64> {
        let number = self.number()?;
        if number > 0.0 {
            return Some(number);
        }
        self.reject(&format!("a positive number ({unit})"), hint);
        None
    }

    /// The whole number, or a recorded mistake.
    pub fn integer(&self) -> Option<i64> {
        let parsed = match self.value {
            DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok(),
            _ => None,
        };
        if parsed.is_none() {
            self.reject("a whole number", "write it without quotes");
        }
        parsed
    }

    /// The text, or a recorded mistake.
    pub fn string(&self) -> Option<String> {
        let text = self.as_string();
        if text.is_none() {
            self.reject("text in quotes", "put it between double quotes");
        }
        text
    }

    /// The text if it is one; no mistake is recorded otherwise.
    pub fn as_string(&self) -> Option<String> {
        match self.value {
            DeValue::String(s) => Some(s.to_string()),
            _ => None,
        }
    }

    /// True or false, or a recorded mistake.
    pub fn boolean(&self) -> Option<bool> {
        if let DeValue::Boolean(b) = self.value {
            return Some(*b);
        }
        self.reject("true or false", "write it without quotes");
        None
    }

    /// The table, or a recorded mistake.
    pub fn table(&self) -> Option<Section<'r, 'a>> {
        if let DeValue::Table(t) = self.value {
            let section = self.reader.section(self.path.clone(), self.line, t);
            let defaults = self.defaults.as_ref().and_then(|d| d.table());
            let defaults = defaults.map(Box::new);
            return Some(Section {
                defaults,
                ..section
            });
        }
        let key = self.key();
        let hint = format!(
            "write `[{key}]` on a line of its own and the keys below, or `{key} = {{ ... }}`"
        );
        self.reject(&format!("a table `{key}`"), &hint);
        None
    }

    /// The list's elements, or a recorded mistake.
    pub fn list(&self) -> Option<Vec<Entry<'r, 'a>>> {
        let DeValue::Array(array) = self.value else {
            let key = self.key();
            let hint = format!("write `[[{key}]]`, or `{key} = [...]`");
            self.reject("a list, of one entry too", &hint);
            return None;
        };
        Some(self.elements(array))
    }

    fn elements(&self, array: &'r DeArray<'a>) -> Vec<Entry<'r, 'a>> {
        array
            .iter()
            .enumerate()
            .map(|(k, v)| Entry {
                reader: self.reader,
                path: format!("{}[{k}]", self.path),
                line: line_of(self.reader.text, v.span().start),
                value: v.get_ref(),
                defaults: None,
            })
            .collect()
    }

    /// One of a fixed set of words, or a recorded mistake that names the nearest.
    pub fn choice<T: Copy>(&self, choices: &[(&'static str, T)]) -> Option<T> {
        let text = self.string()?;
        if let Some((_, value)) = choices.iter().find(|(name, _)| *name == text) {
            return Some(*value);
        }
        let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
        let hint = match nearest(&text, names.iter().copied()) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => "choose one of them".to_owned(),
        };
        self.reject(&format!("one of {}", names.join(", ")), &hint);
        None
    }
}
