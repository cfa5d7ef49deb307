"""What no schema says: that the files for containers and clusters fit the program and each other."""

import pathlib
import re
import sys

import ruamel.yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent
yaml = ruamel.yaml.YAML(typ="safe")
faults: list[str] = []


def expect(holds: bool, what: str) -> None:
    if not holds:
        faults.append(what)


def settings() -> set[str]:
    """The variables that the program knows."""
    text = "".join(path.read_text() for path in
                   [ROOT / "src/config.rs", *(ROOT / "src").glob("config/**/*.rs")])
    names = re.findall(r'\bsetting\(\s*"([a-z0-9-]+)"', text)
    return {f"FACIES_{name.replace('-', '_').upper()}" for name in names}


def check_dockerfile() -> None:
    """Everything that is compiled in is copied in, and let through by .dockerignore."""
    text = (ROOT / "Dockerfile").read_text()
    copied = [source for line in re.findall(r"^COPY (?!--from)(.*)$", text, re.M)
              for source in line.split()[:-1]]
    let_through = (ROOT / ".dockerignore").read_text()
    for source in copied:
        expect((ROOT / source).exists(), f"Dockerfile: there is no {source}")
        expect(f"!{source}\n" in let_through, f".dockerignore keeps {source} out")
    for path in (ROOT / "src").rglob("*.rs"):
        for wanted in re.findall(r'include_(?:str|bytes)!\("([^"]+)"\)', path.read_text()):
            file = (path.parent / wanted).resolve().relative_to(ROOT)
            found = any(file.is_relative_to(source) for source in copied)
            expect(found, f"Dockerfile: {path.relative_to(ROOT)} includes {file}, which is not copied")
    expect(re.search(r"^USER \d+$", text, re.M) is not None, "Dockerfile: the user is no number")


def check_names(place: str, names: set[str]) -> None:
    unknown = {name for name in names if name.startswith("FACIES_")} - settings()
    expect(not unknown, f"{place}: the program does not know {', '.join(sorted(unknown))}")


def check_compose() -> None:
    services = yaml.load(ROOT / "deploy/compose.yaml")["services"]
    for name, service in services.items():
        expect(":" in service["image"] or service["image"] == "facies", f"{name}: no version")
        check_names(f"compose {name}", set(service.get("environment", {})))
        if service["image"] == "facies":
            expect(service["read_only"] and service["cap_drop"] == ["ALL"], f"{name}: may write")


def pods():
    """Every pod of the manifests with its name, and the settings that it takes."""
    documents = [document for path in sorted((ROOT / "deploy/kubernetes").glob("*.yaml"))
                 for document in yaml.load_all(path) if document]
    for document in documents:
        if document["kind"] in ("Deployment", "Job"):
            yield document["metadata"]["name"], document["spec"]["template"]["spec"]
        if document["kind"] == "ConfigMap":
            check_names("kubernetes settings", set(document["data"]))


def check_kubernetes() -> None:
    for name, pod in pods():
        bounds = pod["securityContext"]
        expect(bounds["runAsNonRoot"], f"{name}: may be root")
        expect(bounds["seccompProfile"]["type"] == "RuntimeDefault", f"{name}: no seccomp profile")
        for container in pod["containers"]:
            own = container["securityContext"]
            expect(own["readOnlyRootFilesystem"], f"{name}: may write to its image")
            expect(not own["allowPrivilegeEscalation"], f"{name}: may gain rights")
            expect("memory" in container["resources"]["limits"], f"{name}: no bound on memory")
            check_names(name, {entry["name"] for entry in container.get("env", [])})
            if pod.get("restartPolicy", "Always") == "Always":
                expect("livenessProbe" in container, f"{name}: nobody looks whether it lives")


check_dockerfile()
check_compose()
check_kubernetes()
for fault in faults:
    print(fault)
print("   containers and clusters fit the program" if not faults else "")
sys.exit(1 if faults else 0)
