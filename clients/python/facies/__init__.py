"""A facies service for people who plan and compute: cases, predictions and plan responses as numpy arrays.

    from facies import Facies

    service = Facies("http://127.0.0.1:8080")
    prediction = service.predict("examples/head/case.json", {"segments": [...]}, progress=print)
    prediction.displacement_mm          # one row for each vertex of prediction.skin

Lengths are mm in the frame of the case. Arrays of surfaces come as f32 (a relative error of 6e-8).
Documents are dictionaries as docs/case.md shows them. `facies_client` beside this package has every operation, typed.
"""

from .errors import FaciesError, JobFailed, Refused, Unreachable
from .response import Response, rigid
from .results import Applied, Case, Comparison, Optimisation, Prediction
from .service import Facies
from .surface import Surface

__all__ = ["Applied", "Case", "Comparison", "Facies", "FaciesError", "JobFailed", "Optimisation", "Prediction",
           "Refused", "Response", "Surface", "Unreachable", "rigid"]
