-- Who may call, on whose behalf, and what was done. What was there before belongs to the tenant `default`.

CREATE TABLE tenants (
    name TEXT PRIMARY KEY,
    served BIGINT NOT NULL,            -- the turn in which a job of it was claimed last; who waits longest is next
    retention_days BIGINT              -- how long what nobody changes is kept; NULL: until it is erased
);
INSERT INTO tenants (name, served) SELECT 'default', 0 WHERE EXISTS (SELECT 1 FROM jobs);

CREATE TABLE keys (
    id TEXT PRIMARY KEY,               -- the middle part of the key, no secret
    tenant TEXT NOT NULL REFERENCES tenants (name),
    label TEXT NOT NULL,
    hash TEXT NOT NULL,                -- of the whole key; the key itself is shown once and stored nowhere
    scopes TEXT NOT NULL,              -- of read, write, run, admin, separated by spaces
    created BIGINT NOT NULL,
    expires BIGINT,
    revoked BIGINT
);
CREATE INDEX keys_by_tenant ON keys (tenant, id);

ALTER TABLE meshes ADD COLUMN tenant TEXT NOT NULL DEFAULT 'default';
ALTER TABLE cases ADD COLUMN tenant TEXT NOT NULL DEFAULT 'default';
ALTER TABLE jobs ADD COLUMN tenant TEXT NOT NULL DEFAULT 'default';
ALTER TABLE jobs ADD COLUMN priority BIGINT NOT NULL DEFAULT 0;  -- the smallest first
ALTER TABLE tombstones ADD COLUMN tenant TEXT NOT NULL DEFAULT 'default';
CREATE INDEX meshes_by_tenant ON meshes (tenant, id);
CREATE INDEX cases_by_tenant ON cases (tenant, id);
CREATE INDEX jobs_by_tenant ON jobs (tenant, status, priority, id);

-- What was asked for that changes something, each row hashed with the hash of the row before it.
CREATE TABLE audit (
    number BIGINT PRIMARY KEY,         -- from 1 on, without a gap
    at BIGINT NOT NULL,
    tenant TEXT NOT NULL,
    actor TEXT NOT NULL,               -- the id of a key, or `command`
    action TEXT NOT NULL,              -- method and route, or the command
    object TEXT NOT NULL,              -- its id, where there is one
    outcome TEXT NOT NULL,             -- the HTTP status, or `done`
    request TEXT NOT NULL,             -- the id of the request
    hash TEXT NOT NULL
);
-- The number and the hash of its last row, which one writer at a time holds.
CREATE TABLE audit_end (one BIGINT PRIMARY KEY, number BIGINT NOT NULL, hash TEXT NOT NULL);
