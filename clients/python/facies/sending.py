"""Requests on their way to the service: the header with its key, which no exception shows, and files piece by piece, so that
they are never whole in memory, with their progress."""

from __future__ import annotations

import base64
import html
import json
import re
import urllib.parse
from collections.abc import Callable, Iterator
from os import PathLike
from pathlib import Path
from typing import Any

import httpx

Document = dict[str, Any]
Progress = Callable[[Document], object]
"""Called with every event of a job: `status`, `phase`, `progress` (0 to 100) and others; while a file is sent with the phase
`upload`, `file`, `sent_bytes` and `total_bytes`."""
File = str | PathLike[str]

PIECE_BYTES = 1 << 20
# The user and the password in an address, wherever it is in a text.
USER = re.compile(r"(?<=://)[^/?#\s]*@")


def authorization(key: str | None) -> dict[str, str]:
    """The header with a key, without the white space around it; raises `ValueError`, which does not show the key, where
    something in it cannot be in a header."""
    key = (key or "").strip()
    if not all("!" <= letter <= "~" for letter in key):
        raise ValueError("the key has white space within it, a control character or one beyond ASCII, as no key has")
    return {"Authorization": f"Bearer {key}"} if key else {}


class Secrets:
    """What no exception shows: a key, and the user and password of an address."""

    def __init__(self, address: str, key: str | None) -> None:
        url = httpx.URL(address)
        of_header = base64.b64encode(f"{url.username}:{url.password}".encode()).decode() if url.userinfo else ""
        forms: set[str] = set()
        # Also as HTML, JSON and addresses have them.
        for secret in ((key or "").strip(), url.password, of_header):
            forms |= {secret, html.escape(secret), json.dumps(secret)[1:-1], urllib.parse.quote(secret, safe="")}
        self._forms = sorted(forms - {""}, key=len, reverse=True)

    def hidden(self, said: Any) -> Any:
        """A text, or a document with all its texts, with *** in place of secrets, and addresses without user and password."""
        if isinstance(said, dict):
            return {name: self.hidden(member) for name, member in said.items()}
        if isinstance(said, list):
            return [self.hidden(member) for member in said]
        if isinstance(said, str):
            said = USER.sub("", said)
            for form in self._forms:
                said = said.replace(form, "***")
        return said

    def why(self, error: BaseException) -> str:
        """What an exception says, without secrets, as it and its causes say it from then on."""
        of_chain: BaseException | None = error
        while of_chain is not None:
            of_chain.args = tuple(self.hidden(list(of_chain.args)))
            of_chain = of_chain.__cause__ or of_chain.__context__
        return str(error) or type(error).__name__


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
