"""Probable mistakes between a controller, its rule bases and tables, and its plant."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Protocol, TypeVar

from fuzzyarm.base.diagnostic import Diagnostic, Related, Severity, Span, Word, span_of
from fuzzyarm.base.names import did_you_mean, near_hint
from fuzzyarm.base.numbers import percent
from fuzzyarm.base.units import (
    differs,
    dimension,
    near_symbol,
    product,
    read_unit,
    unit_text,
    unlike,
)
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.on_plant import SITE_OF_LAWS, Site, lacking, site_of, text_law_of
from fuzzyarm.control.controllers.reach import (
    FED_BACK,
    MADE,
    PORT,
    LookUp,
    Reaches,
    UnitProduct,
    reaches_of,
)
from fuzzyarm.control.controllers.text import ControllerText, ports_of
from fuzzyarm.language.check.coverage import uncovered_point
from fuzzyarm.language.check.search import GaveUpError
from fuzzyarm.language.check.subject import Subject
from fuzzyarm.language.document import Document
from fuzzyarm.language.model.controller import (
    Axes,
    ControllerModel,
    Drive,
    GainModel,
    Learn,
    Line,
    SignalLine,
    Zoom,
)
from fuzzyarm.language.model.rulebase import Output, RuleBase
from fuzzyarm.language.statements import Broken
from fuzzyarm.plant.own import PLANTS
from fuzzyarm.plant.plant import Address, Plant, Port
from fuzzyarm.symbolic.intervals import overlap, width
from fuzzyarm.symbolic.operations import Interval


class _Spanned(Protocol):
    @property
    def span(self) -> Span: ...


P = TypeVar("P", bound=_Spanned)

# --- The plant ---

KINDS = ("measured", "reference", "drive")
"""Kinds of ports of a controller."""


@cache
def shipped_sites() -> tuple[Site, ...]:
    """Return the shipped plants as sites of controllers."""
    return tuple(site_of(kind()) for kind in PLANTS.values())


def site_by_axes(model: ControllerModel, connect: Mapping[str, str] | None = None) -> Site | None:
    """Return the shipped plant with the axes of a controller and one of its ports.

    With names connected to ports, it must have all of them. The controller may be intended for
    another plant, so the result is only a hint.
    """
    connect = connect or {}
    axes = {connect.get(axis, axis) for axis in model.axis_names}
    ports = [(kind, port) for kind in KINDS for port in ports_of(model, kind)]
    for shipped_site in shipped_sites():
        site = replace(shipped_site, connect=connect) if connect else shipped_site
        present = [site.has(model, *use) for use in ports]
        if any(present) and (axes <= set(site.interface.axes) or (connect and all(present))):
            return site
    return None


def site_for(controller: Controller, connect: Mapping[str, str] | None = None) -> Site:
    """Return the default plant of a controller, a shipped one.

    Parameters
    ----------
    controller : Controller
        A text runs on the plant with its axes, every other one on the arm of the study.
    connect : mapping of str to str, optional
        From names of the controller to ports of the plant, if they differ.

    Raises
    ------
    SourceError
        If no shipped plant has its axes and some of its ports.
    """
    parts = list(controller.parts())
    texts = [law.text.model for law in map(text_law_of, parts) if law is not None]
    if len(texts) < len(parts):
        return SITE_OF_LAWS
    site = site_by_axes(texts[0], connect)
    if site is None:
        axes = ", ".join(texts[0].axis_names)
        ports = [port for kind in KINDS for _, port in ports_of(texts[0], kind)]
        raise SourceError(
            f"no shipped plant has axis {axes} with {', '.join(dict.fromkeys(ports))}, as"
            f" {controller.name} asks for",
            hint=f"--plant FILE.py names one of yours; there are {', '.join(PLANTS)}",
        )
    return site


def _likeliest_site(model: ControllerModel, own: Sequence[Plant]) -> Site | None:
    """Return the shipped plant of a controller, or one of the user's with as many of its ports."""
    axes = set(model.axis_names)
    ports = [(kind, port) for kind in KINDS for port in ports_of(model, kind)]

    def present(site: Site) -> int:
        return sum(site.has(model, *use) for use in ports)

    sites = [site for site in map(site_of, own) if axes <= set(site.interface.axes)]
    shipped = site_by_axes(model)
    candidates = [*sites, shipped] if shipped is not None else sites
    best = max(candidates, key=present, default=None)
    return best if best is not None and present(best) else None


