-- When this deployment was last seen to run, by which retention tells a clock that is far ahead (src/store/seen_clock.rs).
CREATE TABLE seen_clock (
    number BIGINT PRIMARY KEY,         -- 1, so that there is one row
    trusted BIGINT NOT NULL,           -- newest time that is not doubted
    latest BIGINT NOT NULL,
    doubted BIGINT                     -- from when on the clock has been far ahead; NULL where it is not
);
