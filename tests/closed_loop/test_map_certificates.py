"""The certificate of a map: what it says, what the checker follows, and what forging it gives."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_start_map import CLIFF

import fuzzyarm
from fuzzyarm.apps.cli.main import main
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.plant import find_plant
from fuzzyarm.proof.check import Checked, check_certificate, theorem, write_certificate
from fuzzyarm.proof.check.certificate import sealed
from fuzzyarm.proof.loop import MapSearch, StartMap, map_starts, read_claim

CONTROLLER = """controller hold "a push against the fall"

period 10 ms

axis a
  e = error of y
  p = e * 2
  drive push = p
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Any]:
    """y' = y/2 + u, |u| ≤ 1: from |y| < 2 all come back, from beyond none."""
    folder = tmp_path_factory.mktemp("map")
    found = mapped(folder, budget=2.0)
    write_certificate(found.certificate, str(folder / "map.json"))
    return folder, found


@pytest.fixture(scope="module")
def near(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Any]:
    """A window of which everything is proved, soon."""
    folder = tmp_path_factory.mktemp("near")
    found = mapped(folder, budget=20.0, claim="stable from y in -0.5 .. 0.25")
    write_certificate(found.certificate, str(folder / "map.json"))
    return folder, found


def mapped(
    folder: Path,
    *,
    plant: str = CLIFF,
    controller: str = CONTROLLER,
    budget: float = 1.5,
    claim: str = "stable",
) -> StartMap:
    """Write a plant and a controller into a folder, and map their starts with a certificate."""
    (folder / "cliff.py").write_text(plant)
    (folder / "hold.frb").write_text(controller)
    path = str(folder / "cliff.py")
    return map_starts(
        fuzzyarm.load_controller(folder / "hold.frb"), read_claim(claim, path),
        MapSearch(budget, certify=True), plant=find_plant(path),
    )  # fmt: skip


def checked(folder: Path, data: dict[str, Any]) -> Checked:
    (folder / "f.json").write_text(json.dumps(data))
    return check_certificate(str(folder / "f.json"), plant=find_plant(str(folder / "cliff.py")))


@pytest.mark.slow
def test_what_is_proved_is_what_the_checker_follows(made: tuple[Path, Any], tmp_path: Path) -> None:
    folder, found = made
    plant = find_plant(str(folder / "cliff.py"))
    again = check_certificate(str(folder / "map.json"), plant=plant)
    assert again.proved, again
    assert again.boxes == sum(box.verdict == "proved" for box in found.boxes)
    assert again.coverage == pytest.approx(found.share("proved"), abs=1e-6)
    assert again.coverage >= 0.4
    assert mapped(tmp_path, budget=6.0).verdict == "refuted"  # from beyond 2
    assert f"from {np.floor(again.coverage * 1000) / 10:g} % of y in -4 .. 4" in again.statement
    assert all(abs(x) <= 2.0 for box in found.boxes if box.verdict == "proved"
               for x in (*box.low, *box.high))  # fmt: skip


@given(st.lists(st.tuples(st.integers(-8, 24), st.integers(0, 16), st.integers(-1, 1)), min_size=1))
def test_the_share_of_a_window_is_exact_and_never_rounded_up(
    rows: list[tuple[int, int, int]],
) -> None:
    tiny = Fraction(1, 10**10)  # less than a printed tenth of a per cent by far
    boxes = [(Fraction(k, 16), Fraction(k + n, 16) + sign * tiny) for k, n, sign in rows]
    boxes = [(low, max(low, high)) for low, high in boxes]
    total, reached = Fraction(0), Fraction(0)
    for low, high in sorted(boxes):
        total += max(Fraction(0), min(high, Fraction(1)) - max(low, reached))
        reached = max(reached, high)
    low, high = (np.array([[box[k]] for box in boxes], dtype=object) for k in (0, 1))
    with pytest.MonkeyPatch.context() as patch:
        assert theorem._share_of(low, high, {"x": (0.0, 1.0)}) == total
        patch.setattr(theorem, "MOST_EXACT_CELLS", 0)  # by floats
        assert total * (1 - Fraction(1, 10**8)) <= theorem._share_of(
            low, high, {"x": (0.0, 1.0)}) <= total  # fmt: skip