# --- All findings ---


def doubts_of(
    text: ControllerText,
    plant: Plant | None = None,
    connect: Mapping[str, str] | None = None,
    own: Sequence[Plant] = (),
) -> list[Diagnostic]:
    """Return probable mistakes in a controller with its files, on its plant.

    Parameters
    ----------
    text : ControllerText
        Without errors in its text; with its readable files only.
    plant : Plant, optional
        Its plant: anything missing there is an error. By default the likeliest of `own` and of the
        shipped plants with its axes: anything missing is a warning.
    connect : mapping of str to str, optional
        From names of the controller to ports of the plant, if they differ.
    own : sequence of Plant
        Plants of the user beside the shipped ones.
    """
    site = site_of(plant, connect) if plant is not None else _likeliest_site(text.model, own)
    reaches = reaches_of(text, site)
    diagnostics = [*_mismatches(text, reaches), *_unlike_units(text, reaches, site)]
    diagnostics += [*_unknown_units(text.model), *_unknown_of_claims(text)]
    diagnostics += _without_rule(text)
    diagnostics += _limits_before_factors(text.model, reaches, site)
    if site is not None:
        diagnostics += _missing_ports(text.model, site, plant_is_named=plant is not None)
        if all(use.name in text.sheets for use in text.model.uses):
            diagnostics += _limits(text.model, reaches, site)
    # Axes with common lines have common findings.
    once = dict.fromkeys(replace(diagnostic, path=text.path) for diagnostic in diagnostics)
    return sorted(once, key=lambda finding: (finding.span, finding.name))


CHANGING = {"zoom", "learn", "drive", "axis", "period", "set-point", "partner", "controller"}
"""Statements without which others mean something else."""


def sound_part(
    model: ControllerModel, document: Document, findings: Iterable[Diagnostic]
) -> ControllerModel | None:
    """Return a controller without faulty lines and their dependents.

    Findings in the rest do not follow from a mistake. None for a mistake in the head or outside
    lines, from which all may follow.
    """
    # An unreadable line defines nothing that others read.
    wrong = [f.span for f in findings if f.is_error and f.name != "unknown-statement"]
    nodes = [statement.node for statement in document.statements]
    broken = [x for x in nodes if isinstance(x, Broken) and x.keyword not in CHANGING]
    lines = [line for _, line in model.lines()]
    parts: list[_Spanned] = [*model.gains, *model.uses, *model.claim_lines, *lines, *broken]
    if not all(any(_is_in(span, part.span) for part in parts) for span in wrong):
        return None

    def sound(parts: Iterable[P]) -> tuple[P, ...]:
        return tuple(x for x in parts if not any(_is_in(span, x.span) for span in wrong))

    gains = sound([_untuned(gain, wrong) for gain in model.gains])
    uses = sound(model.uses)
    known = {gain.name for gain in gains} | {use.name for use in uses}
    known |= {partner.name for partner in model.partners}
    known |= {rulebase.name for rulebase in model.rulebases}
    axes = tuple(replace(axes, lines=_sound_lines(axes, sound(axes.lines), known))
                 for axes in model.axes)  # fmt: skip
    return replace(model, axes=axes, gains=gains, uses=uses, claim_lines=())


def _untuned(gain: GainModel, wrong: Sequence[Span]) -> GainModel:
    """Return a gain without its range of tuning, if that is its only mistake."""
    if not gain.values:
        return gain
    known = gain.unit.span if isinstance(gain.unit, Word) and gain.unit else gain.values[-1].span
    inside = [span for span in wrong if _is_in(span, gain.span)]
    if not inside or min(span[:2] for span in inside) < known[2:]:
        return gain
    return replace(gain, tune=None, span=span_of(gain.name).to(known))


