"""The README to the letter, in a clone and an environment that nothing but the README has made."""

import base64
import http.client
import os
import re
import shutil
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from machine_code import compiler_at_hand
from needs import need
from test_pages import README, ROOT, blocks, console_steps, matches

NOT_TYPED = ("make test",)
"""What the README says and the test does not type: this suite."""

DESIGNER = ".venv/bin/fuzzyarm designer rulebases"
"""Goes on until it is interrupted."""


def outside_any_environment():
    """Return the variables of somebody who has just logged in: no environment, no fuzzyarm."""
    ours = Path(sys.prefix, "bin")
    paths = [path for path in os.environ["PATH"].split(os.pathsep) if Path(path) != ours]
    clean = {"PATH": os.pathsep.join([str(Path(sys.base_prefix, "bin")), *paths])}
    # The way to the index is the machine's own; what pip has fetched before need not come again.
    ways = r"PIP_.*|.*_PROXY|.*_proxy|SSL_CERT_.*|REQUESTS_CA_BUNDLE|LANG|LC_.*"
    clean |= {name: value for name, value in os.environ.items() if re.fullmatch(ways, name)}
    asked = [sys.executable, "-m", "pip", "cache", "dir"]
    cache = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    # What is never imported need not be compiled either: that is half of the time of pip.
    return clean | {"PIP_COMPILE": "0"} | ({"PIP_CACHE_DIR": cache} if cache else {})


@pytest.fixture(scope="module")
def stranger(tmp_path_factory):
    """Return a folder with what a clone has, and the variables of a shell in it."""
    need("git")
    listed = ["git", "-C", str(ROOT), "ls-files", "-z", "--cached", "--others"]
    done = subprocess.run([*listed, "--exclude-standard"], capture_output=True, check=False)
    if done.returncode:
        pytest.skip("what a clone has is what git knows, and this is not a clone")
    clone = tmp_path_factory.mktemp("stranger") / "fuzzyarm"
    for name in filter(None, done.stdout.decode().split("\0")):
        if (ROOT / name).is_file():
            (clone / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, clone / name)
    home = tmp_path_factory.mktemp("home")
    shell = outside_any_environment() | {"HOME": str(home), "BROWSER": "true", "COLUMNS": "80"}
    shell |= compiler_at_hand(home)
    require_an_index(shell, home)
    return clone, shell


def require_an_index(shell, folder):
    """Skip where pip reaches no index: ask for the smallest package of the lock files."""
    (pinned,) = re.findall(
        r"(?m)^editables==\S+", (ROOT / "requirements" / "build.lock").read_text("utf-8")
    )
    words = ["python3", "-m", "pip", "download", "--no-deps", "--quiet", "-d", str(folder), pinned]
    try:
        done = subprocess.run(
            words, env=shell, cwd=folder, capture_output=True, text=True, timeout=60, check=False
        )
    except subprocess.TimeoutExpired:
        pytest.skip("pip hears nothing of a package index within a minute")
    if done.returncode:
        pytest.skip(f"pip reaches no package index: {done.stderr.strip().splitlines()[-1]}")


def typed(commands, clone, shell):
    """Type commands into one shell; return the status and the output of each."""
    said = [f"{clone.parent}/{number}.txt" for number in range(len(commands))]
    lines = [
        f"{{ {command}\n}} > {name} 2>> {name}.errors; echo $?"
        for command, name in zip(commands, said, strict=True)
    ]
    done = subprocess.run(
        ["bash", "--norc"], input="\n".join(lines), cwd=clone, env=shell,
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert not done.stderr, done.stderr
    outputs = [Path(name).read_text("utf-8") for name in said]
    errors = [Path(f"{name}.errors").read_text("utf-8") for name in said]
    return list(zip(map(int, done.stdout.split()), outputs, errors, strict=True))


@pytest.mark.slow(seconds=25)
def test_what_the_readme_says_can_be_typed(stranger):
    clone, shell = stranger
    text = README.read_text("utf-8")
    steps = [step for body in blocks(README, "console") for step in console_steps(body)]
    steps = [step for step in steps if step.text not in NOT_TYPED]
    assert [step.text for step in steps][:2] == ["make demo", DESIGNER]
    before = [step for step in steps if step.text != DESIGNER]
    (script,) = blocks(README, "python")
    (clone.parent / "script.py").write_text(script, "utf-8")
    commands = [*(step.text for step in before), f"python {clone.parent / 'script.py'}"]
    results = typed(commands, clone, shell)
    for step, (status, shown, errors) in zip(before, results, strict=False):
        assert status == step.status, (step.text, errors)
        assert not step.expected or matches(step.expected, shown), (step.text, shown)
    assert results[-1][0] == 0, results[-1]
    assert results[-1][1].startswith("-1.0677966101694")
    # What the demo says at its end is what comes next.
    assert DESIGNER in results[0][1]
    assert "source .venv/bin/activate" in results[0][1]
    assert f"$ {DESIGNER}" in text
    page, status = answers_of_the_designer(clone, shell)
    assert "The designer needs JavaScript." in page
    assert status == 101, "the page can talk to the program"


def answers_of_the_designer(clone, shell):
    """Start the designer as the README does, ask for page and socket, end it with Ctrl-C."""
    process = subprocess.Popen(
        DESIGNER.split(), cwd=clone, env=shell, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    try:
        address = process.stdout.readline().strip()
        assert address.startswith("http://127.0.0.1:"), process.communicate(timeout=10)
        with urllib.request.urlopen(address, timeout=30) as answer:
            page = answer.read().decode()
        place = urlsplit(address)
        connection = http.client.HTTPConnection(place.hostname, place.port, timeout=30)
        key = base64.b64encode(b"sixteen letters.").decode()
        origin = f"{place.scheme}://{place.netloc}"
        wants = {"Upgrade": "websocket", "Connection": "Upgrade", "Origin": origin}
        wants |= {"Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": key}
        connection.request("GET", f"{place.path}socket", headers=wants)
        status = connection.getresponse().status
        connection.close()
    finally:
        process.send_signal(signal.SIGINT)
        out, errors = process.communicate(timeout=30)
    assert process.returncode == 0, (out, errors)
    return page, status
