"""Probable mistakes in a controller, from its lines alone."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from fuzzyarm.base.diagnostic import Diagnostic, Related, Severity
from fuzzyarm.language.model.controller import Axes, ControllerModel, Drive, Learn, SignalLine
from fuzzyarm.language.tokens import name_text


def doubts_of_lines(model: ControllerModel) -> Iterator[Diagnostic]:
    """Yield the doubts about a controller that need neither its files nor a plant."""
    for axes in model.axes:
        yield from _integrals(axes, [gain.name for gain in model.gains])
        yield from _limits_that_add_up(axes)
        yield from _tables_that_nothing_reads(axes)
        yield from _sums_without_set_points(model, axes)


def _integrals(axes: Axes, gains: Collection[str]) -> Iterator[Diagnostic]:
    """Yield unbounded integrals in limited drives, and anti-windup without effect."""
    for line in axes.lines:
        if not isinstance(line, SignalLine) or line.source is None or not line.source.record.windup:
            continue
        name, drive = line.names[0], axes.driven_by(line.names[0])
        limits = None if drive is None else drive.within
        if line.source.option("anti-windup") is not None:
            if drive is not None and limits is None:
                yield Diagnostic(
                    "no-limits",
                    f"the anti-windup of '{name}' does nothing: drive {drive.port} has no limits",
                    line.span,
                    Severity.WARNING,
                    hint="add  , within LOW .. HIGH  to the drive",
                    related=(Related("the drive", drive.span),),
                )
            elif drive is not None and axes.gain_of(name, drive, gains) is None:
                yield from _unknown_gain(line, drive)
        elif drive is not None and limits is not None and line.source.option("within") is None:
            yield Diagnostic(
                "windup",
                f"the {line.source.kind} '{name}' keeps growing while {drive.port} is at"
                f" {limits[0]:g} or {limits[1]:g}",
                line.span,
                Severity.WARNING,
                hint="add  , anti-windup hold  or  , within A .. B",
            )


def _unknown_gain(line: SignalLine, drive: Drive) -> Iterator[Diagnostic]:
    """Yield an anti-windup whose drive has no known sensitivity to the integral."""
    assert line.source is not None
    name = line.names[0]
    if line.source.option("anti-windup") == "hold":
        return
    yield Diagnostic(
        "windup-gain",
        f"the gain from '{name}' to {drive.port} is not constant: the anti-windup takes it as 1",
        line.span,
        Severity.WARNING,
        hint="anti-windup hold only needs its sign; or bound the integral by  within A .. B",
        related=(Related("the drive", drive.span),),
    )


def _limits_that_add_up(axes: Axes) -> Iterator[Diagnostic]:
    """Yield drives of one port with more than one pair of limits."""
    first: dict[str, Drive] = {}
    for line in axes.lines:
        if not isinstance(line, Drive) or line.within is None:
            continue
        other = first.setdefault(line.port, line)
        if other is line or other.within is None:
            continue
        low, high = (a + b for a, b in zip(other.within, line.within, strict=True))
        yield Diagnostic(
            "limits-add-up",
            f"two drives of {line.port} have limits each, and add up to {low:g} .. {high:g}",
            line.span,
            Severity.WARNING,
            hint=f"write one line  drive {line.port} = … + …, within A .. B",
            related=(Related("the other drive", other.span),),
        )


def _tables_that_nothing_reads(axes: Axes) -> Iterator[Diagnostic]:
    """Yield learners with an unused table."""
    lookups = {
        line.source.name
        for line in axes.lines
        if isinstance(line, SignalLine) and line.source is not None and line.source.kind == "table"
    }
    for line in axes.lines:
        if isinstance(line, Learn) and line.table not in lookups:
            inputs = ", ".join(map(name_text, line.inputs))
            yield Diagnostic(
                "unread-table",
                f"'{line.table}' learns, but nothing looks it up",
                line.span,
                Severity.WARNING,
                hint=f"add a line like  u = table {line.table}({inputs})",
            )


def _sums_without_set_points(model: ControllerModel, axes: Axes) -> Iterator[Diagnostic]:
    """Yield sums cleared in every period, because no set point lasts longer."""
    if model.every > 1:
        return
    for line in axes.lines:
        if (
            isinstance(line, SignalLine)
            and line.source is not None
            and line.source.option("cleared")
        ):
            yield Diagnostic(
                "always-cleared",
                f"'{line.names[0]}' is cleared in every period: a set point lasts one only",
                line.span,
                Severity.WARNING,
                hint="add a line like  set-point every 5  to the head",
            )
