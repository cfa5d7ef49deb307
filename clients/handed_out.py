"""Holds what a service at FACIES_ADDRESS hands out at /clients against the folder that it was built in, without a key."""

import os
import re
import sys
import urllib.request
from pathlib import Path


def get(path: str) -> tuple[bytes, str]:
    """The content, and what a browser is told that it may run."""
    with urllib.request.urlopen(os.environ["FACIES_ADDRESS"] + path) as answer:
        return answer.read(), answer.headers["Content-Security-Policy"]


built = sorted(Path(sys.argv[1]).iterdir())
listed = re.findall('href="/clients/([^"]+)"', get("/clients")[0].decode())
assert listed == [file.name for file in built], listed
for ending in [".whl", ".tgz", ".ipynb", ".html"]:
    assert any(name.endswith(ending) for name in listed), f"no {ending} in {listed}"
for file in built:
    assert get(f"/clients/{file.name}")[0] == file.read_bytes(), file

page, policy = get("/clients/sliders.html")
assert "script-src 'self'" in policy and "connect-src 'self'" in policy, policy
waiting, seen = re.findall('src="([^"]+[.]js)"', page.decode()), set()
assert waiting, "the page has a module"
while waiting:
    module = waiting.pop().removeprefix("./")
    if module in seen:
        continue
    seen.add(module)
    assert module in listed, f"{module} is imported and not handed out"
    waiting += re.findall(r'from "([^"]+)"', get(f"/clients/{module}")[0].decode())
print(f"{len(listed)} files, {len(seen)} modules of the page")
