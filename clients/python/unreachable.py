"""What `facies` does while a service is away: a server of its own breaks off and comes back, and no pause takes any time."""

import http.server
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any, cast
from unittest import mock

import httpx

from facies import Facies, FaciesError, Refused, Unreachable, patience
from facies.sending import Document
from facies_client import connect, ended
from facies_client.rest.models import StatusInfo

JOB = "01890000-0000-7000-8000-000000000000"
PATH = f"/v1/jobs/{JOB}"
BREAKS = ": breaks\n\n"
NO_GZIP = "no gzip"
# In what the server says: the header that it was sent.
ECHO = "ECHO"
KEY, PASSWORD = "fcs_a/secret&key", "a%2Fpassword"


class Broken(http.server.BaseHTTPRequestHandler):
    """Answers each request with the next of what is to be said: lines of a stream or another text, a status, both, bytes that are no
    answer, or `None` for a closed connection."""

    said: list[Any] = []
    asked: list[tuple[str, str | None]] = []

    def do_GET(self) -> None:
        self.rfile.read(int(self.headers.get("Content-Length") or 0))
        self.asked.append((self.command, self.headers.get("Last-Event-ID")))
        said = self.said.pop(0) if len(self.said) > 1 else self.said[0]
        self.close_connection = True
        if said is None:
            return
        sent = self.headers.get("Authorization", "")
        if isinstance(said, bytes):
            self.wfile.write(said.replace(ECHO.encode(), sent.encode()))
            return
        status, lines = said if isinstance(said, tuple) else (said, "") if isinstance(said, int) else (200, said)
        lines = lines.replace(ECHO, sent)
        self.send_response(status)
        self.send_header("Content-Type", "text/event-stream")
        if lines == NO_GZIP:
            self.send_header("Content-Encoding", "gzip")
        # A stream that has not all that it promises breaks.
        self.send_header("Content-Length", str(len(lines) + 9 * lines.endswith(BREAKS)))
        self.end_headers()
        self.wfile.write(lines.encode())

    do_POST = do_GET

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing."""


class Clock:
    """A clock that goes on by pauses alone."""

    def __init__(self) -> None:
        self.now = 0.0
        self.pauses: list[float] = []

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.pauses.append(seconds)
        self.now += seconds


def line(number: int, status: str) -> str:
    return f'data: {{"number": {number}, "status": "{status}"}}\n\n'


@contextmanager
def saying(*said: Any, key: str | None = None, user: str = "") -> Iterator[tuple[Facies, Clock]]:
    """A client of a server that says this, the last of it again and again; `user` goes before the address of the server."""
    Broken.said, Broken.asked = list(said), []
    clock = Clock()
    with http.server.HTTPServer(("127.0.0.1", 0), Broken) as server, mock.patch.object(patience, "time", clock):
        threading.Thread(target=server.serve_forever).start()
        with Facies(f"http://{user}127.0.0.1:{server.server_port}", key, patience_s=60.0) as service:
            yield service, clock
        server.shutdown()


def lost(service: Facies, method: str, path: str, **request: Any) -> Unreachable:
    """The exception of a request that gets no answer."""
    try:
        service.ask(method, path, **request)
    except Unreachable as away:
        assert isinstance(away.__cause__, patience.BROKEN), away.__cause__
        return away
    sys.exit(f"{method} {path} was answered")


# A stream is taken up behind the last event, at whatever point it broke; one that ends with its job is not waited for.
begun, end = line(1, "running"), line(2, "running") + line(3, "successful")
with saying(begun + BREAKS, None, 503, "retry: 2000\n\n", end, 204) as (service, clock):
    told = [event["number"] for event in service.events(JOB)]
assert told == [1, 2, 3], told
assert [last for _, last in Broken.asked] == ["0", "1", "1", "1", "1", "3"], Broken.asked
assert clock.pauses == [1.0, 2.0, 4.0, 8.0], clock.pauses

# So is one that ends within an event, as if that had been all of it, or cannot be read.
half = line(2, "running")[:-9]
with saying(begun + half, f"{half}\n{line(3, 'successful')}", NO_GZIP, end, 204) as (service, clock):
    told = [event["number"] for event in service.events(JOB)]
assert (told, clock.pauses) == ([1, 2, 3], [1.0, 2.0, 4.0]), (told, clock.pauses)
assert [last for _, last in Broken.asked] == ["0", "1", "1", "1", "3"], Broken.asked
for said in (half, NO_GZIP):
    with saying(said) as (service, clock):
        try:
            list(service.events(JOB))
            sys.exit("a stream of which nothing comes has ended")
        except Unreachable as away:
            assert away.job == JOB and clock.pauses == [1.0, 2.0, 4.0, 8.0, 16.0, 20.0], clock.pauses

# Where something keeps what was said, it is told once.
with saying(begun + line(2, "successful")) as (service, clock):
    once = []
    try:
        for event in service.events(JOB):
            once.append(event["number"])
        sys.exit("a stream of which nothing comes has ended")
    except Unreachable as away:
        assert (once, away.job) == ([1, 2], JOB) and clock.pauses == [1.0, 2.0, 4.0, 8.0, 16.0, 20.0], (once, clock.pauses)

# Pauses grow to a bound, and the last exception names the job; the silence of a stream is counted from its last sign of life.
with saying(begun, ": alive\n\n", None) as (service, clock):
    events: list[Document] = []
    try:
        for event in service.events(JOB):
            events.append(event)
        sys.exit("a stream that never comes back has ended")
    except Unreachable as away:
        assert (away.job, away.code, len(events)) == (JOB, "unreachable", 1) and JOB in str(away), away
assert clock.pauses == [1.0, 1.0, 2.0, 4.0, 8.0, 16.0, 20.0], clock.pauses

# One that is refused, or for which there is no place for all that time, says so.
for status, requests in {404: 1, 503: 7}.items():
    with saying(status) as (service, clock):
        try:
            list(service.events(JOB))
            sys.exit(f"{status} was let through")
        except Refused as refused:
            assert (refused.status, len(Broken.asked)) == (status, requests), Broken.asked

# A request that reads is sent again, one that may change something is not, unless the service knows it by its key.
with saying(None, 502, 200) as (service, clock):
    assert service.ask("GET", PATH).is_success and clock.pauses == [1.0, 2.0]
with saying(None, 200) as (service, clock):
    assert service.ask("POST", "/v1/jobs", json={}, headers={"idempotency-key": "a"}).is_success
with saying(None) as (service, clock):
    assert (lost(service, "POST", "/v1/jobs", json={}).job, len(Broken.asked)) == (None, 1), Broken.asked
    assert lost(service, "GET", f"{PATH}/results/skin.glb").job == JOB and len(Broken.asked) == 8, Broken.asked
    assert lost(service, "GET", "/readyz").job is None

# An answer that cannot be read is none, and one that is no document is not of the service.
with saying(NO_GZIP, "{}") as (service, clock):
    assert service.ask("GET", PATH).text == "{}" and clock.pauses == [1.0]
with saying(NO_GZIP) as (service, clock):
    assert isinstance(lost(service, "POST", "/v1/jobs", json={}).__cause__, httpx.DecodingError)
asks: list[Callable[[Facies], object]] = [
    lambda service: service.run({}), lambda service: service.case({}), lambda service: service.upload(b"mesh")]
for said in ("<html>welcome</html>", '{"id": "0189', "", "[]"):
    for asks_for in asks:
        with saying(said) as (service, clock):
            try:
                asks_for(service)
                sys.exit(f"{said!r} was taken for a document")
            except Refused as refused:
                assert (refused.code, refused.status, len(Broken.asked)) == ("not-of-the-service", 200, 1), refused
                assert said in refused.detail, refused

# No exception shows a key, or the user and password of an address, whatever something between us and the service sends back.
problem = '{"status": 403, "code": "forbidden", "detail": "no: ECHO", "errors": [{"pointer": "", "detail": "ECHO"}]}'
echoes: list[Any] = [
    (403, f"denied: {ECHO}"), (403, 180 * "x" + ECHO), (403, problem), f"<p>{ECHO}</p>", f"denied {ECHO}\r\n\r\n".encode()]
for echo in echoes:
    for sender in ({"key": KEY}, {"user": f"somebody:{PASSWORD}@"}):
        with saying(echo, **sender) as (service, clock):
            try:
                service.run({})
                sys.exit("a refusal was let through")
            except FaciesError as error:
                shown = "".join(traceback.format_exception(error)) + repr(getattr(error, "problem", ""))
                sent = service._http.headers.get("Authorization", httpx.BasicAuth("somebody", "a/password")._auth_header)
                for secret in (KEY, KEY[:9], "password", "somebody", sent.split()[-1][:9]):
                    assert secret not in shown, shown
                assert "***" in shown, shown
with saying(echoes[-1]) as (service, clock):
    running = cast(StatusInfo, SimpleNamespace(id=JOB, status="running"))
    try:
        ended(connect(str(service._http.base_url), KEY), running, patience_s=5.0)
        sys.exit("a job that nobody tells of has ended")
    except Unreachable as away:
        shown = "".join(traceback.format_exception(away))
        assert "***" in shown and KEY not in shown, shown

# The same of the typed client.
with saying(None) as (service, clock):
    running = cast(StatusInfo, SimpleNamespace(id=JOB, status="running"))
    try:
        ended(connect(str(service._http.base_url)), running, patience_s=5.0)
        sys.exit("a job that nobody tells of has ended")
    except Unreachable as away:
        assert (away.job, clock.pauses) == (JOB, [1.0, 2.0]), clock.pauses
print("a service that is away is waited for")
