"""Requests on their way to the service: the header with its key, and files piece by piece, so that they are never whole in
memory, with their progress."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from os import PathLike
from pathlib import Path
from typing import Any

Document = dict[str, Any]
Progress = Callable[[Document], object]
"""Called with every event of a job: `status`, `phase`, `progress` (0 to 100) and others; while a file is sent with the phase
`upload`, `file`, `sent_bytes` and `total_bytes`."""
File = str | PathLike[str]

PIECE_BYTES = 1 << 20


def authorization(key: str | None) -> dict[str, str]:
    """The header with a key, without the white space around it; raises `ValueError`, which does not show the key, where
    something in it cannot be in a header."""
    key = (key or "").strip()
    if not all("!" <= letter <= "~" for letter in key):
        raise ValueError("the key has white space within it, a control character or one beyond ASCII, as no key has")
    return {"Authorization": f"Bearer {key}"} if key else {}


class Sending:
    """The content of a file; it can be sent again."""

    def __init__(self, mesh: File | bytes, progress: Progress | None) -> None:
        self._mesh, self._progress = mesh, progress
        self.name = "" if isinstance(mesh, bytes) else Path(mesh).name
        self.total = len(mesh) if isinstance(mesh, bytes) else Path(mesh).stat().st_size

    def __iter__(self) -> Iterator[bytes]:
        sent = 0
        for piece in self._pieces():
            yield piece
            sent += len(piece)
            self._tell(sent)

    def _pieces(self) -> Iterator[bytes]:
        if isinstance(self._mesh, bytes):
            for start in range(0, self.total, PIECE_BYTES):
                yield self._mesh[start:start + PIECE_BYTES]
            return
        with Path(self._mesh).open("rb") as file:
            while piece := file.read(PIECE_BYTES):
                yield piece

    def _tell(self, sent: int) -> None:
        if self._progress is not None:
            share = 100 * sent // max(self.total, 1)
            self._progress({"phase": "upload", "file": self.name, "sent_bytes": sent,
                            "total_bytes": self.total, "progress": share})
