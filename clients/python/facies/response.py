"""A plan response: the columns of which the skin of every plan is a sum.

u = sum over segments s of C[12 s + 4 i + j] (R - I)_ij + C[12 s + 4 i + 3] t_i, where the segment moves as
x' = x + (R - I)(x - centre) + t. A response of order 2 adds, over pairs k <= l of these numbers a of all segments,
a_k a_l scale_mm[p] S[p].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .surface import Surface


def rigid(translation_mm: ArrayLike = (0, 0, 0), rotation_deg: ArrayLike = (0, 0, 0),
          pivot_mm: ArrayLike = (0, 0, 0)) -> NDArray[np.float64]:
    """The 4x4 matrix of a movement of a plan: rotations about x, then y, then z, through the pivot, then the translation."""
    a, b, c = np.radians(np.asarray(rotation_deg, dtype=np.float64))
    about_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    about_z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    pivot = np.asarray(pivot_mm, dtype=np.float64)
    matrix = np.eye(4)
    matrix[:3, :3] = about_z @ about_y @ about_x
    matrix[:3, 3] = np.asarray(translation_mm, dtype=np.float64) + pivot - matrix[:3, :3] @ pivot
    return matrix


@dataclass(frozen=True)
class Response:
    """The columns of a case as f32 [column][node][xyz] in mm; nodes and vertices of `rest` stand in the order of `node_ids`."""

    case: str
    job: str
    description: dict[str, Any]
    columns: NDArray[np.float32]
    rest: Surface
    second_order: NDArray[np.int16] | None = None
    """Of a response of order 2: [pair][node][xyz] in units of `description["second_order"]["scale_mm"]`."""

    @property
    def node_ids(self) -> NDArray[np.int64]:
        """Nodes of the volume mesh."""
        return np.array(self.description["node_ids"])

    def displacement_mm(self, movements: Mapping[str, ArrayLike], growth: Mapping[str, float] | None = None,
                        activations: Mapping[str, float] | None = None) -> NDArray[np.float64]:
        """How far each node of the skin goes where segments move by these 4x4 matrices (see `rigid`); others stay. `growth`:
        volume change by region, `activations`: stress in kPa by muscle, of those in `inner_columns` of the description.
        Without asking the service, whose `apply` also refuses plans beyond the limits and estimates what linearity leaves out."""
        segments = {segment["name"]: index for index, segment in enumerate(self.description["segments"])}
        if unknown := sorted(set(movements) - set(segments)):
            raise KeyError(f"the response moves {', '.join(segments)}, not {', '.join(unknown)}")
        coefficients = np.zeros(len(self.columns))
        for name, movement in movements.items():
            matrix = np.asarray(movement, dtype=np.float64)
            centre = np.array(self.description["segments"][segments[name]]["centre_mm"])
            turn = matrix[:3, :3] - np.eye(3)
            shift = matrix[:3, 3] + turn @ centre
            first = 12 * segments[name]
            coefficients[first:first + 12] = np.column_stack([turn, shift]).ravel()
        for column, amount in self._inner(growth or {}, activations or {}).items():
            coefficients[column] = amount
        displacement = np.asarray(np.tensordot(coefficients, self.columns, axes=1), dtype=np.float64)
        if self.second_order is not None:
            k, l = np.triu_indices(len(coefficients))
            factors = coefficients[k] * coefficients[l] * np.array(self.description["second_order"]["scale_mm"])
            for pair in np.flatnonzero(factors):
                displacement += factors[pair] * self.second_order[pair]
        return displacement

    def _inner(self, growth: Mapping[str, float], activations: Mapping[str, float]) -> dict[int, float]:
        """What the columns of growth and muscles are multiplied by, by their numbers."""
        columns = self.description.get("inner_columns", [])
        first = 12 * len(self.description["segments"])
        numbers = {(column["kind"], column["name"]): first + index for index, column in enumerate(columns)}
        strain = {region: np.cbrt(1 + change) - 1 for region, change in growth.items()}
        # A region beside `*` grows by that and by the rest.
        everywhere = strain.get("*", 0.0)
        amounts = {("growth", region): own if region == "*" else own - everywhere for region, own in strain.items()}
        amounts |= {("muscle", muscle): stress for muscle, stress in activations.items()}
        if unknown := sorted(set(amounts) - set(numbers)):
            raise KeyError(f"the response has columns of {sorted(numbers)}, not of {unknown}")
        return {numbers[key]: float(amount) for key, amount in amounts.items()}
