-- In which order the tags of a job were put on it, those that were put on again by the last time (src/store/job_tags.rs).
ALTER TABLE job_tags ADD COLUMN number BIGINT NOT NULL DEFAULT 0;
