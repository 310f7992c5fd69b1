"""The block diagram of a controller as data: what is drawn, and that nothing lies on another."""

from collections import Counter
from itertools import combinations, pairwise
from pathlib import Path

import pytest

import fuzzyarm
from fuzzyarm.apps.show.diagram import BLOCK_KINDS, block_diagram, time_text
from fuzzyarm.apps.show.placement import Pen, place
from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language import parse

EXAMPLES = sorted((Path(__file__).parents[2] / "examples" / "controllers").glob("*.frb"))
SHIPPED = [shipped(name) for name in sorted(shipped_names()) if name.endswith(".frb")]
CONTROLLERS = [
    path for path in [*SHIPPED, *EXAMPLES] if "\ncontroller " in path.read_text(encoding="utf-8")
]


@pytest.fixture(scope="module", params=CONTROLLERS, ids=lambda path: path.stem)
def diagram(request):
    text = fuzzyarm.load(request.param)
    assert isinstance(text, ControllerText)
    return block_diagram(text)


def spans(diagram):
    """Yield block, the rows that it takes, by layer."""
    for block in diagram.blocks:
        half = 0.5 * block.height
        yield block.layer, block.row - half, block.row + half


def runs(diagram):
    """Return what each net covers: straight pieces in a layer or gap, and pieces of tracks.

    A horizontal piece is (layer or gap, row); in a gap it goes from track to track, where -1 and
    the number of tracks are its ends.
    """
    across, down = {}, {}
    for wire in diagram.wires:
        net = wire.source, wire.output
        row = diagram.blocks[wire.source].output_row(wire.output)
        corners = list(wire.path)
        first, last = diagram.blocks[wire.source].layer, diagram.blocks[wire.target].layer
        for gap in range(first, last):
            if gap > first:
                across.setdefault(("layer", gap, row), set()).add((net, -1, 1))
            track = -1
            while corners and corners[0].gap == gap:
                corner = corners.pop(0)
                across.setdefault(("gap", gap, row), set()).add((net, track, corner.track))
                ends = min(row, corner.row), max(row, corner.row)
                down.setdefault((gap, corner.track), set()).add((net, *ends))
                row, track = corner.row, corner.track
            across.setdefault(("gap", gap, row), set()).add((net, track, diagram.tracks[gap]))
        assert not corners
        assert row == diagram.blocks[wire.target].input_row(wire.input)
    return across, down


def demand_apart(diagram):
    rows = {}
    for layer, low, high in spans(diagram):
        rows.setdefault(layer, []).append((low, high))
    across, down = runs(diagram)
    for kind, layer, row in across:
        if kind == "layer":
            rows.setdefault(layer, []).append((row - 0.5, row + 0.5))
    for taken in rows.values():
        for first, second in combinations(sorted(taken), 2):
            assert first[1] <= second[0]
    for pieces in (*across.values(), *down.values()):
        for (net, low, high), (other, least, most) in combinations(sorted(pieces), 2):
            assert net == other or high < least or most < low


def test_nothing_lies_on_another(diagram):
    demand_apart(diagram)


def test_every_pin_has_its_wire(diagram):
    ends = Counter((wire.target, wire.input) for wire in diagram.wires)
    pins = {(at, k) for at, block in enumerate(diagram.blocks) for k in range(len(block.inputs))}
    assert ends == Counter(pins)
    starts = {(wire.source, wire.output) for wire in diagram.wires}
    for at, block in enumerate(diagram.blocks):
        assert block.kind in BLOCK_KINDS
        # What no line reads has no wire; the shipped texts read all that they make.
        assert {(at, k) for k in range(len(block.outputs))} <= starts or block.kind == "learn"


def test_wires_go_to_the_right(diagram):
    for wire in diagram.wires:
        assert diagram.blocks[wire.source].layer < diagram.blocks[wire.target].layer
        assert all(0 <= c.track < diagram.tracks[c.gap] for c in wire.path)


def of(text):
    parsed = parse(text)
    assert parsed.controller is not None, parsed.diagnostics
    return block_diagram(parsed.controller)


HEAD = 'controller c\n\nperiod 1 ms\n\ngain K = 2\ngain L = 3 "V"\n\naxis shaft\n'


def chain(diagram, start):
    """Return the labels from a block on, as long as one wire goes on."""
    labels, at = [], next(k for k, b in enumerate(diagram.blocks) if b.label == start)
    while True:
        labels.append(diagram.blocks[at].label or diagram.blocks[at].kind)
        following = [wire.target for wire in diagram.wires if wire.source == at]
        if not following:
            return labels
        at = following[0]


def test_a_loop_is_read_from_left_to_right():
    diagram = block_diagram(fuzzyarm.load(shipped("servo.frb")))
    assert chain(diagram, "reference position") == [
        "reference position", "difference", "G_e", "pd7", "G_u", "limit", "drive voltage",
    ]  # fmt: skip
    (rules,) = (block for block in diagram.blocks if block.kind == "rules")
    assert rules.details == ("49 rules", "pd7.frb")
    assert [wire.signal for wire in diagram.wires if wire.signal] == ["e", "ce", "u"]
    assert diagram.period == "every 1 ms"
    assert diagram.groups == ((("shaft",), 0.0, diagram.height),)


