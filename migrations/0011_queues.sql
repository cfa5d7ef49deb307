-- What a page of jobs and a claim need.

-- The revision of the numbers of the program that accepted a job; 0 where it did not say so yet. A program with a smaller
-- one leaves the job alone (src/store/engines.rs).
ALTER TABLE jobs ADD COLUMN numerics BIGINT NOT NULL DEFAULT 0;

-- The jobs of a tenant by age, with what a list may ask for.
CREATE INDEX jobs_by_age ON jobs (tenant, id, status, kind);

-- 1: what the id stands for was there before the request with this key.
ALTER TABLE idempotency_keys ADD COLUMN found BIGINT NOT NULL DEFAULT 0;
