-- Where the bytes of a hash are. A place is made for one row and never used again (src/store/references.rs
-- says why); bytes that were stored before this step stay where they are.

CREATE TABLE blobs (
    sha256 TEXT PRIMARY KEY,
    place TEXT NOT NULL UNIQUE,
    announced BIGINT NOT NULL          -- when somebody last said that he is about to store these bytes
);
INSERT INTO blobs (sha256, place, announced)
    SELECT blob, substr(blob, 1, 2) || '/' || blob, 0
    FROM (SELECT blob FROM meshes UNION SELECT blob FROM job_files) AS referenced;

-- Places without a row, until their bytes are gone.
CREATE TABLE discarded_blobs (
    place TEXT PRIMARY KEY,
    discarded BIGINT NOT NULL
);
