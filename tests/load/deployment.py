"""A deployment of facies on this machine, as child processes: one server on SQLite, or APIs, workers and a private
PostgreSQL. For the programs in this folder and in `tests/chaos`."""

import glob
import http.client
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time

ENDED = ("successful", "failed", "dismissed")
UNREACHABLE = (OSError, http.client.HTTPException)

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


def hexahedra(counts, size, sets, title="block"):
    """A block as legacy VTK: how many hexahedra and how many mm along x, y, z; node sets by a test of (x, y, z)."""
    nx, ny, nz = counts
    ticks = [[length * k / count for k in range(count + 1)] for length, count in zip(size, counts)]
    points = [(x, y, z) for z in ticks[2] for y in ticks[1] for x in ticks[0]]
    node = lambda x, y, z: x + (nx + 1) * (y + (ny + 1) * z)
    corners = [(x, y, z) for z in (0, 1) for x, y in [(0, 0), (1, 0), (1, 1), (0, 1)]]
    cells = [
        [node(x + i, y + j, z + k) for i, j, k in corners] for z in range(nz) for y in range(ny) for x in range(nx)
    ]
    lines = ["# vtk DataFile Version 3.0", title, "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines += [f"POINTS {len(points)} double"] + ["%r %r %r" % point for point in points]
    lines += [f"CELLS {len(cells)} {9 * len(cells)}"] + ["8 " + " ".join(map(str, cell)) for cell in cells]
    lines += [f"CELL_TYPES {len(cells)}"] + ["12"] * len(cells) + [f"POINT_DATA {len(points)}"]
    for name, inside in sets.items():
        lines += [f"SCALARS set_{name} int 1", "LOOKUP_TABLE default"]
        lines += ["1" if inside(*point) else "0" for point in points]
    return "\n".join(lines) + "\n"


def block(cells, title="block"):
    """60 x 60 x 30 mm with the node sets `bottom` and `top`."""
    sets = {"bottom": lambda x, y, z: z == 0, "top": lambda x, y, z: z == 30}
    return hexahedra([cells] * 3, (60, 60, 30), sets, title)


def new_case(address, cells=4, name="a block", **headers):
    """A case with a block fixed at its top, whose bottom is the segment `bone`; its id."""
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    mesh = call(
        address, "POST", "/v1/meshes?allow_any_scale=true", block(cells, name),
        {"content-type": "application/vnd.vtk", **named},
    )
    document = {
        "schema": 1, "units": "mm", "name": name, "volume": mesh["id"],
        "segments": [{"name": "bone", "nodes": {"node_set": "bottom"}}], "fixed": [{"node_set": "top"}],
    }
    return post(address, "/v1/cases", document, **headers)["id"]


def predict(case, x):
    plan = {"segments": [{"name": "bone", "translation_mm": [x, 0, 0]}]}
    return {"kind": "predict", "case": case, "plan": plan}


def percentile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))] if values else 0.0


def statuses():
    """The fields of each process of this machine."""
    for file in glob.glob("/proc/[0-9]*/status"):
        try:
            yield dict(line.split(":", 1) for line in open(file) if ":" in line)
        except OSError:
            continue


def children(process):
    return [int(fields["Pid"]) for fields in statuses() if int(fields["PPid"]) == process]


def resident_kb(process):
    """Memory of a process and its children, in KiB."""
    own = [fields for fields in statuses() if process in (int(fields["Pid"]), int(fields["PPid"]))]
    return sum(int(fields.get("VmRSS", "0 kB").split()[0]) for fields in own)


class Cluster:
    """A private PostgreSQL, on a socket and, where other hosts are to reach it, on an address of their network."""

    def __init__(self, folder, listen="", network=None):
        self.listen = listen
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
        if network:
            with open(os.path.join(self.folder, "pg_hba.conf"), "a") as let_in:
                let_in.write(f"host all all {network} trust\n")
        self.control("start")
        self.ask("createdb", "facies")
        self.address = f"postgres://postgres@localhost/facies?host={self.folder}"

    def run(self, *arguments):
        done = subprocess.run([*self.user, *arguments], cwd="/", capture_output=True, text=True)
        if done.returncode:
            raise SystemExit(f"{arguments[0]}: {done.stderr}")
        return done.stdout

    def ask(self, program, *arguments):
        program = os.path.join(os.path.dirname(self.control_program), program)
        return self.run(program, "-h", self.folder, "-U", "postgres", *arguments)

    def query(self, statement):
        """The answer of one statement, a line for each row."""
        return self.ask("psql", "-d", "facies", "-A", "-t", "-c", statement).splitlines()

    def control(self, *arguments):
        options = f"-c listen_addresses={self.listen} -k {self.folder} -N 200"
        log = os.path.join(self.folder, "log")
        self.run(self.control_program, "-D", self.folder, "-w", "-l", log, "-o", options, *arguments)