def test_gains_that_follow_one_another_are_one_block_with_their_values():
    diagram = of(HEAD + "  e = measured position\n  drive voltage = e * K / 255 * L\n")
    (gain,) = (block for block in diagram.blocks if block.kind == "gain")
    assert gain.label == "K / 255 * L"
    assert gain.details == ("K = 2", "L = 3 V")


def test_signs_and_divisors_stand_at_the_pins():
    lines = "  a = measured position\n  b = measured velocity\n  c = a - b\n  d = c * a / b\n"
    diagram = of(HEAD + lines + "  drive voltage = d * K\n  drive torque = -a * L\n")
    words = {block.kind: block.inputs for block in diagram.blocks}
    assert words["plus"] == ("+", "-")
    assert words["times"] == ("*", "*", "/")
    assert [b.label for b in diagram.blocks if b.kind == "gain"] == ["K", "L", "-1"]


def test_drives_of_one_port_add_up_behind_their_limits():
    lines = "  e = error of position\n  drive voltage = e * K, within -1 .. 1\n"
    diagram = of(HEAD + lines + "  drive voltage = e * L, within -2 .. 2, slew 5\n")
    kinds = Counter(block.kind for block in diagram.blocks)
    assert (kinds["limit"], kinds["slew"], kinds["plus"], kinds["drive"]) == (2, 1, 1, 1)


def test_a_zoomed_signal_is_the_one_behind_the_zoom():
    diagram = block_diagram(fuzzyarm.load(shipped("cfaf.frb")))
    at = next(k for k, block in enumerate(diagram.blocks) if block.kind == "zoom")
    assert [b.label for b in diagram.blocks if b.kind == "rules"] == ["alpha7", "pd7"]
    for k, block in enumerate(diagram.blocks):
        if block.kind == "rules":
            assert {wire.source for wire in diagram.wires if wire.target == k} == {at}


def test_a_weight_stands_in_front_of_the_difference():
    diagram = of(HEAD + "  e = error of position, weight 0.5\n  drive voltage = e * K * L\n")
    assert chain(diagram, "reference position")[1:3] == ["0.5", "difference"]


def test_axes_have_their_own_parts_below_one_another():
    text = HEAD + "  e = error of position\n  drive voltage = e * K\n\naxis other\n"
    diagram = of(text + "  e = error of position\n  drive voltage = e * L\n")
    (first, low, middle), (second, begin, high) = diagram.groups
    assert (first, second, low, middle, high) == (
        ("shaft",),
        ("other",),
        0.0,
        begin,
        diagram.height,
    )
    rows = {block.axes: block.row for block in diagram.blocks if block.kind == "drive"}
    assert rows["shaft",] < middle < rows["other",]
    demand_apart(diagram)


def test_crossed_inputs_do_not_lie_on_one_another():
    lines = "  a = measured position\n  b = measured velocity\n"
    lines += "  zoom a, b by 2 inside 3\n  zoom b, a by 2 inside 3\n  c = a - b\n"
    demand_apart(of(HEAD + lines + "  drive voltage = c * K * L\n"))


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(6e-4, "0.6 ms"), (10.0, "10 s"), (0.5, "0.5 s"), (0.08, "80 ms"), (5e-5, "50 us"),
     (600.0, "10 min"), (7200.0, "2 h"), (1e-7, "0.1 us")],
)  # fmt: skip
def test_times_are_written_short(seconds, words):
    assert time_text(seconds) == words


# ── lengths ──────────────────────────────────────────────────────────────────────────

PEN = Pen(lambda text, _style: 6.0 * len(text), line=12.0, pad=4.0, room=90.0, track=8.0, arrow=7.0)


def directions(point, pieces):
    """Return where wires go from a point."""
    (x, y), found = point, set()
    for ends in pieces:
        for (x0, y0), (x1, y1) in (ends, ends[::-1]):
            across = y0 == y1 == y and min(x0, x1) <= x <= max(x0, x1) and x1 != x
            down = x0 == x1 == x and min(y0, y1) <= y <= max(y0, y1) and y1 != y
            if across or down:
                found.add((x1 > x) - (x1 < x) if across else ("down" if y1 > y else "up"))
    return found


def test_wires_go_from_the_edge_of_a_block_to_the_edge_of_another(diagram):
    picture = place(diagram, PEN)
    nets = {}
    for wire, points in picture.wires:
        source, target = picture.blocks[wire.source], picture.blocks[wire.target]
        assert points[0][0] == source.x + source.width
        assert points[-1][0] == pytest.approx(target.x)
        for (_, y), block in ((points[0], source), (points[-1], target)):
            assert block.y <= y <= block.y + block.height
        assert all((x0 == x1) != (y0 == y1) or (x0, y0) == (x1, y1)
                   for (x0, y0), (x1, y1) in pairwise(points))  # fmt: skip
        nets.setdefault((wire.source, wire.output), []).extend(pairwise(points))
    # A dot is where the wires of one output go on in three directions.
    branches = {
        point
        for pieces in nets.values()
        for point in {end for piece in pieces for end in piece}
        if len(directions(point, pieces)) > 2
    }
    assert set(picture.dots) == branches
