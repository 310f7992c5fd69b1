"""What type checkers know of fuzzyarm: a slip is a mistake, README and pages have none."""

import os
import re
import shutil
import subprocess
import sys
import textwrap
import tomllib
from pathlib import Path

import pytest
from needs import lacking

import fuzzyarm

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
GOING_ON = ("python.md", "type2.md", "proofs.md")
"""Pages whose blocks go on from one another."""

pytest.importorskip("mypy")

SLIPS = """\
import fuzzyarm
import fuzzyarm.table
import fuzzyarm.apps.show.figures

fuzzyarm.inferr
fuzzyarm.kindz.shape
fuzzyarm.learning.fitt
fuzzyarm.table.read_tabel
fuzzyarm.apps.show.figures.draw_run
fuzzyarm.apps.estimators.FuzzyRegresor
fuzzyarm.load_rulebase("x.frb").inputz
fuzzyarm.load_controller("x.frb").rules
fuzzyarm.simulate("x.frb", "motor", referense={})
fuzzyarm.simulate("x.frb", "motor", duration=[1])
fuzzyarm.RuleBaseBuilder("fan").imput("x", 0, 1)
fuzzyarm.RuleBase(3)
"""

SOUND = """\
from pathlib import Path

import fuzzyarm
from fuzzyarm import kinds, op

def width(rulebase: fuzzyarm.RuleBase) -> float:
    return rulebase.inputs[0].high - rulebase.inputs[0].low

def asked(thing: fuzzyarm.AnyRuleBase) -> str:
    return thing.model.name

model = fuzzyarm.load("x.frb")
if isinstance(model, fuzzyarm.RuleBase):
    width(model), asked(model)
elif isinstance(model, fuzzyarm.LookupTable):
    model.lookup(1.0, 2.0)
else:
    model.model.name
pd7 = fuzzyarm.load_rulebase(Path("x.frb"))
width(pd7)
table: fuzzyarm.LookupTable = fuzzyarm.compile_table(pd7)
fan = fuzzyarm.RuleBaseBuilder("fan")
temp = fan.input("temp", 0, 1, terms=["cold", "hot"])
temp.term("icy", (0, 0, 1))
asked(fan), width(fan.model)
servo: fuzzyarm.ControllerText = fuzzyarm.load_controller("x.frb")
run = fuzzyarm.simulate(servo, "motor", reference={"position": "step:1"}, duration="300ms")
run.metrics["shaft"].rise
run.plot().savefig("x.png")
fuzzyarm.simulate(fuzzyarm.shipped("x.frb"), "motor", reference={"position": 1.0}, duration=0.3)
fuzzyarm.simulate_many(servo, "motor", [{"G_e": 1.0}], duration="1s").rms
fuzzyarm.tune(pd7, time="2min")
fuzzyarm.learning.fit, fuzzyarm.plant.find_plant, fuzzyarm.apps.study.reproduce
"""


NAMES = "import fuzzyarm\n" + "".join(
    f"{name}.no_such_name\n"
    for name in ("fuzzyarm", *(f"fuzzyarm.{each}" for each in fuzzyarm.PACKAGES))
)

KNOWN = {"fuzzyarm", "numpy", *sys.stdlib_module_names}
"""Packages with types; of others that pages import nothing is asked."""

UNTYPED = ("disallow_untyped_defs", "disallow_untyped_calls", "disallow_subclassing_any")
"""What a page need not say: the types of its own functions and files, and of untyped packages."""


