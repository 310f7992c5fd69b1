"""What is wrong in a plant of one's own is one sentence with its line, before it runs."""

import math
import sys

import pytest

from fuzzyarm.apps.cli.main import main
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.control.loop import simulate
from fuzzyarm.plant import Plant, PlantError, Port, find_plant
from fuzzyarm.plant.equations import traced

KILN = """\
from fuzzyarm.plant import Plant, Port

class Kiln(Plant):
    inputs = {"power": Port("%", 0, 100)}
    outputs = {"temperature": Port("°C")}
    states = {"charge": "°C", "element": "°C"}
    parameters = {"loss": 0.01}
    duration = 10.0

    def start(self, rng):
        return [20.0, 20.0]

    def derivative(self, t, x, u, p):
        return [x[1] - x[0], 0.2 * u[0] - p[0] * x[1]]
"""

MISTAKES = {
    # what is changed, what it becomes: the line, what is said, what to do
    ('Port("%", 0, 100)', '"%"'): (4, "input 'power' is '%', not a Port", 'Port("%", 0, 100)'),
    ('Port("%", 0, 100)', "(0, 100)"): (4, "input 'power' is (0, 100), not a Port", 'Port("1", 0'),
    ('Port("°C")', '"°C"'): (5, "output 'temperature' is '°C', not a Port", 'Port("°C")'),
    ('{"power": Port("%", 0, 100)}', '["power"]'): (4, "inputs must be", 'inputs = {"power"'),
    ('{"power": Port("%", 0, 100)}', "{}"): (4, "it has no inputs", 'inputs = {"power"'),
    ('{"charge": "°C", "element": "°C"}', '["charge", "element"]'): (6, "states must", "states ="),
    ('"element": "°C"', '"element": 20.0'): (6, "'element' has 20.0 for a unit", '"element": "m"'),
    ("0.01}", '"0.01"}'): (7, "parameter 'loss' is '0.01', not a number", '"loss": 0.01'),
    ("duration = 10.0", "duration = -1"): (8, "duration is -1", "positive"),
    ("duration = 10.0", "longest_step = 0"): (8, "longest_step is 0", "positive"),
    ("duration = 10.0", "longest_stp = 0.1"): (8, "'longest_stp' is not read", "'longest_step'"),
    ("duration = 10.0", "output = lambda self, t, x, u, p: x"): (8, "not read", "'measure'"),
    ("[20.0, 20.0]", "[20.0]"): (10, "start returns 1 number for 2 states", "charge, element"),
    ("return [x[1] - x[0], 0.2", "return [0.2"): (13, "returns 1 number for 2", "charge"),
    ("p[0] * x[1]]", "p[0] * x[1], 0.0]"): (13, "derivative returns 3 numbers for 2", "charge"),
    ("        return [x[1]", "        rates = [x[1]"): (13, "returns nothing", "return a"),
    ("return [x[1] - x[0], 0.2 * u[0] - p[0] * x[1]]", "return 3.0"): (13, "returns 3.0", "list"),
    ("0.2 * u[0]", '"hot" + u[0]'): (14, "TypeError", ""),
    ("x[1] - x[0],", "None,"): (13, "returns None for 'charge', not a number", ""),
    ("x[1] - x[0],", "float('nan'),"): (13, "returns nan for 'charge' at the start", "divides by"),
    ("x[1] - x[0],", "float('inf'),"): (13, "returns inf for 'charge' at the start", ""),
    ("x[1] - x[0],", "x[0] / (x[1] - x[0]),"): (14, "ZeroDivisionError", ""),
    ("x[1] - x[0],", "x[2] - x[0],"): (14, "IndexError", "2 in x, 1 in u, 1 in p"),
    ("p[0] *", 'p["loss"] *'): (14, "list indices must be integers", "p[0] is loss"),
    ("x[1] - x[0],", 'x["element"],'): (14, "list indices must be", "x[0] is charge"),
    ("derivative(self, t, x, u, p)", "derivative(self, x, u)"): (13, "TypeError", "t, x, u, p"),
    ("def derivative", "def derivitive"): (13, "no derivative, but 'derivitive'", "rate of each"),
    ("0.2 * u[0] - p[0] * x[1]]", "0.2 * u[0] - q]"): (14, "NameError", ""),
    ('Port("°C")}', 'Port("V")}'): (5, "(V) is taken from the state 'charge' (°C)", "measure("),
    ('"temperature": Port', '"element": Port'): (5, "'element' (°C) is taken from", "measure("),
    ('outputs = {"temperature": Port("°C")}', 'outputs = {f"t{i}": Port() for i in range(3)}'): (
        None, "3 outputs and 2 states", "measure(self, t, x, u, p)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("change", MISTAKES, ids=lambda change: " -> ".join(change)[:60])
def test_a_mistake_is_one_sentence_with_its_line(change, tmp_path, monkeypatch, capsys):
    line, said, hint = MISTAKES[change]
    monkeypatch.chdir(tmp_path)
    text = KILN.replace(*change, 1)
    assert text != KILN
    (tmp_path / "mine.py").write_text(text, encoding="utf-8")
    words = [str(shipped("heater.frb")), "--plant", "mine.py:Kiln", "--step", "50"]
    assert main(["simulate", *words]) == 1
    err = capsys.readouterr().err
    assert err.count("\n") == 1, err
    assert said in err
    assert hint in err
    if line is not None:
        assert err.startswith(f"fuzzyarm: mine.py:{line}: plant kiln: "), err


@pytest.mark.parametrize("unit", ["°C", "K", "1", "whatever"])
def test_a_state_may_have_a_unit_that_says_nothing_else(unit, tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(KILN.replace('"charge": "°C"', f'"charge": "{unit}"'), encoding="utf-8")
    assert find_plant(f"{path}:Kiln").states["charge"] == unit


def test_the_kiln_itself_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    kiln = KILN.replace("duration = 10.0", "longest_step = 0.5")
    (tmp_path / "mine.py").write_text(kiln, encoding="utf-8")
    for plant in ("mine.py", "mine.py:Kiln"):
        words = [str(shipped("heater.frb")), "--plant", plant, "--step", "50", "--for", "60s"]
        assert main(["simulate", *words]) == 0
    assert "kiln" in capsys.readouterr().out


def test_a_plant_faster_than_a_period_is_told_of_the_longest_step(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(KILN, encoding="utf-8")
    words = [str(shipped("heater.frb")), "--plant", "mine.py", "--step", "50", "--for", "60s"]
    assert main(["simulate", *words]) == 3
    assert "steps of a control period, 10 s" in capsys.readouterr().err


def measured(body):
    return KILN + f"\n    def measure(self, t, x, u, p):\n        {body}\n"


FILES = {
    "class Kiln(Plant:\n": ("mine.py:1: ", ""),
    "import nothing_of_that_name\n": ("mine.py:1: ModuleNotFoundError", ""),
    "x = 1\n": ("mine.py has no plants", ""),
    KILN.replace('Port("%", 0, 100)', "Port(0, 100)"): (
        "mine.py:4: PlantError: the unit of a port must be text, not 0", 'Port("1", 0, 100)',
    ),
    KILN.replace('Port("%", 0, 100)', 'Port("%", "0", 100)'): (
        "mine.py:4: PlantError: low of a port is '0', not a number", "",
    ),
    KILN.replace("class Kiln(Plant)", "class Oven(Plant)"): ("no plant 'Kiln'", "its plants: Oven"),
    KILN.replace("class Kiln(Plant)", "class Klin(Plant)"): ("no plant 'Kiln'", "mean 'Klin'?"),
    KILN.replace("(Plant)", "").replace("    outputs", "    output"): (
        "no plant 'Kiln'", "class Kiln has no outputs",
    ),
    KILN.replace("(Plant)", "").replace("def derivative", "def derivs"): (
        "no plant 'Kiln'", "class Kiln has no derivative(self, t, x, u, p), but derivs",
    ),
    KILN.replace("duration = 10.0", "def __init__(self, size): pass"): (
        "missing 1 required positional argument", "",
    ),
    measured("return [x[0], x[1]]"): ("measure returns 2 numbers for 1 outputs", "temperature"),
    measured("pass"): ("measure returns nothing", "one value for each output: temperature"),
}  # fmt: skip


@pytest.mark.parametrize("text", FILES)
def test_a_mistake_in_the_file_is_one_sentence(text, tmp_path, monkeypatch, capsys):
    said, hint = FILES[text]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(text, encoding="utf-8")
    plant = "mine.py" if text == "x = 1\n" else "mine.py:Kiln"
    assert main(["check", str(shipped("heater.frb")), "--plant", plant]) == 1
    err = capsys.readouterr().err
    assert err.count("\n") == 1, err
    assert said in err
    assert hint in err


def test_a_plant_in_python_says_the_same():
    class Kiln(Plant):
        name = "kiln"
        inputs = {"power": Port("%", 0, 100)}
        outputs = {"temperature": Port("°C")}
        states = {"charge": "°C", "element": "°C"}

        def derivative(self, t, x, u, p):
            return [u[0]]

    with pytest.raises(PlantError, match=r"py:\d+: plant kiln: derivative returns 1 number for 2"):
        simulate(shipped("heater.frb"), Kiln(), duration=10.0)


def test_a_plant_without_a_name_is_called_as_its_class():
    class Oven(Plant):
        inputs = {"power": Port("%", 0, 100)}
        outputs = {"temperature": Port("°C")}
        states = {"T": "°C"}

        def derivative(self, t, x, u, p):
            return [u[0]]

    assert repr(simulate(shipped("heater.frb"), Oven(), duration=1.0)).startswith(
        "<Run heater on oven:"
    )
    assert repr(Oven()) == "<Oven oven: power → temperature>"


def test_a_plant_that_steps_is_not_asked_twice(tmp_path):
    (tmp_path / "steps.py").write_text(
        "from fuzzyarm.plant import Plant, Port\n"
        "class Counter(Plant):\n"
        "    inputs = {'power': Port()}\n"
        "    outputs = {'temperature': Port()}\n"
        "    states = {'T': '1'}\n"
        "    count = 0\n"
        "    def step(self, t, x, u, p, dt):\n"
        "        Counter.count += 1\n"
        "        return x\n"
    )
    plant = find_plant(str(tmp_path / "steps.py"))
    assert type(plant).count == 0


COUNTERS = {
    "a global": ("N = 0", "global N\n        N += 1", "N"),
    "a list": ("N = [0]", "N[0] += 1", "N[0]"),
    "a module": ("math.calls = 0", "math.calls += 1", "math.calls"),
    "another class": ("class K:\n    n = 0", "K.n += 1", "K.n"),
    "an iterator": ("import itertools\nN = itertools.count()", "n = next(N)", "n"),
    "a generator": ("def ones():\n    n = 0\n    while True:\n        n += 1\n        yield n\n"
                    "N = ones()", "n = next(N)", "n"),
    "a default": ("def count(c=[0]):\n    c[0] += 1\n    return c[0]", "n = count()", "n"),
    "a closure": ("def made():\n    c = [0]\n    def count():\n        c[0] += 1\n"
                  "        return c[0]\n    return count\ncount = made()", "n = count()", "n"),
    "a method": ("", "n = self.count()", "n"),
}  # fmt: skip


@pytest.mark.parametrize("sort", COUNTERS)
def test_equations_that_count_outside_the_plant_are_not_traced(tmp_path, sort):
    before, counting, count = COUNTERS[sort]
    path = tmp_path / "counting.py"
    path.write_text(
        f"import math\nfrom fuzzyarm.plant import Plant, Port\n{before}\n\n"
        "class Counting(Plant):\n"
        "    inputs = {'u': Port('V', -50.0, 50.0)}\n"
        "    outputs = {'y': Port('m', -10.0, 10.0)}\n"
        "    states = {'y': 'm'}\n"
        "    def count(self, calls=[0]):\n"
        "        calls[0] += 1\n"
        "        return calls[0]\n"
        "    def derivative(self, t, x, u, p):\n"
        f"        {counting}\n"
        f"        return [u[0] if {count} < 60 else 1.0]\n"
    )
    try:
        assert traced(find_plant(str(path))) is None
    finally:
        vars(math).pop("calls", None)


def test_an_unknown_parameter_has_a_near_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(KILN, encoding="utf-8")
    words = [str(shipped("heater.frb")), "--plant", "mine.py", "--set", "plant.los=1"]
    assert main(["simulate", *words]) == 1
    assert "kiln has no parameter 'los' (did you mean 'loss'?)" in capsys.readouterr().err


def test_a_plant_may_import_a_file_of_its_folder_and_each_time_anew(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    drawn = "from mine import Kiln\n\n\nclass Drawn(Kiln):\n    pass\n"
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "drawn.py").write_text(drawn, encoding="utf-8")
    (tmp_path / "one" / "mine.py").write_text(KILN, encoding="utf-8")
    (tmp_path / "two" / "mine.py").write_text(
        KILN.replace("class Kiln", "class Oven", 1), encoding="utf-8"
    )
    path = [*sys.path]
    words = ["--step", "50", "--for", "60s"]
    for folder in ("one", "two", "one"):
        plant = f"{folder}/drawn.py:Drawn"
        status = main(["simulate", str(shipped("heater.frb")), "--plant", plant, *words])
        told = capsys.readouterr()
        assert ("cannot import name 'Kiln'" in told.err) == (status == 1) == (folder == "two")
        assert ("heater on drawn" in told.out) == (folder == "one")
    assert sys.path[: len(path)] == path


def test_a_parameter_that_is_set_stays_a_number_and_is_named(capsys, tmp_path):
    own = tmp_path / "kiln.py"
    started = KILN.replace("[20.0, 20.0]", '[20.0, 900.0 * self.parameters["loss"]]')
    own.write_text(started.replace("- p[0] * x[1]", "- 0.0002 * x[1] / p[0]"), "utf-8")
    law = tmp_path / "c.frb"
    law.write_text(
        "controller c\nperiod 1 s\naxis kiln\n  e = error of temperature\n  drive power = e\n"
    )
    words = ["simulate", str(law), "--plant", str(own), "--for", "2s", "--set"]
    assert main([*words, "loss=0.02"]) == 0
    assert main([*words, "loss=0"]) == 1
    assert "plant kiln with loss = 0: ZeroDivisionError" in capsys.readouterr().err
    words = ["simulate", str(shipped("servo.frb")), "--plant", "motor", "--for", "2ms"]
    assert main([*words, "--set", "J=0"]) == 1
    assert "fuzzyarm: plant motor with J = 0: ZeroDivisionError" in capsys.readouterr().err


def test_a_parameter_in_place_of_its_number_is_told(tmp_path):
    own = tmp_path / "kiln.py"
    text = KILN.replace('{"loss": 0.01}', '{"loss": Parameter(0.01)}')
    text = text.replace("import Plant,", "import Parameter, Plant,")
    for start in ('[20.0, self.parameters["loss"]]', '[20.0, 2 * self.parameters["loss"]]'):
        own.write_text(text.replace("[20.0, 20.0]", start), "utf-8")
        with pytest.raises(PlantError) as error:
            find_plant(str(own))
        assert error.value.hint == "its number is self.parameters[NAME].value"
