"""A plan response: the columns of which the skin of every plan is a sum.

u = sum over segments s of C[12 s + 4 i + j] (R - I)_ij + C[12 s + 4 i + 3] t_i, where the segment moves as
x' = x + (R - I)(x - centre) + t. A response of order 2 adds, over pairs k <= l of these numbers a of all segments,
a_k a_l scale_mm[p] S[p].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .surface import Surface


def finite(what: str, value: object, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Finite numbers in a shape. numpy alone reads text as numbers, and one number as three."""
    entries = np.asarray(value, dtype=object)
    are_numbers = all(isinstance(entry, Real) and not isinstance(entry, bool) and isfinite(entry) for entry in entries.flat)
    if entries.shape != shape or not are_numbers:
        wanted = f"{'x'.join(map(str, shape))} finite numbers" if shape else "a finite number"
        raise ValueError(f"`{what}`: {value!r} is not {wanted}")
    return entries.astype(np.float64)


def rigid(translation_mm: ArrayLike = (0, 0, 0), rotation_deg: ArrayLike = (0, 0, 0),
          pivot_mm: ArrayLike | None = None) -> NDArray[np.float64]:
    """The 4x4 matrix of a movement of a plan: rotations about x, then y, then z, through the pivot, then the translation.
    Raises `ValueError` where a rotation has no pivot, or something is not three finite numbers."""
    degrees, translation = finite("rotation_deg", rotation_deg, (3,)), finite("translation_mm", translation_mm, (3,))
    if pivot_mm is None and degrees.any():
        raise ValueError("`pivot_mm` is required where a rotation is not 0")
    pivot = finite("pivot_mm", (0, 0, 0) if pivot_mm is None else pivot_mm, (3,))
    a, b, c = np.radians(degrees)
    about_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    about_z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    matrix = np.eye(4)
    matrix[:3, :3] = about_z @ about_y @ about_x
    matrix[:3, 3] = translation + pivot - matrix[:3, :3] @ pivot
    return matrix


def checked(name: str, movement: ArrayLike) -> NDArray[np.float64]:
    """The matrix by which a segment moves, as the service takes `matrix4x4`: rigid to 1e-6, last row 0 0 0 1."""
    matrix = finite(name, movement, (4, 4))
    turn = matrix[:3, :3]
    is_rotation = np.abs(turn.T @ turn - np.eye(3)).max() <= 1e-6 and np.linalg.det(turn) > 0
    if not is_rotation or (matrix[3] != (0, 0, 0, 1)).any():
        raise ValueError(f"`{name}`: {movement!r} is not the matrix of a rigid movement, with a last row of 0 0 0 1 (see `rigid`)")
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
        Without asking the service, whose `apply` also refuses plans beyond the limits and estimates the linearisation error;
        raises `ValueError` where a matrix is not that of a rigid movement, or growth or stress is no finite number."""
        segments = {segment["name"]: index for index, segment in enumerate(self.description["segments"])}
        if unknown := sorted(set(movements) - set(segments)):
            raise KeyError(f"the response moves {', '.join(segments)}, not {', '.join(unknown)}")
        coefficients = np.zeros(len(self.columns))
        for name, movement in movements.items():
            matrix = checked(name, movement)
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
        strain = {region: np.cbrt(1 + finite(f"growth/{region}", change, ())) - 1 for region, change in growth.items()}
        # A region beside `*` grows by that and by the rest.
        everywhere = strain.get("*", 0.0)
        regions = self.description.get("regions", [])
        if "*" in strain and regions and set(regions) <= set(strain):
            raise KeyError(f"every region has growth of its own, and no cell is left to `*`: {sorted(regions)}")
        amounts = {("growth", region): own if region == "*" else own - everywhere for region, own in strain.items()}
        amounts |= {("muscle", muscle): finite(f"activations/{muscle}", stress, ()) for muscle, stress in activations.items()}
        if unknown := sorted(set(amounts) - set(numbers)):
            raise KeyError(f"the response has columns of {sorted(numbers)}, not of {unknown}")
        return {numbers[key]: float(amount) for key, amount in amounts.items()}
