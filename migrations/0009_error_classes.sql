-- What kind of thing went wrong: the member `class` of the error of a job that failed, by which lost jobs are found.
ALTER TABLE jobs ADD COLUMN error_class TEXT;
-- Errors were stored without spaces between their words, and a quotation mark within a text of theirs has a backslash
-- before it, so that these words are found as a member only.
UPDATE jobs SET error_class = CASE
    WHEN error LIKE '%"class":"infrastructure"%' THEN 'infrastructure'
    WHEN error LIKE '%"class":"numerical"%' THEN 'numerical'
    WHEN error LIKE '%"class":"input"%' THEN 'input'
    WHEN error LIKE '%"class":"budget"%' THEN 'budget'
    WHEN error LIKE '%"class":"cancelled"%' THEN 'cancelled'
END WHERE status = 'failed';
CREATE INDEX jobs_by_error_class ON jobs (error_class, id);
