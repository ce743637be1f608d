//! What stands where on a typeset page: how far it reaches, how much of the page it fills, how small its letters are.
//!
//! Measured on the frames that Typst lays out. Pictures count with their outlines; the letters inside them are the figures' own affair
//! ([`plot`](crate::plot)).

use serde::{Deserialize, Serialize};
use typst::foundations::StyleChain;
use typst::introspection::Tag;
use typst::layout::{Abs, Frame, FrameItem, Point, Rect, Size, Transform};
use typst::model::HeadingElem;
use typst::text::TextItem;

/// The margins of a page, mm: of the house style, which reads them, and of the measuring.
#[derive(Clone, Copy, Debug)]
pub struct Margins {
    /// Above the type area.
    pub top: f64,
    /// Below it.
    pub bottom: f64,
    /// On its left and right.
    pub side: f64,
}

/// Those of our documents. The type area is as wide as a figure of two columns, so that none overhangs it.
pub const MARGINS_MM: Margins = Margins {
    top: 25.0,
    bottom: 24.0,
    side: 17.5,
};

/// The margins as the house style reads them.
pub fn margins_json() -> String {
    let Margins { top, bottom, side } = MARGINS_MM;
    format!("{{\"top\":{top:?},\"bottom\":{bottom:?},\"side\":{side:?}}}")
}

/// White space that is lower than this is part of what stands around it: lines, paragraphs, rows of a table.
const GAP_MM: f64 = 9.0;
/// A letter reaches so far above and below its base line, in sizes.
const ASCENT: f64 = 0.75;
const DESCENT: f64 = 0.22;
/// A subscript or superscript is at most so large, in sizes of the letters beside it, and its base line at most so far from theirs.
const SCRIPT: f64 = 0.8;
const SHIFT: f64 = 0.8;
/// A letter beside it is at most so far away, in its sizes.
const NEAR: f64 = 1.2;

/// What was measured of one document.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    /// Its pages.
    pub sheets: Vec<Sheet>,
    /// What Typst warns of, as that the layout does not settle.
    pub warnings: Vec<String>,
}

/// What was measured of one page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sheet {
    /// By how much something reaches beyond the left or right margin, or beyond the paper, mm; 0 where nothing does.
    pub beyond_mm: f64,
    /// The share of the height of the type area that is not blank.
    pub filled: f64,
    /// The smallest letters, sub- and superscripts apart; none where there are none.
    pub smallest: Option<Smallest>,
    /// Whether it begins with the heading of a chapter.
    pub opens_chapter: bool,
}

/// The smallest letters of a page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Smallest {
    /// Their size, pt.
    pub pt: f64,
    /// Some of them.
    pub text: String,
}

/// A run of letters and its place.
struct Letters {
    left: Abs,
    right: Abs,
    base: Abs,
    size: Abs,
    text: String,
}

/// Everything on a page that leaves ink, with absolute places.
#[derive(Default)]
struct Ink {
    boxes: Vec<Rect>,
    letters: Vec<Letters>,
    /// Where chapters begin.
    chapters: Vec<Abs>,
}

/// Measures a page.
pub fn measure(page: &Frame) -> Sheet {
    let mut ink = Ink::default();
    ink.add(page, Transform::identity());
    Sheet {
        beyond_mm: ink.beyond(page.size()).to_mm().max(0.0),
        filled: ink.filled(page.height()),
        smallest: ink.smallest().map(|l| Smallest {
            pt: l.size.to_pt(),
            text: l.text.clone(),
        }),
        opens_chapter: ink.opens_chapter(page.height()),
    }
}

impl Ink {
    fn add(&mut self, frame: &Frame, to_page: Transform) {
        for (at, item) in frame.items() {
            let here = to_page.pre_concat(Transform::translate(at.x, at.y));
            match item {
                FrameItem::Group(group) => {
                    self.add(&group.frame, here.pre_concat(group.transform));
                }
                FrameItem::Text(text) => self.add_text(text, here),
                FrameItem::Shape(shape, _) => self.add_box(shape.geometry.bbox(None), here),
                FrameItem::Image(_, size, _) => self.add_box(of_size(*size), here),
                FrameItem::Tag(Tag::Start(content, _)) => {
                    let heading = content.to_packed::<HeadingElem>();
                    let level = heading.map(|h| h.resolve_level(StyleChain::default()).get());
                    if level == Some(1) {
                        self.chapters.push(Point::zero().transform(here).y);
                    }
                }
                FrameItem::Tag(_) | FrameItem::Link(..) => {}
            }
        }
    }

