//! The clock of the database as retention sees it: once an hour its time is stored. One that is suddenly far from it, as that of a machine
//! which starts without a battery may be, is doubted: ahead it would make everything too old, until it goes back, has run on for
//! long, or is confirmed. What is stored while it is behind counts from the newest time (the view `age_clock`), else it would be too old as
//! soon as the clock is right again.

use std::fmt::{Display, Formatter};

use super::database::{Row, query};
use super::{Store, StoreError};

const HOUR_MS: i64 = 3600 * 1000;
const DAY_MS: i64 = 24 * HOUR_MS;
/// A time so far from the newest one is doubted.
const FAR_MS: i64 = 2 * DAY_MS;
/// A doubted clock that has gone on for so long is trusted.
const CONTINUOUS_MS: i64 = 7 * DAY_MS;

const SEEN: &str = "SELECT trusted, latest, doubted FROM seen_clock WHERE number = 1 FOR UPDATE";
const READ: &str = "SELECT trusted, latest, doubted FROM seen_clock WHERE number = 1";
const NOW: &str = "SELECT now_ms FROM clock";
const NEWEST: &str = "SELECT MAX(newest) FROM (SELECT MAX(updated) AS newest FROM cases \
     UNION ALL SELECT MAX(updated) FROM jobs UNION ALL SELECT MAX(created) FROM meshes) AS times";
const STORE: &str = "INSERT INTO seen_clock (number, trusted, latest, doubted) VALUES (1, $1, $2, $3) \
     ON CONFLICT (number) DO UPDATE SET trusted = excluded.trusted, latest = excluded.latest, \
     doubted = excluded.doubted";

/// Times in ms since 1970.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ClockRecord {
    trusted: i64,
    latest: i64,
    doubted: Option<i64>,
}

/// A clock that is so many hours from the newest time at which this deployment was seen to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClockDoubt {
    Ahead {
        hours: i64,
        /// After so many hours it is trusted, if it goes on as it does.
        trusted_in_h: i64,
    },
    Behind {
        hours: i64,
    },
}

impl Display for ClockDoubt {
    fn fmt(&self, to: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            ClockDoubt::Ahead { hours, trusted_in_h } => write!(
                to,
                "the clock is {hours} h ahead of when this deployment ran last, and is trusted after {trusted_in_h} h more of service"
            ),
            ClockDoubt::Behind { hours } => write!(
                to,
                "the clock is {hours} h behind the newest time at which this deployment ran, from which the age of what is stored now counts"
            ),
        }
    }
}

impl ClockRecord {
    fn at(self, now: i64) -> ClockRecord {
        let trusted = ClockRecord { trusted: self.trusted.max(now), latest: now, doubted: None };
        if now <= self.trusted.saturating_add(FAR_MS) {
            return trusted;
        }
        let goes_on = now.abs_diff(self.latest) <= FAR_MS as u64;
        let from = self.doubted.filter(|_| goes_on).map_or(now, |from| from.min(now));
        if now - from >= CONTINUOUS_MS {
            return trusted;
        }
        ClockRecord { trusted: self.trusted, latest: now, doubted: Some(from) }
    }

    fn doubt(self) -> Option<ClockDoubt> {
        let ahead = self.latest - self.trusted;
        match self.doubted {
            Some(from) => {
                let left = CONTINUOUS_MS - (self.latest - from);
                let trusted_in_h = (left + HOUR_MS - 1) / HOUR_MS;
                Some(ClockDoubt::Ahead { hours: ahead / HOUR_MS, trusted_in_h })
            }
            None if ahead < -FAR_MS => Some(ClockDoubt::Behind { hours: -ahead / HOUR_MS }),
            None => None,
        }
    }
}

fn seen(row: &Row) -> Result<ClockRecord, sqlx::Error> {
    Ok(ClockRecord {
        trusted: row.try_get("trusted")?,
        latest: row.try_get("latest")?,
        doubted: row.try_get("doubted")?,
    })
}

