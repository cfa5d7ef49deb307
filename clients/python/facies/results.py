"""What the service made: cases, predictions, plans that were found, comparisons."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .surface import Surface


@dataclass(frozen=True)
class Case:
    """A stored case; `check` counts what holds its nodes, or is `None` where it takes a plan to tell. `spec` is what its file
    says of how it is computed: members of every job of the case, unless a call states others."""

    id: str
    document: dict[str, Any]
    check: dict[str, Any] | None
    spec: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, repr=False)
class Prediction:
    """A predicted skin; `results` is `result.json` (statistics, reactions, provenance, files)."""

    job: str
    skin: Surface
    results: dict[str, Any]

    @property
    def displacement_mm(self) -> NDArray[np.float32]:
        """A row for each vertex of the skin."""
        return self.skin.values["_DISPLACEMENT_MM"]

    @property
    def numerical_error_mm(self) -> NDArray[np.float32] | None:
        """For each vertex of the skin how much the mesh is estimated to leave out; `None` where that is not known, and
        `results["numerical_error_unknown"]` says why."""
        return self.skin.values.get("_NUMERICAL_ERROR_MM")

    @property
    def rest_mm(self) -> NDArray[np.float64]:
        """Where each vertex was before."""
        return self.skin.points_mm - self.displacement_mm

    @property
    def warnings(self) -> list[dict[str, Any]]:
        """What a reader of these numbers must know, each with its `code`."""
        warnings: list[dict[str, Any]] = self.results["warnings"]
        return warnings

    def __repr__(self) -> str:
        codes = ", ".join(warning["code"] for warning in self.warnings)
        return f"{type(self).__name__}(job={self.job!r}, {len(self.skin.points_mm)} points of skin, warnings: {codes or 'none'})"


@dataclass(frozen=True, repr=False)
class Optimisation(Prediction):
    """A plan that was found, with the skin that it gives."""

    @property
    def found(self) -> dict[str, Any]:
        """Residuals, standard errors, what is at a bound, what the targets do not determine."""
        found: dict[str, Any] = self.results["optimisation"]
        return found

    @property
    def plan(self) -> dict[str, Any]:
        """As `predict` takes it."""
        plan: dict[str, Any] = self.found["plan"]
        return plan


@dataclass(frozen=True)
class Applied:
    """A plan on a response, as the service computes it; `document` has all else that it says of it."""

    displacement_mm: NDArray[np.float32]
    """A row for each node of the skin, in the order of `node_ids`."""
    document: dict[str, Any]

    @property
    def warnings(self) -> list[dict[str, Any]]:
        """What a reader of these numbers must know, each with its `code`."""
        warnings: list[dict[str, Any]] = self.document["warnings"]
        return warnings

    @property
    def nonlinearity_estimate_mm(self) -> float | None:
        """What the displacement leaves out, mean over the skin that moves; None where that is not known, as with growth and muscles."""
        estimate: float | None = self.document.get("nonlinearity_estimate_mm")
        return estimate

    @property
    def within_linear_range(self) -> bool | None:
        """False where that is more than the service takes for small; None where it is not known."""
        within: bool | None = self.document["within_linear_range"]
        return within


@dataclass(frozen=True)
class Comparison:
    """Distances between two surfaces; `document` has them in both directions, by region and node by node."""

    job: str
    document: dict[str, Any]
    warnings: list[dict[str, Any]]
    """What a reader of these numbers must know, each with its `code`: a scan that is mirrored, apart, or of another person."""

    @property
    def both(self) -> dict[str, Any]:
        """Both directions together: `mean`, `p95`, `max` and others, in mm."""
        both: dict[str, Any] = self.document["both"]
        return both
