-- Cases whose mesh a job makes, and jobs that wait for it.

-- The job that makes or has made the mesh of a case; it may be removed once it has ended.
ALTER TABLE cases ADD COLUMN meshing TEXT;
CREATE INDEX cases_by_meshing ON cases (meshing);

-- The meshing that a job waits for; empty: none. It stays where that ended without a mesh.
ALTER TABLE jobs ADD COLUMN waits_for TEXT NOT NULL DEFAULT '';
-- Those that wait stand beside those that can be claimed, so that no claim passes over them.
DROP INDEX jobs_by_tenant;
CREATE INDEX jobs_by_tenant ON jobs (tenant, status, waits_for, priority, id);
