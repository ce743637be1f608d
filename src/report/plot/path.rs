//! SVG path data in as few bytes as whole numbers allow: relative steps, signs as separators, steps of nothing left out.

use std::fmt::Write;

/// Path data under way.
#[derive(Default)]
pub struct PathData {
    text: String,
    at: Option<(i32, i32)>,
    in_line: bool,
}

impl PathData {
    /// Begins the path at a point, or goes on to it in a straight line.
    pub fn to(&mut self, (x, y): (i32, i32)) {
        match self.at {
            None => self.step('M', x, y),
            Some(last) if last == (x, y) => return,
            Some((x0, y0)) if self.in_line => self.numbers(x - x0, y - y0, true),
            Some((x0, y0)) => {
                self.step('l', x - x0, y - y0);
                self.in_line = true;
            }
        }
        self.at = Some((x, y));
    }

    /// A dot: a stroke of one unit, whose round ends make a disc.
    pub fn dot(&mut self, (x, y): (i32, i32)) {
        let (x0, y0) = self.at.unwrap_or((0, 0));
        self.step('m', x - x0, y - y0);
        self.text.push_str("h1");
        self.at = Some((x + 1, y));
    }

    /// Back to the beginning.
    pub fn close(&mut self) {
        self.text.push('z');
    }

    /// What has been written.
    pub fn text(&self) -> &str {
        &self.text
    }

    fn step(&mut self, command: char, x: i32, y: i32) {
        self.text.push(command);
        self.numbers(x, y, false);
    }

    fn numbers(&mut self, x: i32, y: i32, separated: bool) {
        let before = if separated && x >= 0 { " " } else { "" };
        let between = if y >= 0 { " " } else { "" };
        let _ = write!(self.text, "{before}{x}{between}{y}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_relative_and_repeated_points_are_left_out() {
        let mut path = PathData::default();
        for point in [(10, 20), (15, 18), (15, 18), (14, 30)] {
            path.to(point);
        }
        path.close();
        assert_eq!(path.text(), "M10 20l5-2-1 12z");
    }

    #[test]
    fn dots_begin_where_the_last_one_ended() {
        let mut path = PathData::default();
        path.dot((5, 5));
        path.dot((4, 9));
        assert_eq!(path.text(), "m5 5h1m-2 4h1");
    }
}
