"""Patience with a service that is busy or out of reach: how long to pause before the next attempt, and when to give up."""

from __future__ import annotations

import time

import httpx

BROKEN = (httpx.NetworkError, httpx.ProxyError, httpx.RemoteProtocolError, httpx.TimeoutException, httpx.DecodingError)
"""What httpx raises where a request gets no whole answer."""

# Between two attempts: also where something between us and the service says less, and however often it fails.
LEAST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 20.0


class Patience:
    """Attempts until the service answers, for so many seconds from the first that fails."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self.renew()

    def renew(self) -> None:
        """The service has answered: the next attempt that fails is the first again."""
        self._until: float | None = None
        self._next_s = LEAST_PAUSE_S

    def pause(self, told_s: float | None = None) -> bool:
        """Waits before the next attempt, as long as told, else twice as long each time. False, at once, where the time would be over."""
        pause_s = self._next_s if told_s is None else max(told_s, LEAST_PAUSE_S)
        self._next_s = min(2.0 * self._next_s, LONGEST_PAUSE_S)
        now = time.monotonic()
        self._until = now + self._seconds if self._until is None else self._until
        if now + pause_s > self._until:
            return False
        time.sleep(pause_s)
        return True