def _sound_lines(axes: Axes, sound: Sequence[Line], known: set[str]) -> tuple[Line, ...]:
    """Return the lines that read known signals only; signals that others change are unknown."""
    known, ports = set(known), set[str]()
    lines: list[Line] = []
    for line in axes.lines:
        if any(line is x for x in sound) and set(_needed_by(line)) <= known:
            lines.append(line)
            known |= set(line.names if isinstance(line, SignalLine) else ())
        elif isinstance(line, Drive):
            ports.add(line.port)
        else:
            known -= {*(line.signals if isinstance(line, Zoom) else ()),
                      *((line.table,) if isinstance(line, Learn) else ())}  # fmt: skip
    # Drives of a port add up: without one of them the sum is unknown.
    return tuple(x for x in lines if not (isinstance(x, Drive) and x.port in ports))


def _needed_by(line: Line) -> Iterator[str]:
    """Yield the names in a line: signals, gains, rule bases and tables."""
    yield from line.reads()
    if isinstance(line, SignalLine) and line.source is not None:
        if line.source.record.of == "call":
            yield line.source.name
        yield from line.source.gains()
    elif isinstance(line, Learn):
        yield from (line.table, line.judge)
        yield from (x for x in (line.rate, line.bound) if isinstance(x, str))


def _is_in(inner: Span, outer: Span) -> bool:
    begin, end = outer[:2], outer[2:]
    return begin <= inner[:2] and inner[2:] <= end


# --- Ranges of signals, and universes ---

FACTORS = {FED_BACK: 1000.0, PORT: 100.0, MADE: 10.0}
"""Limit of the ratio of a signal's range to its universe. A working loop keeps errors small: the
shipped position loops have 720. A signal not kept small by the loop uses its whole range."""

SLOW = 0.05
"""Share of a plant's full speed at which one set point is not to cross half a universe."""

LEAST = 0.1
"""Share of its universe, or of its actuator, that a signal is to reach."""


def _mismatches(text: ControllerText, reaches: Reaches) -> Iterator[Diagnostic]:
    """Yield signals far wider or far narrower than the universe of their look-up."""
    judged: set[tuple[int, str]] = set()
    for up in reaches.look_ups:
        key = (id(up.axes), up.signal)
        if key in judged:
            continue
        finding = _too_wide(text.model, up) or _too_narrow(up)
        if finding is not None:  # one wrong gain, reported once
            judged.add(key)
            yield finding


def _too_wide(model: ControllerModel, look_up: LookUp) -> Diagnostic | None:
    reach, universe = look_up.reach, look_up.universe
    whole, inside = width(reach.at), width(overlap(reach.at, universe))
    # For a sum with cancelling terms the interval is wider than the signal's range.
    if not reach.tight or not FACTORS[reach.confined_by] * inside < whole < math.inf:
        return None
    if reach.confined_by != FED_BACK:
        hint = f"multiply its gain by about {width(universe) / whole:.2g}"
        return _of_range(look_up, "everything saturates", hint)
    hint = f"multiply its gain by {FACTORS[FED_BACK] * width(universe) / whole:.2g} or less"
    step = reach.pace * model.period * model.every
    if SLOW * step <= 0.5 * width(universe):
        verdict = f"all but {percent(inside / whole, 2)} of it saturates"
        return _of_range(look_up, verdict, hint, Severity.INFO)
    speed = f"; at full speed it moves by {step:.3g} in one set point" if step < math.inf else ""
    return _of_range(look_up, f"everything saturates{speed}", hint)


def _too_narrow(look_up: LookUp) -> Diagnostic | None:
    at, universe = look_up.reach.at, look_up.universe
    share = width(overlap(at, universe)) / width(universe)
    if not 0.0 < share < LEAST:
        return None
    hint = f"multiply its gain by about {width(universe) / width(at):.2g}"
    return _of_range(look_up, f"it uses {percent(share, 2)} of the universe", hint)


def _of_range(
    look_up: LookUp, verdict: str, hint: str, severity: Severity = Severity.WARNING
) -> Diagnostic:
    at, universe = look_up.reach.at, look_up.universe
    return Diagnostic(
        "range-mismatch",
        f"{look_up.signal} reaches {_end(at)} here, "
        f"{look_up.sheet} takes {_range(universe)}: {verdict}",
        look_up.line.span,
        severity,
        hint=hint,
        related=_made(look_up),
    )


