//! What is said of a bundle (`pipeline bundle`).

use crate::documented::Comments;
use serde::{Deserialize, Serialize};

documented! {
/// What is said of a bundle. No result depends on it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BundleOptions {
    /// Its name; empty for the title of the report.
    pub name: String,
    /// A description in a few sentences; empty for a generic one.
    pub description: String,
    /// Its license: an SPDX identifier, such as "CC-BY-4.0", or an address; empty for none.
    pub license: String,
    /// Authors, each as "Name" or "Name <ORCID>"; empty for the author of the report.
    pub authors: Vec<String>,
}
}

/// An author of a bundle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Author {
    /// As it is printed.
    pub name: String,
    /// The ORCID, `0000-0001-2345-6789`.
    pub orcid: Option<String>,
}

impl BundleOptions {
    /// The authors; where there are none the one of the report, if it has one. What cannot be read is no author ([`crate::Config::read`] refuses it).
    pub fn authors_or(&self, of_report: &str) -> Vec<Author> {
        let own: Vec<Author> = self.authors.iter().filter_map(|a| author(a)).collect();
        match own.is_empty() {
            true => author(of_report).into_iter().collect(),
            false => own,
        }
    }
}

/// `Name` or `Name <ORCID>`; none where it is neither.
pub(crate) fn author(text: &str) -> Option<Author> {
    let (name, orcid) = match text.split_once('<') {
        None => (text, None),
        Some((name, rest)) => (name, Some(rest.trim().strip_suffix('>')?)),
    };
    let name = name.trim();
    (!name.is_empty() && orcid.is_none_or(is_orcid)).then(|| Author {
        name: name.to_owned(),
        orcid: orcid.map(str::to_owned),
    })
}

/// Whether a text is an ORCID: four groups of four digits, the last a check digit (ISO 7064, MOD 11-2).
fn is_orcid(text: &str) -> bool {
    let groups: Vec<&str> = text.split('-').collect();
    let digits: Vec<char> = groups.concat().chars().collect();
    let Some((check, digits)) = digits.split_last() else {
        return false;
    };
    let sum = digits
        .iter()
        .try_fold(0, |sum, c| Some((sum + c.to_digit(10)?) * 2 % 11));
    let expected = sum.and_then(|sum| match (12 - sum) % 11 {
        10 => Some('X'),
        digit => char::from_digit(digit, 10),
    });
    groups.len() == 4 && groups.iter().all(|g| g.len() == 4) && expected == Some(*check)
}

/// Whether a text can be a license: an SPDX identifier, an address, or nothing.
pub(crate) fn is_license(text: &str) -> bool {
    let is_address = text.starts_with("https://") || text.starts_with("http://");
    let of_identifier = |c: char| c.is_ascii_alphanumeric() || "-.+".contains(c);
    match is_address {
        true => !text.contains(char::is_whitespace),
        false => text.chars().all(of_identifier),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_author_is_a_name_with_or_without_an_orcid() {
        let both = author("Ada Lovelace <0000-0002-1825-0097>").unwrap();
        assert_eq!(both.orcid.as_deref(), Some("0000-0002-1825-0097"));
        assert_eq!(both.name, "Ada Lovelace");
        assert_eq!(author("Ada Lovelace").unwrap().orcid, None);
        assert!(author("A <0000-0002-1694-233X>").is_some());
        for wrong in [
            "",
            "<0000-0002-1825-0097>",
            "A <0000-0002-1825-0098>",
            "A <x",
            "A <000000021825-0097>",
        ] {
            assert_eq!(author(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_license_is_an_identifier_or_an_address() {
        for right in ["", "CC-BY-4.0", "GPL-2.0+", "https://example.org/terms"] {
            assert!(is_license(right), "{right}");
        }
        for wrong in ["CC BY 4.0", "https://a b"] {
            assert!(!is_license(wrong), "{wrong}");
        }
    }
}
