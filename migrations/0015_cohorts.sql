-- Operated cases to learn from, as a resource of a tenant.

CREATE TABLE cohorts (
    id TEXT PRIMARY KEY,
    tenant TEXT NOT NULL,
    name TEXT NOT NULL,
    consent TEXT,                      -- JSON, of all members that state none of their own
    version BIGINT NOT NULL,           -- from 1 on; one more whenever a member leaves
    created BIGINT NOT NULL,
    updated BIGINT NOT NULL
);
CREATE INDEX cohorts_by_tenant ON cohorts (tenant, id);

-- A member leaves with its case and with its prediction.
CREATE TABLE cohort_members (
    cohort_id TEXT NOT NULL REFERENCES cohorts (id) ON DELETE CASCADE,
    number BIGINT NOT NULL,            -- from 1 on, as it was posted
    case_id TEXT NOT NULL REFERENCES cases (id) ON DELETE CASCADE,
    job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    mesh_id TEXT NOT NULL REFERENCES meshes (id),
    document TEXT NOT NULL,
    PRIMARY KEY (cohort_id, number)
);
CREATE INDEX cohort_members_by_case ON cohort_members (case_id);
CREATE INDEX cohort_members_by_job ON cohort_members (job_id);
CREATE INDEX cohort_members_by_mesh ON cohort_members (mesh_id);

-- Ids of the cases that left, and the version from which on the cohort is without them.
CREATE TABLE cohort_left (
    cohort_id TEXT NOT NULL REFERENCES cohorts (id) ON DELETE CASCADE,
    case_id TEXT NOT NULL,
    version BIGINT NOT NULL,
    PRIMARY KEY (cohort_id, case_id)
);

-- What was learned from which version. The id of a model stays where it was erased with a case.
CREATE TABLE cohort_models (
    cohort_id TEXT NOT NULL REFERENCES cohorts (id) ON DELETE CASCADE,
    job_id TEXT NOT NULL,
    version BIGINT NOT NULL,
    PRIMARY KEY (cohort_id, job_id)
);
CREATE INDEX cohort_models_by_job ON cohort_models (job_id);