def demand_true(again: Checked) -> None:
    """Of what is accepted: each box is one of starts that come back."""
    assert len(again.certificate.claim.start) == 0
    assert again.certificate.claim.plant
    for tube in again.certificate.tubes:
        assert all(-2 < low <= high < 2 for low, high in tube.box), tube
    (low, high) = again.certificate.window[0][1:]
    inside = [
        max(0.0, min(float(b), high) - max(float(a), low))
        for ((a, b),) in (tube.box for tube in again.certificate.tubes)
    ]
    assert again.coverage <= sum(inside) / (high - low) + 1e-12


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    if isinstance(value, dict):
        found = [p for name, part in value.items() for p in places(part, (*path, name))]
    elif isinstance(value, list):
        found = [p for k, part in enumerate(value) for p in places(part, (*path, k))]
    else:
        found = []
    return [*found, *([path] if path else [])]


def forged(value: Any) -> list[Any]:
    """Return values near to one, and others."""
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1, max(value - 1, 0), 0, 10**6, -1, "x", None]
    if isinstance(value, str) and value.strip("-/0123456789") == "" and value:
        return [f"-{value}".replace("--", ""), "0", "5/2", "-5/2", "inf", "1/0", 3, None]
    if isinstance(value, str):
        return ["regions" if value == "tubes" else "tubes", "", "y", None]
    if isinstance(value, list):
        return [[], value[:-1], [*value, *value[-1:]], value[::-1]]
    return [{}, {**value, "y": "1"}, None] if isinstance(value, dict) else ["0", 1, []]


@pytest.mark.slow
def test_whatever_field_is_changed_it_is_refused_or_says_the_truth(made: tuple[Path, Any]) -> None:
    folder, _ = made
    data = json.loads((folder / "map.json").read_text())
    data.pop("seal")
    kept = data["tubes"]
    # Some of each sort: the first and the last boxes, and those that lead into others.
    others = [tube for tube in kept if tube["into"][0] == "tubes"]
    data["tubes"] = [*kept[:2], *others[-2:]]
    accepted = refused = 0
    for path in places(data):
        if path[0] in ("format", "regions") and len(path) > 3 and path[-1] == 0:
            continue
        for value in forged(_at(data, path)):
            changed = json.loads(json.dumps(data))
            _at(changed, path[:-1])[path[-1]] = value
            if changed == data:
                continue
            try:
                again = checked(folder, sealed(changed))
            except (FuzzyarmError, OSError):
                refused += 1
                continue
            if again.proved:
                accepted += 1
                demand_true(again)
            else:
                refused += 1
    assert refused > 5 * accepted > 0


def _at(value: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        value = value[key]
    return value


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda c: replace(c, window=(("y", 1.0, 1.0),)), "not a window"),
        (lambda c: replace(c, window=(("z", -1.0, 1.0),)), "not a window"),
        (lambda c: replace(c, window=(("y", 50.0, 60.0),)), "in its window"),
        (lambda c: replace(c, window=()), "claims nothing of starts"),
        (lambda c: replace(c, window=(c.window[0], c.window[0])), "one window"),
        (lambda c: replace(c, regions=()), "no region"),
        (lambda c: replace(c, tubes=(c.tubes[0]._replace(into=("tubes", 1)),)), "not known"),
        (lambda c: replace(c, tubes=(c.tubes[0]._replace(periods=0),)), "has not arrived|^$"),
        (lambda c: replace(c, tubes=(c.tubes[0]._replace(box=((3, 4),)),)), "bound|not arrived"),
        (lambda c: replace(c, tubes=(c.tubes[0]._replace(box=((1, -1),)),)), "not a box"),
    ],
)
def test_what_a_map_does_not_show_is_said(near: tuple[Path, Any], change: Any, words: str) -> None:
    folder, found = near
    text = fuzzyarm.load_controller(folder / "hold.frb")
    plant = find_plant(str(folder / "cliff.py"))
    again = check_certificate(change(found.certificate), text, plant)
    assert not again.proved or words.endswith("|^$")
    if not again.proved:
        assert any(word in again.reason for word in words.split("|")), again.reason


