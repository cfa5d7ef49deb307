-- Places that somebody writes bytes to and has not referred to yet. Who dies there leaves the place to the sweep, also where
-- others have discarded it meanwhile.
CREATE TABLE unfinished_blobs (
    id TEXT PRIMARY KEY,
    place TEXT NOT NULL,
    begun BIGINT NOT NULL
);
