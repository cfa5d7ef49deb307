-- A study may read several cases, and goes when one of them is erased.

CREATE TABLE job_cases (
    job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    case_id TEXT NOT NULL REFERENCES cases (id),
    PRIMARY KEY (job_id, case_id)
);
CREATE INDEX job_cases_by_case ON job_cases (case_id);