@pytest.mark.slow
def test_the_command_writes_and_checks_it_and_the_code_says_it(
    made: tuple[Path, Any], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, _ = made
    monkeypatch.chdir(folder)
    words = ["prove", "hold.frb", "--plant", "cliff.py", "--map", "--budget", "2"]
    assert main([*words, "--over", "y in -1.5 .. 1.5", "--certificate", "w.json"]) in (0, 4)
    assert "w.json: the certificate, " in capsys.readouterr().out
    assert main(["prove", "--check", "w.json", "--plant", "cliff.py"]) == 0
    said = capsys.readouterr().out
    assert "proved: stable on 'cliff.py'; from 100 % of y in -1.5 .. 1.5 (" in said
    assert main(["compile", "hold.frb", "-o", "h.h", "--certificate", "w.json", "--trust"]) == 0
    head = " ".join((folder / "h.h").read_text().split("#")[0].replace("*", " ").split())
    assert "from 100 % of y in -1.5 .. 1.5" in head


@pytest.mark.slow
def test_runs_beyond_an_error_bound_are_lost(tmp_path: Path) -> None:
    """y' = u = -y goes to rest from everywhere, but from beyond 1 its error is too large."""
    text = CLIFF.replace("bound=10.0", "error_bound=1.0").replace("0.5 * x[0] + u[0]", "u[0]")
    found = mapped(tmp_path, plant=text)
    controller = fuzzyarm.load_controller(tmp_path / "hold.frb")
    plant = find_plant(str(tmp_path / "cliff.py"))

    def verdict_of(claim: str, budget: float = 2.0) -> str:
        return fuzzyarm.prove(controller, claim, plant=plant, budget=budget).verdict

    named = f"on '{tmp_path / 'cliff.py'}'"
    assert verdict_of(f"{named} from y in 1.5 .. 1.6: y in 0 .. 2 during 0 .. 1 s") != "proved"
    assert verdict_of(f"stable {named} from y in 1.5 .. 1.6") != "proved"
    inside = f"{named} from y in 0.5 .. 0.6: y in 0 .. 1 during 0 .. 1 s"
    assert verdict_of(inside, budget=30.0) == "proved"
    assert found.share("proved") > 0.2
    assert all(abs(x) <= 1.0 for box in found.boxes if box.verdict == "proved"
               for x in (*box.low, *box.high))  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    "lines",
    [
        "r = rate of e, filter 20 ms\n  p = e * 2 + r * 0.1",
        "s = lag of e, time 30 ms\n  p = s * 2",
        "s = delayed of e, time 30 ms\n  p = s * 2",
        "i = integral of e\n  p = e * 2 + i * 0.5",
    ],
)
def test_a_map_of_a_loop_that_remembers_has_a_certificate(tmp_path: Path, lines: str) -> None:
    found = mapped(
        tmp_path, controller=CONTROLLER.replace("p = e * 2", lines), budget=3.0,
        claim="stable from y in -0.5 .. 0.25",
    )  # fmt: skip
    assert found.certificate is not None, found.reason
    assert found.share("proved") > 0.9
    write_certificate(found.certificate, str(tmp_path / "map.json"))
    again = checked(tmp_path, json.loads((tmp_path / "map.json").read_text()))
    assert again.proved, again
    demand_true(again)


