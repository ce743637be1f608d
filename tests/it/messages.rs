//! Every message about an input says where, what was found, what is expected and what to do.
//!
//! Messages are made where a defect is seen, by a handful of constructors. The first test reads the sources, finds every call of one
//! and looks at its texts, so that a new message cannot lack a part; the others (`fuzz`, `bad_input`, `broken`) provoke messages.

use pipeline::base::diagnostics::Diagnostic;
use std::path::Path;

/// The constructors of messages, and which of their arguments are found, expected and hint (counted from 0).
const CONSTRUCTORS: &[(&str, &[usize])] = &[
    ("Diagnostic::error(", &[1, 2, 3]),
    ("unreadable(", &[1, 2, 3]),
    (".reject(", &[0, 1]),
    (".report(", &[2, 3, 4]),
    (".require(", &[1, 2]),
    (".positive(", &[0, 1]),
];

/// Fails unless the message has every part.
pub fn assert_complete(diagnostic: &Diagnostic, of: &str) {
    for (part, text) in [
        ("file", &diagnostic.file),
        ("found", &diagnostic.found),
        ("expected", &diagnostic.expected),
        ("hint", &diagnostic.hint),
    ] {
        assert!(!text.trim().is_empty(), "{of}: no {part} in {diagnostic:?}");
    }
    assert_ne!(
        diagnostic.row,
        Some(0),
        "{of}: lines count from 1: {diagnostic:?}"
    );
    let column = diagnostic.column.as_deref();
    assert_ne!(
        column,
        Some(""),
        "{of}: a column without a name: {diagnostic:?}"
    );
}

/// A call in a source file, with the texts of its arguments.
struct Call {
    place: String,
    arguments: Vec<String>,
}

/// Every call of a constructor below `src/`, tests and the constructors' own definitions aside.
fn calls(constructor: &str) -> Vec<Call> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    for file in crate::support::files(&source) {
        if file.extension().is_none_or(|e| e != "rs") || file.ends_with("tests.rs") {
            continue;
        }
        let text = std::fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        if !code.contains("diagnostics") && !code.contains("toml_reader") {
            continue;
        }
        for (at, _) in code.match_indices(constructor) {
            let before = &code[..at];
            let line = before.lines().next_back().unwrap_or_default();
            let is_name = |c: char| c.is_alphanumeric() || c == '_';
            let is_other = constructor.starts_with(is_name) && before.ends_with(is_name);
            if is_other || line.contains("fn ") || line.trim_start().starts_with("//") {
                continue;
            }
            found.push(Call {
                place: format!("{}:{}", file.display(), before.lines().count()),
                arguments: arguments(&code[at + constructor.len()..]),
            });
        }
    }
    found
}

/// The arguments up to the bracket that closes the call.
fn arguments(code: &str) -> Vec<String> {
    let (mut all, mut depth, mut in_text, mut escaped) = (vec![String::new()], 0, false, false);
    for c in code.chars() {
        let last = all.last_mut().unwrap();
        if in_text {
            in_text = c != '"' || escaped;
            escaped = c == '\\' && !escaped;
            last.push(c);
            continue;
        }
        match c {
            '"' => in_text = true,
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' if depth == 0 => break,
            ')' | ']' | '}' => depth -= 1,
            ',' if depth == 0 => {
                all.push(String::new());
                continue;
            }
            _ => {}
        }
        all.last_mut().unwrap().push(c);
    }
    all.retain(|a| !a.trim().is_empty());
    all.iter().map(|a| a.trim().to_owned()).collect()
}

#[test]
fn every_message_in_the_sources_has_found_expected_and_hint() {
    let mut seen = 0;
    for (constructor, parts) in CONSTRUCTORS {
        let calls = calls(constructor);
        assert!(
            !calls.is_empty(),
            "{constructor} is called nowhere: correct the list"
        );
        for call in calls {
            for part in *parts {
                let text = call.arguments.get(*part);
                let text = text
                    .unwrap_or_else(|| panic!("{}: {constructor} lacks an argument", call.place));
                let bare = text.trim_start_matches('&').trim_matches('"').trim();
                let is_empty = bare.is_empty() || bare == "String::new()";
                assert!(
                    !is_empty,
                    "{}: an empty part in {:?}",
                    call.place, call.arguments
                );
            }
            seen += 1;
        }
    }
    assert!(
        seen > 100,
        "only {seen} messages were found: the search is broken"
    );
    println!("{seen} messages");
}

#[test]
fn no_message_is_made_without_its_constructor() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for file in crate::support::files(&source) {
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let literal = text.contains("Diagnostic {") && !text.contains("pub struct Diagnostic {");
        let made = literal
            && text
                .lines()
                .any(|l| l.contains("Diagnostic {") && !l.contains("->") && !l.contains("impl"));
        assert!(!made, "{} builds a Diagnostic by hand", file.display());
    }
}
