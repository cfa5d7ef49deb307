"""A misspelt member of a document reaches the service, which refuses it by name: no silent default."""

import os

from facies_client import Refused, answered, connect
from facies_client.rest.api.jobs import create_job
from facies_client.rest.models import PredictDocument

service = connect(os.environ["FACIES_ADDRESS"], os.environ.get("FACIES_API_KEY"))

segment = {"name": "mandible", "translation_mm": [4, 0, 1], "rotation": [0, 5, 0]}
document = {"kind": "predict", "case": "any", "plan": {"segments": [segment]}}
try:
    answered(create_job.sync(client=service, body=PredictDocument.from_dict(document)))
except Refused as refused:
    print(refused)
else:
    raise SystemExit("a misspelt member was let through")
