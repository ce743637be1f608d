//! The bundled fonts: no font of the machine is ever used, so that every machine writes the same pages.
//!
//! Figures are lettered in Inter, a grotesque with full Greek; documents are set in Libertinus Serif, with New Computer Modern Math
//! for formulas. All files are unmodified; their licences stand beside them.

/// Inter, regular.
pub const SANS: &[u8] = include_bytes!("fonts/Inter-Regular.otf");
/// Inter, bold.
pub const SANS_BOLD: &[u8] = include_bytes!("fonts/Inter-Bold.otf");
/// Inter, italic.
pub const SANS_ITALIC: &[u8] = include_bytes!("fonts/Inter-Italic.otf");

/// Every bundled font, in the order in which documents look for glyphs.
pub const ALL: [&[u8]; 7] = [
    include_bytes!("fonts/LibertinusSerif-Regular.otf"),
    include_bytes!("fonts/LibertinusSerif-Bold.otf"),
    include_bytes!("fonts/LibertinusSerif-Italic.otf"),
    include_bytes!("fonts/NewCMMath-Regular.otf"),
    SANS,
    SANS_BOLD,
    SANS_ITALIC,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bundle_stays_below_four_megabytes() {
        assert!(ALL.iter().map(|f| f.len()).sum::<usize>() < 4_000_000);
        assert!(ALL.iter().all(|f| f.len() < 2_000_000));
    }
}
