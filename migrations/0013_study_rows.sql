-- The key of the rows of a study (src/schema/hashes.rs): another with the same one takes them and judges them anew.
ALTER TABLE jobs ADD COLUMN rows_key TEXT;
-- What its truths are expected to take, as JSON.
ALTER TABLE jobs ADD COLUMN truths TEXT;
CREATE INDEX jobs_by_rows ON jobs (rows_key);
