-- What clients are told beside the rows themselves.

-- Every state that a job was seen in, as the stream of its events tells them.
CREATE TABLE job_events (
    job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    number BIGINT NOT NULL,            -- from 1, without gaps
    at BIGINT NOT NULL,
    status TEXT NOT NULL,
    phase TEXT,
    progress BIGINT NOT NULL,
    iteration BIGINT,
    residual DOUBLE PRECISION,
    attempt BIGINT NOT NULL,
    PRIMARY KEY (job_id, number)
);

-- The id that a request with an Idempotency-Key gives to what it makes, and what the request was.
CREATE TABLE idempotency_keys (
    key TEXT PRIMARY KEY,              -- a hash
    fingerprint TEXT NOT NULL,
    resource TEXT NOT NULL,
    created BIGINT NOT NULL
);
CREATE INDEX idempotency_keys_by_age ON idempotency_keys (created);

-- Ids of what was erased; nothing else is kept of it.
CREATE TABLE tombstones (
    id TEXT PRIMARY KEY,
    erased BIGINT NOT NULL
);