    fn add_box(&mut self, own: Rect, here: Transform) {
        let corners = [own.min, own.max].map(|corner| corner.transform(here));
        self.boxes.push(Rect {
            min: corners[0].min(corners[1]),
            max: corners[0].max(corners[1]),
        });
    }

    fn add_text(&mut self, text: &TextItem, here: Transform) {
        if text.text.trim().is_empty() {
            return;
        }
        let at = Point::zero().transform(here);
        let letters = Letters {
            left: at.x,
            right: at.x + text.width(),
            base: at.y,
            size: text.size * here.sy.get(),
            text: text.text.to_string(),
        };
        self.boxes.push(Rect {
            min: Point::new(letters.left, letters.base - letters.size * ASCENT),
            max: Point::new(letters.right, letters.base + letters.size * DESCENT),
        });
        self.letters.push(letters);
    }

    fn beyond(&self, page: Size) -> Abs {
        let side = Abs::mm(MARGINS_MM.side);
        let of = |b: &Rect| {
            let across = (side - b.min.x).max(b.max.x - (page.x - side));
            across.max(-b.min.y).max(b.max.y - page.y)
        };
        self.boxes.iter().map(of).fold(Abs::zero(), Abs::max)
    }

    /// The type area from top to bottom.
    fn type_area(height: Abs) -> (Abs, Abs) {
        (Abs::mm(MARGINS_MM.top), height - Abs::mm(MARGINS_MM.bottom))
    }

    fn filled(&self, height: Abs) -> f64 {
        let (top, bottom) = Self::type_area(height);
        let inside = self
            .boxes
            .iter()
            .filter(|b| b.max.y > top && b.min.y < bottom);
        let mut stretches: Vec<(f64, f64)> = inside
            .map(|b| (b.min.y.max(top).to_mm(), b.max.y.min(bottom).to_mm()))
            .collect();
        stretches.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut covered = 0.0;
        let mut end = top.to_mm();
        for (from, to) in stretches {
            let from = if from - end < GAP_MM { end } else { from };
            covered += (to - from.max(end)).max(0.0);
            end = end.max(to);
        }
        covered / (bottom - top).to_mm()
    }

    fn smallest(&self) -> Option<&Letters> {
        let whole = self.letters.iter().filter(|l| !self.is_script(l));
        whole.min_by(|a, b| a.size.cmp(&b.size))
    }

    /// Whether letters are a sub- or superscript of others.
    fn is_script(&self, small: &Letters) -> bool {
        self.letters.iter().any(|large| {
            let apart = (small.left - large.right).max(large.left - small.right);
            small.size <= large.size * SCRIPT
                && apart <= large.size * NEAR
                && (small.base - large.base).abs() <= large.size * SHIFT
        })
    }

    fn opens_chapter(&self, height: Abs) -> bool {
        let (top, _) = Self::type_area(height);
        let body = self.boxes.iter().filter(|b| b.max.y > top);
        let first = body.map(|b| b.min.y).min();
        let Some(first) = first else {
            return false;
        };
        self.chapters.iter().any(|c| *c <= first + Abs::mm(GAP_MM))
    }
}