def _range(interval: Interval) -> str:
    return f"{interval.low:.4g} .. {interval.high:.4g}"


def _end(interval: Interval) -> str:
    """Return the magnitude of a symmetric interval, or both ends."""
    return f"{interval.high:.4g}" if interval.high == -interval.low else _range(interval)


def _made(look_up: LookUp) -> tuple[Related, ...]:
    """Return the line where a signal is defined, if it is another one."""
    for line in look_up.axes.lines:
        if (
            isinstance(line, SignalLine)
            and look_up.signal in line.names
            and line is not look_up.line
        ):
            return (Related(f"{look_up.signal} is made here", line.span),)
    return ()


# --- No rule fires ---


def _without_rule(text: ControllerText) -> Iterator[Diagnostic]:
    """Yield signals that are NaN at some point because no rule fires."""
    for axes, line in text.model.lines():
        if not isinstance(line, SignalLine) or line.source is None:
            continue
        for sheet in text.sheets.get(line.source.name, ()):
            if isinstance(sheet, RuleBase):
                yield from _not_a_number(axes, line, line.source.name, sheet)


def _not_a_number(
    axes: Axes, line: SignalLine, name: str, rulebase: RuleBase
) -> Iterator[Diagnostic]:
    for signal, output in zip(line.names, rulebase.outputs, strict=False):
        if output.no_rule == "hold" or not math.isnan(_value_for_no_rule(output)):
            continue
        try:
            at = uncovered_point(output, Subject(rulebase, Document(())))
        except GaveUpError:  # reported by the check of the rule base
            continue
        if at is None:
            continue
        point = ", ".join(f"{name} = {value:g}" for name, value in at.items())
        yield Diagnostic(
            "no-rule-fires",
            f"no rule of {name} fires at {point}: {signal} is not a number there, and a period in"
            f" which it is not is skipped: {_unchanged_parts(axes)} as before",
            line.span,
            Severity.WARNING,
            hint=f"add a rule to {name}, or define the value there: inference no-rule 0",
        )


def _unchanged_parts(axes: Axes) -> str:
    """Return the parts that keep their values in a skipped period: drives, or memory too."""
    memory = [
        f"{line.source.kind} {line.names[0]}"
        for line in axes.lines
        if isinstance(line, SignalLine) and line.source is not None and line.source.record.states
    ]
    return f"drives and {', '.join(memory)} stay" if memory else "drives stay"


def _value_for_no_rule(output: Output) -> float:
    return float(output.no_rule) if isinstance(output.no_rule, int | float) else math.nan


# --- Units ---


def _unknown_units(model: ControllerModel) -> Iterator[Diagnostic]:
    for gain in model.gains:
        if near := near_symbol(read_unit(gain.unit) or {}):
            message, hint = f"unknown unit '{near[0]}'", did_you_mean(near[1])
            yield Diagnostic("unknown-unit", message, gain.span, Severity.WARNING, hint=hint)


def _unlike_units(
    text: ControllerText, reaches: Reaches, site: Site | None
) -> Iterator[Diagnostic]:
    """Yield gains whose unit meets another of its dimension, as rad and deg, uncancelled."""
    gains = {model.name: model for model in text.model.gains}
    for units in reaches.unit_products:
        before, brought = units.reach, units.brought
        both = product(before, brought)
        if units.option and both and units.name in gains:
            yield _unlike_option(units, gains[units.name])
            continue
        if not units.name:
            yield from _unlike_terms(units)
            continue
        # Report the gain that causes the conflict, not the lines after it: neither factor may have
        # a conflict of its own.
        pair = unlike(both) if both is not None else None
        if pair is None or unlike(before) or unlike(brought) or units.name not in gains:
            continue
        gain = gains[units.name]
        yield Diagnostic(
            "unlike-units",
            f"{pair[0]} and {pair[1]} do not cancel: gain {units.name} has the unit {gain.unit},"
            f" what it scales {unit_text(before)}",
            units.span,
            Severity.WARNING,
            hint="write both in one unit",
            related=(Related(f"gain {units.name}", gain.span),),
        )
    for address, lines in reaches.drives.items():
        port = _port(text.model, site, address)
        unit = read_unit(port.unit) if port is not None else None
        for line, reach in lines:
            ratio = product(reach.unit, unit, -1)
            if not ratio or port is None or not reach.unit:
                continue
            if unlike(ratio) or (reach.scaled and dimension(ratio)):
                where = f"drive {line.port} is in {unit_text(reach.unit)}, the port in {port.unit}"
                yield Diagnostic("unlike-units", where, line.span, Severity.WARNING)
    for up in reaches.look_ups:
        yield from _of_another_dimension(up)