impl Store {
    /// Stores the time of now; the doubt in it, if there is one. What ran before it was stored is as new as its newest row.
    pub(super) async fn note_clock(&self) -> Result<Option<ClockDoubt>, StoreError> {
        let mut transaction = self.database.begin().await?;
        let row = query(SEEN).fetch_optional(&mut transaction).await?;
        let now: i64 = query(NOW).fetch_one(&mut transaction).await?.try_get(0)?;
        let before = match row {
            Some(row) => seen(&row)?,
            None => {
                let newest = query(NEWEST).fetch_one(&mut transaction).await?;
                let newest = newest.try_get::<Option<i64>, _>(0)?.unwrap_or(now);
                ClockRecord { trusted: newest, latest: newest, doubted: None }
            }
        };
        let ClockRecord { trusted, latest, doubted } = before.at(now);
        let stored = query(STORE).bind(trusted).bind(latest).bind(doubted);
        stored.execute(&mut transaction).await?;
        transaction.commit().await?;
        Ok(before.at(now).doubt())
    }

    /// The doubt in the clock when it was last looked at.
    pub async fn clock_doubt(&self) -> Result<Option<ClockDoubt>, StoreError> {
        let row = query(READ).fetch_optional(self.database.reader()).await?;
        let seen = row.as_ref().map(seen).transpose()?;
        Ok(seen.and_then(ClockRecord::doubt))
    }

    /// Takes the time of now for right.
    pub async fn trust_clock(&self) -> Result<(), StoreError> {
        let mut transaction = self.database.begin().await?;
        let now: i64 = query(NOW).fetch_one(&mut transaction).await?.try_get(0)?;
        let stored = query(STORE).bind(now).bind(now).bind(None::<i64>);
        stored.execute(&mut transaction).await?;
        transaction.commit().await?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: i64 = 20_000 * DAY_MS;

    fn right() -> ClockRecord {
        ClockRecord { trusted: START, latest: START, doubted: None }
    }

    /// Looked at every hour from a time on, for so many hours.
    fn run(seen: ClockRecord, from: i64, hours: i64) -> ClockRecord {
        (0..=hours).fold(seen, |seen, hour| seen.at(from + hour * HOUR_MS))
    }

    #[test]
    fn a_clock_a_year_ahead_is_doubted_until_it_goes_back_or_has_gone_on_for_a_week() {
        let year = START + 366 * DAY_MS;
        let ahead = right().at(year);
        let told = ClockDoubt::Ahead { hours: 366 * 24, trusted_in_h: 7 * 24 };
        assert_eq!(ahead.doubt(), Some(told));
        let back = ahead.at(START + HOUR_MS);
        assert_eq!((back.doubt(), back.trusted), (None, START + HOUR_MS));
        assert!(run(ahead, year, 7 * 24 - 1).doubt().is_some());
        let long = run(ahead, year, 7 * 24);
        assert_eq!((long.doubt(), long.trusted), (None, year + 7 * DAY_MS));
    }

    #[test]
    fn a_doubted_clock_that_stands_still_or_jumps_again_is_doubted_anew() {
        let year = START + 366 * DAY_MS;
        let days = run(right(), year, 6 * 24);
        let told = |hours, trusted_in_h| Some(ClockDoubt::Ahead { hours, trusted_in_h });
        assert_eq!(days.doubt(), told(372 * 24, 24));
        let later = days.at(year + 10 * DAY_MS);
        assert_eq!(later.doubt(), told(376 * 24, 7 * 24));
    }

    #[test]
    fn a_clock_far_behind_is_doubted_for_as_long_as_it_is_and_one_after_a_night_is_not() {
        assert_eq!(right().at(START + 2 * DAY_MS).doubt(), None);
        assert_eq!(right().at(START - 2 * DAY_MS).doubt(), None);
        let behind = run(right(), DAY_MS, 30 * 24);
        let hours = 24 * (START / DAY_MS - 31);
        assert_eq!((behind.doubt(), behind.trusted), (Some(ClockDoubt::Behind { hours }), START));
        let back = behind.at(START + DAY_MS);
        assert_eq!((back.doubt(), back.trusted), (None, START + DAY_MS));
    }
}
