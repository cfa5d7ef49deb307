-- Meshes that a job made: they belong to it, and through it to its case, and go with the last of those that refer to them.
CREATE TABLE made_meshes (
    job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    mesh_id TEXT NOT NULL REFERENCES meshes (id),
    PRIMARY KEY (job_id, mesh_id)
);
CREATE INDEX made_meshes_by_mesh ON made_meshes (mesh_id);
