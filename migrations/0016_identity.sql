-- Which database this is: a store of blobs that is not in the data folder bears the same mark (src/store/owner.rs).
CREATE TABLE identity (
    number BIGINT PRIMARY KEY,         -- 1, so that there is one row
    id TEXT NOT NULL
);
