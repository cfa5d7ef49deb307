"""A deployment of facies on this machine, as child processes: one server on SQLite, or API, workers and a private
PostgreSQL. For the programs in this folder and for `tests/chaos/soak`."""

import glob
import http.client
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time

QUIET = ["--lease-s", "2", "--heartbeat-s", "0.5", "--free-space-floor-mib", "0"]


class Refused(Exception):
    """An answer that is no success."""

    def __init__(self, status, text, headers):
        super().__init__(f"{status}: {text}")
        self.status, self.headers = status, headers


def call(address, method, path, body=None, headers=(), timeout=60):
    """One request on a connection of its own; JSON where the answer is JSON, else bytes."""
    host, port = address.rsplit(":", 1)
    connection = http.client.HTTPConnection(host, int(port), timeout=timeout)
    try:
        connection.request(method, path, body, dict(headers))
        answer = connection.getresponse()
        text = answer.read()
        if answer.status >= 300:
            raise Refused(answer.status, text.decode(errors="replace"), answer.headers)
        return json.loads(text) if "json" in (answer.headers["content-type"] or "") else text
    finally:
        connection.close()


def post(address, path, document, **headers):
    headers = {name.replace("_", "-"): value for name, value in headers.items()}
    return call(address, "POST", path, json.dumps(document), {"content-type": "application/json", **headers})


def block(cells, title="block"):
    """A block of 60 x 60 x 30 mm of hexahedra as legacy VTK, with the node sets `bottom` and `top`."""
    places = range(cells + 1)
    points = [(60 * x / cells, 60 * y / cells, 30 * z / cells) for z in places for y in places for x in places]
    node = lambda x, y, z: x + (cells + 1) * (y + (cells + 1) * z)
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corners = [(x, y, z) for z in (0, 1) for x, y in ring]
    steps = range(cells)
    hexahedra = [[node(x + i, y + j, z + k) for i, j, k in corners] for z in steps for y in steps for x in steps]
    lines = ["# vtk DataFile Version 3.0", title, "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines += [f"POINTS {len(points)} double"] + ["%r %r %r" % point for point in points]
    lines += [f"CELLS {len(hexahedra)} {9 * len(hexahedra)}"] + ["8 " + " ".join(map(str, h)) for h in hexahedra]
    lines += [f"CELL_TYPES {len(hexahedra)}"] + ["12"] * len(hexahedra) + [f"POINT_DATA {len(points)}"]
    for name, height in (("bottom", 0), ("top", 30)):
        lines += [f"SCALARS set_{name} int 1", "LOOKUP_TABLE default"]
        lines += ["1" if point[2] == height else "0" for point in points]
    return "\n".join(lines) + "\n"


def new_case(address, cells=4, name="a block", **headers):
    """A case with a block fixed at its top, whose bottom is the segment `bone`; its id."""
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    mesh = call(
        address, "POST", "/v1/meshes?allow_any_scale=true", block(cells, name), {"content-type": "application/vnd.vtk", **named}
    )
    document = {
        "schema": 1, "units": "mm", "name": name, "volume": mesh["id"],
        "segments": [{"name": "bone", "nodes": {"node_set": "bottom"}}], "fixed": [{"node_set": "top"}],
    }
    return post(address, "/v1/cases", document, **headers)["id"]


def predict(case, x):
    plan = {"segments": [{"name": "bone", "translation_mm": [x, 0, 0]}]}
    return {"kind": "predict", "case": case, "plan": plan}


def resident_kb(process):
    """Memory of a process and its children, in KiB."""
    total = 0
    for status in glob.glob("/proc/[0-9]*/status"):
        try:
            fields = dict(line.split(":", 1) for line in open(status) if ":" in line)
        except OSError:
            continue
        if int(fields["Pid"]) == process or int(fields["PPid"]) == process:
            total += int(fields.get("VmRSS", "0 kB").split()[0])
    return total


class Cluster:
    """A private PostgreSQL."""

    def __init__(self, folder):
        self.folder = os.path.join(folder, "pg")
        binaries = sorted(glob.glob("/usr/lib/postgresql/*/bin"))
        self.control_program = os.path.join(binaries[-1], "pg_ctl") if binaries else shutil.which("pg_ctl")
        os.makedirs(self.folder)
        self.user = []
        if os.getuid() == 0:
            # It refuses to run as root.
            os.chmod(folder, 0o711)
            shutil.chown(self.folder, "nobody")
            self.user = ["runuser", "-u", "nobody", "--"]
        initdb = os.path.join(os.path.dirname(self.control_program), "initdb")
        self.run(initdb, "-D", self.folder, "--no-sync", "-A", "trust", "-U", "postgres", "-E", "UTF8")
        self.control("start")
        psql = os.path.join(os.path.dirname(self.control_program), "createdb")
        self.run(psql, "-h", self.folder, "-U", "postgres", "facies")
        self.address = f"postgres://postgres@localhost/facies?host={self.folder}"

    def run(self, *arguments):
        done = subprocess.run([*self.user, *arguments], cwd="/", capture_output=True, text=True)
        if done.returncode:
            raise SystemExit(f"{arguments[0]}: {done.stderr}")

    def control(self, *arguments):
        options = f"-c listen_addresses= -k {self.folder} -N 200"
        log = os.path.join(self.folder, "log")
        self.run(self.control_program, "-D", self.folder, "-w", "-l", log, "-o", options, *arguments)


class Process:
    """A `serve` or `worker`, with a log of its own that goes on over its lives."""

    def __init__(self, binary, name, folder, arguments, environment=None):
        self.binary, self.name, self.arguments = binary, name, arguments
        self.log = os.path.join(folder, f"{name}.log")
        self.data = os.path.join(folder, name)
        self.environment = {**os.environ, **(environment or {})}
        self.address = None
        self.start()

    def start(self):
        port = self.address or "127.0.0.1:0"
        bind = ["--bind", port] if self.arguments[0] == "serve" else []
        command = [self.binary, *self.arguments, *bind, "--data", self.data]
        self.errors = open(self.log, "a")
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=self.errors, text=True, env=self.environment
        )
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"{self.name} did not start: {open(self.log).read()[-2000:]}")
        if "http://" in line:
            self.address = line.split("http://")[1].strip()
        self.started = time.monotonic()

    def kill(self):
        self.process.send_signal(signal.SIGCONT)
        self.process.kill()
        self.process.wait()

    def terminate(self):
        self.process.terminate()
        self.process.wait(60)


