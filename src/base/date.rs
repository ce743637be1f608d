//! Dates as users write them: ISO 8601, a day or a month.

/// Year, month and day; the first of a month where no day is stated, none where the text is no date.
pub fn parts(text: &str) -> Option<(i32, u8, u8)> {
    let mut parts = text.splitn(3, '-');
    let year = parts.next()?.parse().ok()?;
    let month = parts.next()?.parse().ok()?;
    let day = parts.next().map_or(Some(1), |d| d.parse().ok())?;
    Some((year, month, day))
}

/// The date that a document has: the configured one, else the last on which something was measured; none where there is neither, and never today's.
pub fn of_document<'a>(
    configured: &str,
    measured: impl Iterator<Item = &'a str>,
) -> Option<(i32, u8, u8)> {
    parts(configured).or_else(|| measured.filter_map(parts).max())
}

/// Whether a text is a day or a month that exists.
pub fn is_date(text: &str) -> bool {
    let parts: Vec<Option<u32>> = text.split('-').map(number).collect();
    let lengths: Vec<usize> = text.split('-').map(str::len).collect();
    match (&parts[..], &lengths[..]) {
        ([Some(_), Some(month)], [4, 2]) => (1..=12).contains(month),
        ([Some(year), Some(month), Some(day)], [4, 2, 2]) => {
            (1..=12).contains(month) && (1..=days(*year, *month)).contains(day)
        }
        _ => false,
    }
}

fn number(digits: &str) -> Option<u32> {
    let are_digits = digits.bytes().all(|b| b.is_ascii_digit());
    digits.parse().ok().filter(|_| are_digits)
}

/// Days of a month.
fn days(year: u32, month: u32) -> u32 {
    let is_leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    match month {
        2 if is_leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_has_the_configured_date_or_that_of_the_last_measurement() {
        let measured = ["2022-11", "2022-11-30", "2022-01-31"];
        let of = |configured| of_document(configured, measured.into_iter());
        assert_eq!(of("2024-05"), Some((2024, 5, 1)));
        assert_eq!(of(""), Some((2022, 11, 30)));
        assert_eq!(of_document("", std::iter::empty()), None);
    }

    #[test]
    fn only_days_and_months_that_exist_are_dates() {
        for date in ["2022-11", "2022-11-30", "2024-02-29", "2000-02-29"] {
            assert!(is_date(date), "{date}");
        }
        for text in [
            "tomorrow",
            "2022",
            "2022-13",
            "2022-02-31",
            "2023-02-29",
            "1900-02-29",
            "22-11-30",
            "2022-11-3",
            "2022-11-+1",
            "2022-11-30-1",
            "",
        ] {
            assert!(!is_date(text), "{text}");
        }
    }
}
