"""Ten calls: upload, make a case, predict, download the skin, compare it, study methods."""

import os

from facies_client import WAIT, answered, connect, ended, present
from facies_client.rest.api.cases import create_case
from facies_client.rest.api.jobs import create_job, download_result, show_report
from facies_client.rest.api.meshes import upload_mesh
from facies_client.rest.models import CaseDocument, CompareDocument, PredictDocument, StudyDocument
from facies_client.rest.types import File

service = connect(os.environ["FACIES_ADDRESS"], os.environ.get("FACIES_API_KEY"))

with open("examples/block/block.vtu", "rb") as block:
    mesh = answered(upload_mesh.sync(client=service, body=File(block), units="mm", frame="LPS"))
document = {"units": "mm", "frame": "LPS", "volume": mesh.id, "fixed": [{"node_set": "skull"}],
            "segments": [{"name": "mandible", "nodes": {"node_set": "mandible"}}]}
case = answered(create_case.sync(client=service, body=CaseDocument.from_dict(document)))

plan = {"segments": [{"name": "mandible", "translation_mm": [4, 0, 1]}]}
predict = PredictDocument.from_dict({"kind": "predict", "case": case.id, "plan": plan})
job = ended(service, answered(create_job.sync(client=service, body=predict, prefer=WAIT)))
movement = present(present(job.results).statistics).skin.area
print(f"the skin moves {movement.mean:.2f} mm on average, {movement.max_:.2f} mm at most")

skin = answered(download_result.sync(job.id, "skin.vtp", client=service)).payload
actual = answered(upload_mesh.sync(client=service, body=File(skin), units="mm", frame="LPS"))
compare = CompareDocument.from_dict(
    {"kind": "compare", "prediction": {"job": job.id}, "actual": {"mesh": actual.id}})
job = ended(service, answered(create_job.sync(client=service, body=compare, prefer=WAIT)))
distance = present(present(job.results).comparison).both
print(f"prediction and downloaded skin are {distance.max_:.4f} mm apart at most")

study = StudyDocument.from_dict(
    {"kind": "study", "scenes": ["slab"], "plans": ["patch 2 mm"], "methods": ["fem_linear"],
     "elements": ["plain", "stabilised"], "truth": {"refine": 1, "element": "stabilised"}, "repeats": 1})
job = ended(service, answered(create_job.sync(client=service, body=study, prefer=WAIT)))
report = answered(show_report.sync(job.id, client=service))
print(f"the study has {len(report.rows)} rows, and its outcome is {report.verdict.outcome}")