def _unlike_terms(units: UnitProduct) -> Iterator[Diagnostic]:
    """Yield a sum of terms with different units."""
    one, other = units.reach, product({}, units.brought, -1) or {}
    ratio = product(one, units.brought)
    if differs(ratio):
        words = f"a sum of {unit_text(one)} and {unit_text(other)}".replace(" 1", " a plain number")
        hint = "a gain gives a term the unit of the others"
        yield Diagnostic("unlike-units", words, units.span, Severity.WARNING, hint=hint)


def _of_another_dimension(up: LookUp) -> Iterator[Diagnostic]:
    """Yield scaled signals whose dimension differs from that of the input."""
    unit, sheet_unit = up.reach.unit, up.sheet_unit
    ratio = product(unit, sheet_unit, -1)
    if unit and sheet_unit is not None and up.reach.scaled and ratio and dimension(ratio):
        what = unit_text(sheet_unit) if sheet_unit else "a plain number"
        yield Diagnostic(
            "unlike-units",
            f"{up.signal} is in {unit_text(unit)}, {up.sheet} takes {what}",
            up.line.span,
            Severity.WARNING,
            related=_made(up),
        )


def _unlike_option(units: UnitProduct, gain: GainModel) -> Diagnostic:
    return Diagnostic(
        "unlike-units",
        f"{units.option} is in {gain.unit}, its signal in {unit_text(units.reach)}",
        units.span,
        Severity.WARNING,
        hint="write both in one unit",
        related=(Related(f"gain {units.name}", gain.span),),
    )


def _port(model: ControllerModel, site: Site | None, address: Address) -> Port | None:
    """Return the input of the plant that a controller drives by this name."""
    if site is None or not site.has(model, "drive", address):
        return None
    return site.interface.inputs[site.find(model, "drive", address)]


# --- Ports ---


def _missing_ports(
    model: ControllerModel, site: Site, *, plant_is_named: bool
) -> Iterator[Diagnostic]:
    """Yield ports of a controller that the plant lacks."""
    severity = Severity.ERROR if plant_is_named else Severity.WARNING
    axes_there = _axes_on(site, model)
    reported: set[tuple[Span, str]] = set()
    for kind in KINDS:
        for port in ports_of(model, kind):
            place = _asking(model, kind, port)
            if place is None:
                continue
            axes, span = place
            key = (span, port[1]) if port[0] in axes_there else (axes.span, "")
            try:
                site.find(model, kind, port)
            except SourceError as error:
                if key in reported:
                    continue
                reported.add(key)
                hint = (
                    error.hint
                    if plant_is_named
                    else f"{error.hint}; for another plant: --plant FILE.py"
                )
                message = str(error.args[0])
                yield Diagnostic("unknown-port", message, key[0], severity, hint=hint)
    if plant_is_named and (why := lacking(site)):
        for partner in model.partners:
            message = f"the partner '{partner.name}' ({partner.law}) {why}"
            yield Diagnostic("arm-only", message, partner.span)


def _axes_on(site: Site, model: ControllerModel) -> set[str]:
    """Return the axes that a controller may have on a plant."""
    axes = site.interface.axes
    one = len(axes) == 1 and (model.has_one_axis or model.is_cascade)
    return {*axes, *(model.axis_names if one else ())}


def _asking(model: ControllerModel, kind: str, address: Address) -> tuple[Axes, Span] | None:
    """Return the first line that uses a port, and its axes."""
    axis, port = address
    for axes, line in model.lines():
        if axis not in axes.names:
            continue
        if isinstance(line, Drive):
            if kind == "drive" and line.port == port:
                return axes, line.span
        elif isinstance(line, SignalLine) and line.source is not None:
            asks = kind in line.source.record.ports
            if asks and line.source.name == port:
                return axes, line.span
    return None


