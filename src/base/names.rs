//! Names that users give, as names of files, and the names of files by one path each.

use std::path::{Component, Path};

/// A name as a file name: everything but letters, digits, `-`, `_` and `.` is written as its code, so that no name leaves its folder.
pub fn file_name(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let name: String = name
        .chars()
        .map(|c| {
            if plain(c) {
                c.to_string()
            } else {
                format!("%{:X}", c as u32)
            }
        })
        .collect();
    match name.strip_prefix('.') {
        Some(rest) => format!("%2E{rest}"),
        None => name,
    }
}

/// A path below a folder without `.` and `..`, with forward slashes; none where it leads out of the folder.
pub fn plain_path(path: &Path) -> Option<String> {
    let mut parts: Vec<String> = Vec::new();
    for part in path.components() {
        match part {
            Component::Normal(name) => parts.push(name.to_string_lossy().into_owned()),
            Component::ParentDir => drop(parts.pop()?),
            Component::CurDir => {}
            Component::Prefix(_) | Component::RootDir => return None,
        }
    }
    Some(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_cannot_leave_its_folder() {
        assert_eq!(file_name("iso10-l182_c25.a"), "iso10-l182_c25.a");
        assert_eq!(file_name("../x"), "%2E.%2Fx");
        assert_eq!(file_name("a b/c"), "a%20b%2Fc");
    }

    #[test]
    fn a_plain_path_stays_in_its_folder() {
        let of = |path: &str| plain_path(Path::new(path));
        assert_eq!(of("./session.toml").as_deref(), Some("session.toml"));
        assert_eq!(
            of("a/b/../campaign.toml").as_deref(),
            Some("a/campaign.toml")
        );
        assert_eq!(of("a/../../campaign.toml"), None);
        assert_eq!(of("/campaign.toml"), None);
    }
}
