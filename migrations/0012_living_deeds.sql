-- When the process that does it last said that it lives. A deed counts as unknown only where nobody has said so for an hour.
ALTER TABLE deeds ADD COLUMN alive BIGINT; -- ms since 1970 by the clock of the database; NULL: from an older program