# --- Limits of integrals ---


def _limits_before_factors(
    model: ControllerModel, reaches: Reaches, site: Site | None
) -> Iterator[Diagnostic]:
    """Yield integrals with a factor, whose limits are those of the scaled signal."""
    for axes, line in model.lines():
        if (
            not isinstance(line, SignalLine)
            or line.source is None
            or line.source.kind != "integral"
        ):
            continue
        within = line.source.option("within")
        if not isinstance(within, tuple) or not any(product.factors for product in line.products):
            continue
        limits, name = Interval(*within), line.names[0]
        for what, reader in _readers(model, reaches, site, axes, name):
            if reader == limits:
                yield Diagnostic(
                    "limit-before-factor",
                    f"{_range(limits)} bounds the integral before its factor; {what} takes as much"
                    f" of {name}, after it",
                    line.span,
                    Severity.WARNING,
                    hint=f"to bound {name} take the factor first, on a line of its own, and write "
                    f" {name} = integral of that line, within {_range(limits)}",
                )
                break


def _readers(
    model: ControllerModel, reaches: Reaches, site: Site | None, axes: Axes, name: str
) -> Iterator[tuple[str, Interval]]:
    """Yield the ranges at a signal's uses: universes, limits of drives and actuators."""
    for up in reaches.look_ups:
        if up.axes is axes and up.signal == name:
            yield up.sheet, up.universe
    for line in axes.lines:
        if not isinstance(line, Drive) or name not in {
            factor.value for product in line.products for factor in product.factors
        }:
            continue
        if line.within is not None:
            yield f"drive {line.port}", Interval(*line.within)
        port = _port(model, site, (axes.names[0], line.port))
        if port is not None:
            yield f"the actuator of {line.port}", Interval(port.low, port.high)


# --- Actuators ---


def _limits(model: ControllerModel, reaches: Reaches, site: Site) -> Iterator[Diagnostic]:
    """Yield drives that exceed the limits of their actuator, or use little of its range."""
    for address, lines in reaches.drives.items():
        port = _port(model, site, address)
        if port is None:
            continue
        actuator = Interval(port.low, port.high)
        if width(actuator) == math.inf:
            continue
        whole = Interval(
            sum(reach.at.low for _, reach in lines), sum(reach.at.high for _, reach in lines)
        )
        takes = f"the {site.name} takes {_range(actuator)} {port.unit}"
        for line, _ in lines:
            if line.within is not None:
                yield from _wider(line, Interval(*line.within), actuator, takes)
        free = [line for line, _ in lines if line.within is None]
        if free and overlap(whole, actuator) != whole:
            growing = list(_growing(model, address[0], free, actuator))
            yield from growing or [_without_limits(free[0], actuator, takes)]
        share = width(overlap(whole, actuator)) / width(actuator)
        if share < LEAST and width(whole) > 0.0:
            yield Diagnostic(
                "weak-drive",
                f"{address[1]} stays within {_range(whole)}, {takes}:"
                f" {percent(share, 2)} of the actuator is used",
                lines[0][0].span,
                Severity.WARNING,
                hint="a larger gain on the drive",
            )


def _wider(line: Drive, limits: Interval, actuator: Interval, takes: str) -> Iterator[Diagnostic]:
    if overlap(limits, actuator) != limits:
        yield Diagnostic(
            "wide-limits",
            f"the limits {_range(limits)} of drive {line.port} pass its actuator: {takes}",
            line.span,
            Severity.WARNING,
            hint=f"within {_range(overlap(limits, actuator))}",
        )


def _without_limits(line: Drive, actuator: Interval, takes: str) -> Diagnostic:
    return Diagnostic(
        "no-limits",
        f"drive {line.port} has no limits; {takes}",
        line.span,
        Severity.INFO,
        hint=f"add  , within {_range(actuator)}  so that the controller knows where it ends",
    )


