-- What is being done that changes something. A row is here before the deed begins: what cannot be noted is not done.
-- Once it has ended, or nobody has told for an hour how it ended, it goes into the chain of the table `audit`.
CREATE TABLE deeds (
    id TEXT PRIMARY KEY,
    at BIGINT NOT NULL,
    tenant TEXT NOT NULL,
    actor TEXT NOT NULL,
    action TEXT NOT NULL,
    object TEXT NOT NULL,
    request TEXT NOT NULL,
    outcome TEXT                       -- NULL while it is done
);
