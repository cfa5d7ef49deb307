-- The time from which the age of what is stored now counts: that of the clock, or the newest one at which this deployment was seen to
-- run where the clock is behind that (src/store/seen_clock.rs).
CREATE VIEW age_clock AS
    SELECT CASE WHEN seen_clock.trusted > clock.now_ms THEN seen_clock.trusted ELSE clock.now_ms END AS now_ms
    FROM (SELECT CAST(unixepoch('subsec') * 1000 AS INTEGER) AS now_ms) AS clock
    LEFT JOIN seen_clock ON seen_clock.number = 1;