@pytest.fixture(scope="module")
def complaints(tmp_path_factory):
    """What ``mypy --strict`` says, in one run, of all files here: (name, line, message) each."""
    folder, pages = tmp_path_factory.mktemp("mypy"), blocks_of_pages()
    files = {"slips.py": SLIPS, "sound.py": SOUND, "readme.py": pages["README_0.py"],
             "names.py": NAMES, **pages}  # fmt: skip
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8")
    (folder / "mypy.ini").write_text(settings_for(pages))
    words = ["-m", "mypy", "--no-error-summary", "--config-file", "mypy.ini"]
    words.append(f"--cache-dir={ROOT / '.mypy_cache'}")  # `make lint` has read the package
    done = subprocess.run(
        [sys.executable, *words, *files], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode in (0, 1), done.stdout + done.stderr
    found = re.findall(r"(?m)^(\w+\.py):(\d+): error: (.*)$", done.stdout)
    return [(name, int(line), message) for name, line, message in found]


def settings_for(pages):
    """Return those by which the package is checked, so that its cache holds, and those of pages."""
    own = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["mypy"]
    imported = set(re.findall(r"(?m)^(?:from|import) (\w+)", "\n".join(pages.values())))
    sections = [
        ([], own | {"mypy_path": ROOT / "src"}),
        *((each["module"], each) for each in own["overrides"]),
        ([name.removesuffix(".py") for name in pages], dict.fromkeys(UNTYPED, False)),
        (sorted(imported - KNOWN), {"ignore_missing_imports": True}),
    ]
    lines = []
    for names, found in sections:
        lines.append(f"[mypy-{','.join(names)}]" if names else "[mypy]")
        for key, value in found.items():
            if key not in ("overrides", "packages", "module"):
                words = ", ".join(value) if isinstance(value, list) else value
                lines.append(f"{key} = {words}")
    return "\n".join(lines)


def lines_at_fault(text):
    """Return the numbers of the lines of SLIPS that have one."""
    return {n for n, line in enumerate(text.splitlines(), 1) if line and "import" not in line}


@pytest.mark.slow  # one run of mypy for all tests here
def test_a_slip_is_a_mistake_and_what_is_sound_is_none(complaints):
    found = [each for each in complaints if each[0] in ("slips.py", "sound.py", "readme.py")]
    assert [each for each in found if each[0] != "slips.py"] == []
    assert {line for _, line, _ in found} == lines_at_fault(SLIPS)
    said = {line: message for _, line, message in found}
    assert 'maybe "infer"?' in said[5]


@pytest.mark.slow
def test_no_package_has_every_name(complaints):
    lines = [line for name, line, _ in complaints if name == "names.py"]
    assert lines == list(range(2, len(NAMES.splitlines()) + 1))


def blocks_of_pages():
    """Return the blocks of Python of all pages, by names of files."""
    found = {}
    for page in PAGES:
        if page.name in GOING_ON:
            continue
        stem = re.sub(r"\W", "_", str(page.relative_to(ROOT).with_suffix("")))
        blocks = re.findall(r"(?ms)^( *)```python\n(.*?)^\1```", page.read_text("utf-8"))
        for number, (_, body) in enumerate(blocks):
            found[f"{stem}_{number}.py"] = textwrap.dedent(body)
    return found


@pytest.mark.slow
def test_the_python_of_pages_has_no_mistake_of_types(complaints):
    blocks = blocks_of_pages()
    assert len(blocks) > 20
    found = [each for each in complaints if each[0] in blocks]
    # The page of exports looks into a routine, whose numbers depend on the options it was made by.
    inward = [each for each in found if '"Routine" has no attribute "core"' in each[2]]
    assert {name for name, *_ in inward} == {"docs_reference_export_0.py"}
    assert [each for each in found if each not in inward] == []


@pytest.mark.slow
def test_the_readme_and_slips_are_the_same_to_pyright(tmp_path):
    beside = Path(sys.executable).parent
    pyright = shutil.which("pyright", path=f"{beside}{os.pathsep}{os.environ['PATH']}")
    if pyright is None:
        pytest.skip(lacking("pyright"))
    files = {"slips.py": SLIPS, "sound.py": SOUND, "readme.py": blocks_of_pages()["README_0.py"]}
    for name, text in files.items():
        (tmp_path / name).write_text(text, "utf-8")
    done = subprocess.run(
        [pyright, "--pythonpath", sys.executable, *files],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    found = set(re.findall(r"(\w+\.py):(\d+):\d+ - error", done.stdout))
    assert found == {("slips.py", str(line)) for line in lines_at_fault(SLIPS)}, done.stdout