def _growing(
    model: ControllerModel, axis: str, free: Sequence[Drive], actuator: Interval
) -> Iterator[Diagnostic]:
    """Yield integrals without anti-windup, whose drives have actuators with limits."""
    for axes, line in model.lines():
        if axis not in axes.names or not isinstance(line, SignalLine) or line.source is None:
            continue
        bounded = {word for word, _ in line.source.options} & {"within", "anti-windup"}
        if line.source.record.windup and not bounded:
            drive = axes.driven_by(line.names[0])
            if drive is not None and any(drive is port for port in free):
                yield Diagnostic(
                    "windup",
                    f"the {line.source.kind} '{line.names[0]}' goes on growing while the actuator"
                    f" of {drive.port} is at {actuator.low:g} or {actuator.high:g}",
                    line.span,
                    Severity.WARNING,
                    hint=f"add  , anti-windup hold  here and  , within {_range(actuator)}"
                    "  to the drive",
                )


# --- For an editor ---


def ranges_in_words(text: ControllerText) -> Mapping[str, str]:
    """Return range and unit of each signal by name, as far as known."""
    ranges: dict[str, list[str]] = {}
    for (_, name), reach in reaches_of(text, site_by_axes(text.model)).signals.items():
        if width(reach.at) < math.inf:
            unit = f" {unit_text(reach.unit)}" if reach.unit else ""
            words = f"{_range(reach.at)}{unit}"
            if words not in ranges.setdefault(name, []):
                ranges[name].append(words)
    return {name: ", ".join(words) for name, words in ranges.items()}


def ports_in_words(axes: Iterable[str]) -> Mapping[str, str]:
    """Return the ports of the shipped plants with these axes, or of all, with descriptions."""
    wanted_axes = set(axes)
    sites = [s for s in shipped_sites() if wanted_axes and wanted_axes <= set(s.interface.axes)]
    ports: dict[str, str] = {}
    for site in sites or shipped_sites():
        interface = site.interface
        for (_, name), port in (*interface.outputs.items(), *interface.inputs.items()):
            limits = f", {_range(Interval(port.low, port.high))}" if port.high < math.inf else ""
            ports.setdefault(name, f"{site.name}, {port.unit}{limits}")
        for _, name in interface.references:
            ports.setdefault(name, f"{site.name}, reference only")
    return ports


def plants_in_words(axes: Iterable[str]) -> Mapping[tuple[str, str], str]:
    """Return plants, states and parameters of plants with these axes, with descriptions."""
    wanted_axes = set(axes)
    sites = [s for s in shipped_sites() if wanted_axes and wanted_axes <= set(s.interface.axes)]
    words: dict[tuple[str, str], str] = {}
    for name, kind in PLANTS.items():
        words["plant", name] = (kind.__doc__ or "").strip().partition("\n")[0]
    for site in sites or shipped_sites():
        plant = PLANTS.get(site.name)
        if plant is None:
            continue
        for name, unit in plant.states.items():
            words.setdefault(("state", name), f"{site.name}, {unit}")
        for name, value in plant.parameters.items():
            number = getattr(value, "value", value)
            words.setdefault(("parameter", name), f"{site.name}, {number:g} as it is")
    return words


def _unknown_of_claims(text: ControllerText) -> Iterator[Diagnostic]:
    """Yield names in claims that are unknown to the claim's plant."""
    for claim in text.model.claim_lines:
        kind = PLANTS.get(claim.plant)
        if kind is None:
            continue
        interface = site_of(kind()).interface
        ports = {interface.label(port) for port in (*interface.outputs, *interface.inputs)}
        ports |= {name for _, name in (*interface.outputs, *interface.inputs)}
        for what, names, names_there in (
            ("state", [name for name, _, _ in claim.start], set(kind.states)),
            ("parameter", [name for name, _, _ in claim.parameters], set(kind.parameters)),
            ("port", [*(name for name, _ in claim.at), *(each.port for each in claim.follows),
                      *([claim.output] if claim.output else ())], ports),
        ):  # fmt: skip
            for name in names:
                if name not in names_there:
                    hint = (
                        near_hint(name, sorted(names_there))[0]
                        or f"there are {', '.join(sorted(names_there))}"
                    )
                    message = f"{claim.plant} has no {what} '{name}'"
                    yield Diagnostic(
                        "unknown-port", message, claim.span, Severity.WARNING, hint=hint
                    )
