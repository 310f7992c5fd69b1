"""The notebook among the examples runs, and shows what is stored in it."""

import base64
import re
from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")

NOTEBOOK = Path(__file__).parents[2] / "examples" / "greenhouse.ipynb"
PICTURE = re.compile(r"data:image/png;base64,([A-Za-z0-9+/=]+)")
SECONDS = re.compile(r"0x[0-9a-f]+")


def shown(notebook):
    """Return what every cell shows as text, and how many pictures it has."""
    found = []
    for cell in notebook.cells:
        for output in cell.get("outputs", ()):
            data = output.get("data", {})
            text = output.get("text", "") or data.get("text/plain", "")
            pictures = len(PICTURE.findall(data.get("text/html", ""))) + ("image/png" in data)
            found.append((SECONDS.sub("", text), "text/html" in data, pictures))
    return found


@pytest.fixture(scope="module")
def executed(tmp_path_factory):
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    stored = nbformat.read(NOTEBOOK, as_version=4)
    folder = tmp_path_factory.mktemp("notebook")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FUZZYARM_NATIVE", "0")
        patch.setenv("IPYTHONDIR", str(folder))
        client = nbclient.NotebookClient(
            notebook, timeout=240, kernel_name="python3", resources={"metadata": {"path": folder}}
        )
        client.execute()
    for cell in notebook.cells:
        cell.get("metadata", {}).pop("execution", None)
    return notebook, stored


@pytest.mark.slow
def test_the_notebook_shows_what_is_stored(executed, update_golden):
    notebook, stored = executed
    if update_golden:
        nbformat.write(notebook, NOTEBOOK)
        stored = notebook
    assert shown(notebook) == shown(stored)
    assert not any(
        output.output_type == "error" for c in notebook.cells for output in c.get("outputs", ())
    )


@pytest.mark.slow
def test_its_pictures_are_pictures(executed):
    notebook, _ = executed
    html = "".join(
        output.get("data", {}).get("text/html", "")
        for cell in notebook.cells
        for output in cell.get("outputs", ())
    )
    pictures = [base64.b64decode(data) for data in PICTURE.findall(html)]
    assert len(pictures) == 2
    assert all(data.startswith(b"\x89PNG") and len(data) > 10_000 for data in pictures)
    assert "<script" not in html
    assert html.count("<table") >= 2
    # Each value is shown once: drawing it must not show it too.
    shows = [c for c in notebook.cells if len(c.get("outputs", ())) > 1]
    assert shows == []