class Process:
    """A `serve` or `worker`, with a log of its own that goes on over its lives. `inside` is a command that starts it
    elsewhere, such as in a namespace."""

    def __init__(self, binary, name, folder, arguments, environment=None, inside=()):
        self.name, self.command = name, [*inside, binary, *arguments, "--data", os.path.join(folder, name)]
        self.serves, self.is_watched = arguments[0] == "serve", "--admin-bind" in arguments
        self.log = os.path.join(folder, f"{name}.log")
        self.environment = {**os.environ, **(environment or {})}
        self.address = self.admin = None
        self.start()

    def start(self):
        bind = ["--bind", self.address or "127.0.0.1:0"] if self.serves else []
        with open(self.log, "a") as log:
            self.process = subprocess.Popen(
                [*self.command, *bind], stdout=subprocess.PIPE, stderr=log, text=True, env=self.environment
            )
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"{self.name} did not start: {open(self.log).read()[-2000:]}")
        if self.serves:
            self.address = line.split("http://")[1].strip()
        if self.is_watched:
            self.admin = self.process.stdout.readline().split("http://")[1].split("/")[0]
        self.started = time.monotonic()

    def kill(self):
        self.process.send_signal(signal.SIGCONT)
        self.process.kill()
        self.process.wait()

    def terminate(self):
        self.process.terminate()
        return self.process.wait(60)

    def is_running(self):
        return self.process.poll() is None

    def told(self, message):
        """The lines of its log with a message, each with its fields and those of the job that it is about."""
        lines = (json.loads(line) for line in open(self.log) if line.startswith("{"))
        return [{**line.get("span", {}), **line} for line in lines if line.get("message") == message]

    def counted(self, metric):
        """A metric of this life, with its labels as they are written; 0 where it was never counted."""
        text = call(self.admin, "GET", "/metrics").decode()
        values = [line.rsplit(" ", 1)[1] for line in text.splitlines() if line.rsplit(" ", 1)[0] == metric]
        return float(values[0]) if values else 0.0


class Deployment:
    """What is served from a folder: `apis` and `workers` on a private PostgreSQL, or one server on SQLite."""

    def __init__(self, binary, postgresql, workers, settings=(), admin_key=None, cluster=Cluster):
        self.folder = tempfile.mkdtemp(prefix="facies-")
        self.binary, self.admin_key, self.settings = binary, admin_key, [*QUIET, *settings]
        self.cluster, self.environment = None, {}
        self.apis, self.workers = [], []
        if admin_key:
            self.settings += ["--admin-bind", "127.0.0.1:0", "--admin-key", admin_key]
        try:
            if not postgresql:
                self.add_api(workers)
                return
            self.cluster = cluster(self.folder)
            blobs = os.path.join(self.folder, "blobs")
            os.makedirs(blobs)
            self.environment = {"FACIES_DATABASE": self.cluster.address, "FACIES_BLOBS": blobs}
            self.command("migrate")
            self.add_api(0)
            hosts = 2 if workers else 0
            for _ in range(hosts):
                self.add_worker(max(1, workers // hosts))
        except BaseException:
            self.remove()
            raise

    def add_api(self, slots, environment=()):
        name = f"api-{len(self.apis)}"
        arguments = ["serve", "--workers", str(slots), *self.settings]
        self.apis.append(Process(self.binary, name, self.folder, arguments, {**self.environment, **dict(environment)}))

    def add_worker(self, slots, settings=(), environment=(), inside=()):
        name = f"worker-{len(self.workers)}"
        arguments = ["worker", "--workers", str(slots), *QUIET, *settings]
        environment = {**self.environment, **dict(environment)}
        self.workers.append(Process(self.binary, name, self.folder, arguments, environment, inside))

    def key(self, tenant):
        """A key of a tenant that allows everything."""
        wanted = {"label": "load", "scopes": ["read", "write", "run", "admin"]}
        authorization = f"Bearer {self.admin_key}"
        return post(self.api.admin, f"/tenants/{tenant}/keys", wanted, authorization=authorization)["key"]

    @property
    def api(self):
        return self.apis[0]

    @property
    def address(self):
        return self.api.address

    def processes(self):
        return [*self.apis, *self.workers]

    def command(self, *arguments):
        """Runs a command of the program on the deployment; what it printed."""
        data = ["--data", os.path.join(self.folder, "command" if self.cluster else self.api.name)]
        done = subprocess.run(
            [self.binary, *arguments, *data], env={**os.environ, **self.environment}, capture_output=True, text=True
        )
        if done.returncode:
            raise RuntimeError(f"facies {' '.join(arguments)}: {done.stdout}{done.stderr}")
        return done.stdout

    def stop(self):
        for process in self.processes():
            if process.is_running():
                process.process.send_signal(signal.SIGCONT)
                process.terminate()

    def remove(self):
        for process in self.processes():
            if process.is_running():
                process.kill()
        if self.cluster:
            self.cluster.control("stop", "-m", "immediate")
        shutil.rmtree(self.folder, ignore_errors=True)