fn of_size(size: Size) -> Rect {
    Rect {
        min: Point::zero(),
        max: size.to_point(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::typeset::Document;

    /// The sheets of a document in the house style.
    fn sheets(body: &str) -> Vec<Sheet> {
        let main = format!("#import \"/style.typ\": *\n#show: report.with(title: \"T\")\n{body}");
        Document::new(&main).compile().unwrap().sheets
    }

    #[test]
    fn what_hangs_over_a_margin_is_measured() {
        let wide = |mm: f64| format!("#block(width: {mm}mm, height: 5mm, fill: black)");
        assert!(sheets(&wide(175.0))[0].beyond_mm < 1e-6);
        let beyond = sheets(&wide(178.0))[0].beyond_mm;
        assert!((beyond - 3.0).abs() < 1e-6, "{beyond}");
    }

    #[test]
    fn a_page_is_filled_as_far_as_there_is_no_white_space() {
        let type_area = 297.0 - MARGINS_MM.top - MARGINS_MM.bottom;
        let pages = sheets(
            "#pagebreak()\n#rect(width: 5mm, height: 62mm, fill: black)\n#place(bottom, rect(height: 31mm))",
        );
        let expected = (62.0 + 31.0) / type_area;
        assert!((pages[1].filled - expected).abs() < 0.01, "{:?}", pages[1]);
    }

    /// Packs blocks of heights, mm, behind a head.
    fn packed(heights: &[u32]) -> Vec<Sheet> {
        let block = |h: &u32| format!("rect(width: 30mm, height: {h}mm, fill: black), ");
        let blocks: String = heights.iter().map(block).collect();
        sheets(&format!(
            "#pagebreak()\n#packed(((head: [= Head], blocks: ({blocks})),))"
        ))
    }

    #[test]
    fn packed_blocks_fill_their_pages() {
        // In this order, one after the other, they would take four pages.
        let pages = packed(&[110, 130, 130, 90, 60, 90]);
        let filled: Vec<f64> = pages[1..].iter().map(|p| p.filled).collect();
        assert!(
            filled.len() == 3 && filled[..2].iter().all(|f| *f > 0.9),
            "{filled:?}"
        );
        let whole = 297.0 - MARGINS_MM.top - MARGINS_MM.bottom;
        let black: f64 = filled.iter().sum::<f64>() * whole;
        assert!(black > 610.0, "{black}");
    }

    #[test]
    fn many_small_blocks_are_packed_without_trying_every_choice() {
        let pages = packed(&[20; 60]);
        let filled = pages[1..pages.len() - 1].iter().map(|p| p.filled);
        assert!(
            filled.clone().all(|f| f > 0.85) && pages.len() <= 8,
            "{:?}",
            filled.collect::<Vec<_>>()
        );
    }

    #[test]
    fn packing_settles_wherever_it_begins() {
        // So far that the head, the first block or nothing has room on the first page.
        for before in [0, 60, 150, 190, 205, 215] {
            let body = format!(
                "#let black(h) = figure(rect(width: 30mm, height: h * 1mm), caption: [C])\n\
                 #let s(n) = (head: [= Head #n \\ #lorem(40)], blocks: (60, 90, 40, 120).map(black))\n\
                 #block(height: {before}mm)[Text]\n#packed(range(6).map(s))"
            );
            let main = format!(
                "#import \"/style.typ\": *\n#show: report.with(title: \"T\")\n#show figure: set figure(placement: none)\n{body}"
            );
            let pdf = Document::new(&main).compile().unwrap();
            assert_eq!(pdf.warnings, [""; 0], "{before}");
            assert!(pdf.sheets.len() <= 11, "{before}: {}", pdf.sheets.len());
        }
    }

    #[test]
    fn packed_blocks_begin_below_what_stands_before_them() {
        let body = "#rect(width: 5mm, height: 120mm, fill: black)\n\
                    #packed(((head: [Head], blocks: (rect(height: 60mm, fill: black), rect(height: 150mm))),))";
        let pages = sheets(body);
        assert_eq!(pages.len(), 2, "{pages:?}");
        assert!(pages.iter().all(|p| p.beyond_mm < 0.5), "{pages:?}");
    }

    #[test]
    fn a_heading_stays_with_its_first_block() {
        let pages = sheets(
            "#packed(((head: [= One], blocks: (rect(width: 9mm, height: 190mm),)), (head: [= Two], blocks: (rect(width: 9mm, height: 60mm),))))",
        );
        let opens: Vec<bool> = pages.iter().map(|p| p.opens_chapter).collect();
        assert_eq!(opens[opens.len() - 1..], [true], "{pages:?}");
    }

    #[test]
    fn small_letters_are_found_and_scripts_are_none() {
        let smallest = |body: &str| sheets(body)[0].smallest.clone().unwrap();
        let scripts = smallest("Text with $F_\"max\"^2$, H#sub[2]O and x#super[3].");
        assert!(scripts.pt >= 8.0, "{scripts:?}");
        let small = smallest("Text \\ #text(size: 7pt)[and a note]");
        assert!(
            (small.pt - 7.0).abs() < 1e-6 && small.text.contains("note"),
            "{small:?}"
        );
    }

    #[test]
    fn a_page_that_begins_with_a_chapter_says_so() {
        let pages = sheets("Text\n#pagebreak()\n= One\nText\n#pagebreak()\nText\n= Two\nText");
        let opens: Vec<bool> = pages.iter().map(|s| s.opens_chapter).collect();
        assert_eq!(opens, [false, true, false]);
    }
}
