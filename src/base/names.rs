//! Names that users give, as names of files.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_cannot_leave_its_folder() {
        assert_eq!(file_name("iso10-l182_c25.a"), "iso10-l182_c25.a");
        assert_eq!(file_name("../x"), "%2E.%2Fx");
        assert_eq!(file_name("a b/c"), "a%20b%2Fc");
    }
}
