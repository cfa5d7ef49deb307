-- Times are milliseconds since 1970 by the clock of the database, ids are UUIDv7 as text,
-- documents are JSON as text, hashes are SHA-256 in lower-case hexadecimal.

CREATE TABLE meshes (
    id TEXT PRIMARY KEY,
    sha256 TEXT NOT NULL,              -- of the bytes as uploaded
    options TEXT NOT NULL,             -- what the upload said about them: frame, units, scale
    blob TEXT NOT NULL,                -- of the bytes as stored, written by our own writer
    standalone BIGINT NOT NULL,        -- 0: came with a case and goes with it
    report TEXT NOT NULL,
    created BIGINT NOT NULL,
    UNIQUE (sha256, options)
);

CREATE TABLE cases (
    id TEXT PRIMARY KEY,
    document TEXT NOT NULL,
    report TEXT NOT NULL,
    version BIGINT NOT NULL,
    created BIGINT NOT NULL,
    updated BIGINT NOT NULL
);

CREATE TABLE case_tags (
    case_id TEXT NOT NULL REFERENCES cases (id) ON DELETE CASCADE,
    tag TEXT NOT NULL,
    PRIMARY KEY (case_id, tag)
);

CREATE TABLE case_meshes (
    case_id TEXT NOT NULL REFERENCES cases (id) ON DELETE CASCADE,
    mesh_id TEXT NOT NULL REFERENCES meshes (id),
    PRIMARY KEY (case_id, mesh_id)
);
CREATE INDEX case_meshes_by_mesh ON case_meshes (mesh_id);

CREATE TABLE plans (
    id TEXT PRIMARY KEY,
    case_id TEXT NOT NULL REFERENCES cases (id) ON DELETE CASCADE,
    document TEXT NOT NULL,
    version BIGINT NOT NULL,
    created BIGINT NOT NULL,
    updated BIGINT NOT NULL
);
CREATE INDEX plans_by_case ON plans (case_id);

CREATE TABLE jobs (
    id TEXT PRIMARY KEY,
    kind TEXT NOT NULL,
    case_id TEXT REFERENCES cases (id) ON DELETE CASCADE,
    document TEXT NOT NULL,            -- everything the job needs, resolved when it was accepted
    spec_hash TEXT NOT NULL UNIQUE,
    engine TEXT NOT NULL,
    status TEXT NOT NULL,              -- accepted, running, successful, failed, dismissed
    phase TEXT,
    progress BIGINT NOT NULL,          -- 0 to 100, never falls
    iteration BIGINT,
    residual DOUBLE PRECISION,
    attempt BIGINT NOT NULL,           -- claims so far
    losses BIGINT NOT NULL,            -- attempts that lost their worker or their storage
    claimable_from BIGINT NOT NULL,
    lease_token TEXT,                  -- new for each attempt; writes of another attempt touch no row
    lease_expires BIGINT,
    heartbeat BIGINT,
    error TEXT,
    result TEXT,
    created BIGINT NOT NULL,
    started BIGINT,
    finished BIGINT,
    updated BIGINT NOT NULL
);
CREATE INDEX jobs_by_status ON jobs (status, created, id);
CREATE INDEX jobs_by_case ON jobs (case_id);

CREATE TABLE job_tags (
    job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    tag TEXT NOT NULL,
    PRIMARY KEY (job_id, tag)
);

CREATE TABLE job_meshes (
    job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    mesh_id TEXT NOT NULL REFERENCES meshes (id),
    PRIMARY KEY (job_id, mesh_id)
);
CREATE INDEX job_meshes_by_mesh ON job_meshes (mesh_id);

CREATE TABLE job_files (
    job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    name TEXT NOT NULL,
    media_type TEXT NOT NULL,
    blob TEXT NOT NULL,
    bytes BIGINT NOT NULL,
    PRIMARY KEY (job_id, name)
);
CREATE INDEX job_files_by_blob ON job_files (blob);
CREATE INDEX meshes_by_blob ON meshes (blob);