def test_a_map_around_no_rest_says_why(tmp_path: Path) -> None:
    found = mapped(tmp_path, controller=CONTROLLER.replace("p = e * 2", "p = e * 0.4"))
    assert found.share("open") == 1.0
    assert "next to rest a deviation grows" in found.reason


def test_a_box_of_too_few_states_is_refused(near: tuple[Path, Any]) -> None:
    folder, _ = near
    data = json.loads((folder / "map.json").read_text())
    data["tubes"][0]["box"] = []
    data.pop("seal")
    again = checked(folder, sealed(data))
    assert not again.proved
    assert "not a box of the plant's states" in again.reason


@pytest.mark.slow
def test_the_time_of_a_map_is_that_of_the_slowest_way_through_its_boxes(
    made: tuple[Path, Any],
) -> None:
    _, found = made
    tubes = found.certificate.tubes
    slowest: list[int] = []
    for tube in tubes:
        kind, before = tube.into
        slowest.append(tube.periods + (max(slowest[:before], default=0) if kind == "tubes" else 0))
    assert found.longest == pytest.approx(0.01 * max(slowest))


@pytest.mark.slow
def test_the_head_of_a_program_has_the_window_and_where_other_states_begin(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with_more = CLIFF.replace('{"y": "m"}', '{"y": "m", "z": "m"}')
    with_more = with_more.replace("+ u[0]]", "+ u[0], 1.0 - x[1]]")
    with_more += "\n    def start(self, rng):\n        return [0.0, 0.25]\n"
    Path("cliff.py").write_text(with_more)
    Path("hold.frb").write_text(CONTROLLER)
    window = ["--over", "y in -1 .. 1", "--budget", "6", "--certificate", "m.json"]
    assert main(["prove", "hold.frb", "--plant", "cliff.py", "--map", *window]) in (0, 4)
    words = ["--certificate", "m.json", "--trust"]
    assert main(["compile", "hold.frb", "-o", "hold.h", *words]) == 0
    head = " ".join(Path("hold.h").read_text().partition("*/")[0].replace("*", "").split())
    assert "of y in -1 .. 1 (" in head
    assert "), the other states at z = 0.25, every run comes to rest" in head


SLIDE = """from fuzzyarm.plant import Plant, Port


class Slide(Plant):
    name = "slide"
    inputs = {"push": Port("N", -1.0, 1.0)}
    outputs = {"y": Port("m", -4.0, 4.0, bound=10.0)}
    states = {"y": "m", "v": "m/s"}
    duration = 20.0

    def derivative(self, t, x, u, p):
        return [x[1], 20.0 * (u[0] - x[1])]
"""


@pytest.mark.slow
def test_what_is_far_away_is_followed_to_boxes_on_the_common_way(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At its limit the push makes every run cruise at 1 m/s: from 4 m for 270 periods."""
    monkeypatch.setattr("fuzzyarm.proof.loop.boxes.MANY", 0)
    found = mapped(tmp_path, plant=SLIDE, budget=600.0)
    assert found.share("proved") == 1.0
    assert all(-4 <= box.low[0] <= box.high[0] <= 4 for box in found.boxes)
    assert found.longest > 2.0
    tubes = found.certificate.tubes
    ways = [tube for tube in tubes if tube.box[1] != (0, 0)]
    assert ways == list(tubes[: len(ways)])
    assert any(tube.into[0] == "tubes" for tube in tubes[len(ways) :])
    assert max(tube.periods for tube in tubes) < 0.5 * found.longest / 0.01
    write_certificate(found.certificate, str(tmp_path / "map.json"))
    data = json.loads((tmp_path / "map.json").read_text())
    assert checked(tmp_path, data).proved
    # Without one of those boxes the others lead nowhere.
    data["tubes"].pop(len(ways) // 2)
    data.pop("seal")
    assert not checked(tmp_path, sealed(data)).proved
