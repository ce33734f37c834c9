//! Points in time as text.

use std::time::{Duration, SystemTime};

/// A point in time as RFC 3339 has it, in UTC with milliseconds: `2026-11-28T14:21:38.042Z`. What
/// is before 1970 is shown as its beginning.
pub fn format_utc(time: SystemTime) -> String {
    let since = time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or(Duration::ZERO);
    let seconds = since.as_secs();
    let (year, month, day) = date_of(seconds / 86_400);
    let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    let millis = since.subsec_millis();
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{millis:03}Z")
}

/// Year, month and day in the Gregorian calendar, of a number of days since 1970-01-01.
fn date_of(days: u64) -> (u64, u64, u64) {
    /// Days of 400 years, after which the calendar repeats itself.
    const CYCLE: u64 = 146_097;
    // Years that begin in March end with the day that only some of them have.
    let since_march_0000 = days + 719_468;
    let (cycle, day) = (since_march_0000 / CYCLE, since_march_0000 % CYCLE);
    let year = (day - day / 1460 + day / 36_524 - day / (CYCLE - 1)) / 365;
    let day_of_year = day - (365 * year + year / 4 - year / 100);
    // From March on, months have 31, 30, 31, 30, 31 days, and again: 153 in five of them.
    let month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let january_follows = month >= 10;
    let month = if january_follows { month - 9 } else { month + 3 };
    (400 * cycle + year + u64::from(january_follows), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_of_the_calendar() {
        // Seconds as `date -u -d … +%s` gives them.
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00.000Z"),
            (951_782_399, "2000-02-28T23:59:59.000Z"),
            (951_782_400, "2000-02-29T00:00:00.000Z"),
            (1_709_251_200, "2024-03-01T00:00:00.000Z"),
            (1_767_225_599, "2025-12-31T23:59:59.000Z"),
            (4_107_542_400, "2100-03-01T00:00:00.000Z"),
        ] {
            let time = SystemTime::UNIX_EPOCH + Duration::from_secs(seconds);
            assert_eq!(format_utc(time), text);
        }
        let late = SystemTime::UNIX_EPOCH + Duration::from_millis(42);
        assert_eq!(format_utc(late), "1970-01-01T00:00:00.042Z");
    }

    #[test]
    fn each_day_follows_the_one_before() {
        let mut last = date_of(0);
        for day in 1..CYCLE_AND_MORE {
            let now = date_of(day);
            let next_day = now == (last.0, last.1, last.2 + 1);
            let next_month = now == (last.0, last.1 + 1, 1) && last.2 >= 28;
            let next_year = now == (last.0 + 1, 1, 1) && (last.1, last.2) == (12, 31);
            assert!(next_day || next_month || next_year, "{last:?} {now:?}");
            last = now;
        }
    }

    const CYCLE_AND_MORE: u64 = 150_000;
}