class Deployment:
    """What is served from a folder."""

    def __init__(self, binary, postgresql, workers, settings=(), admin_key=None):
        self.folder = tempfile.mkdtemp(prefix="facies-")
        self.binary = binary
        self.cluster = None
        self.workers = []
        settings = [*QUIET, *settings]
        self.admin_key = admin_key
        if admin_key:
            settings += ["--admin-bind", "127.0.0.1:0", "--admin-key", admin_key]
        if postgresql:
            self.cluster = Cluster(self.folder)
            os.makedirs(os.path.join(self.folder, "blobs"))
            self.environment = {"FACIES_DATABASE": self.cluster.address, "FACIES_BLOBS": os.path.join(self.folder, "blobs")}
            self.command("migrate")
            serve = ["serve", "--workers", "0", *settings]
            self.api = Process(binary, "api", self.folder, serve, self.environment)
            hosts = 2
            for host in range(hosts):
                arguments = ["worker", "--workers", str(max(1, workers // hosts)), *QUIET]
                self.workers.append(Process(binary, f"worker-{host}", self.folder, arguments, self.environment))
        else:
            self.environment = {}
            serve = ["serve", "--workers", str(workers), *settings]
            self.api = Process(binary, "api", self.folder, serve)

    def key(self, tenant):
        """A key of a tenant that allows everything."""
        if not hasattr(self, "office"):
            self.office = self.api.process.stdout.readline().split("http://")[1].split("/")[0]
        wanted = {"label": "load", "scopes": ["read", "write", "run", "admin"]}
        authorization = f"Bearer {self.admin_key}"
        return post(self.office, f"/tenants/{tenant}/keys", wanted, authorization=authorization)["key"]

    @property
    def address(self):
        return self.api.address

    def processes(self):
        return [self.api, *self.workers]

    def command(self, *arguments):
        """Runs a command of the program on the deployment; what it printed."""
        data = ["--data", os.path.join(self.folder, "api" if not self.cluster else "command")]
        done = subprocess.run(
            [self.binary, *arguments, *data], env={**os.environ, **self.environment}, capture_output=True, text=True
        )
        if done.returncode:
            raise RuntimeError(f"facies {' '.join(arguments)}: {done.stdout}{done.stderr}")
        return done.stdout

    def stop(self):
        for process in self.processes():
            if process.process.poll() is None:
                process.process.send_signal(signal.SIGCONT)
                process.terminate()

    def remove(self):
        for process in self.processes():
            if process.process.poll() is None:
                process.kill()
        if self.cluster:
            self.cluster.control("stop", "-m", "immediate")
        shutil.rmtree(self.folder, ignore_errors=True)
