-- Where in a trace a job was accepted (W3C Trace Context), so that its attempts continue it on whichever host.
ALTER TABLE jobs ADD COLUMN traceparent TEXT;
