"""What a request may be refused for although its description allows it, because a schema cannot say it: what there is,
what happened before, what bytes are, and how the values of a document go together with each other, a mesh and the
limits of a deployment (`/v1/limits`). Everything else that is refused counts as a failure."""

import json

import schemathesis

# By the `code` of a problem.
REFUSALS = {
    "gone", "precondition-failed", "idempotency-mismatch",  # what happened before
    "unsupported-media-type", "malformed-multipart", "mesh-parse", "mesh-empty",  # what bytes are
    "format-not-available",  # what a mesh is
}
# How the reader of JSON begins where it meets another shape than it wants, which a schema has to say.
SHAPE = ("unknown field", "unknown word", "expected ")


@schemathesis.hook
def filter_failure(context, failure, case, response):
    """Whether a failure counts."""
    if "positive_data_acceptance" not in failure.checks:
        return True
    problem = json.loads(response.content)
    if "errors" in problem:
        return any(mistake["detail"].startswith(SHAPE) for mistake in problem["errors"])
    # A cursor is one that the service gave.
    return problem["code"] not in REFUSALS and problem.get("parameter") != "cursor"
