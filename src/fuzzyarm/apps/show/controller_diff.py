"""The differences between two controllers: gains, lines, and the rule bases and tables they use."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.controller import line_words, tune_words
from fuzzyarm.apps.show.diagram import gain_words, time_text
from fuzzyarm.apps.show.diff import (
    Change,
    RuleBaseDiff,
    change_lines,
    changes,
    compare_rulebases,
    rulebase_diff_view,
    table_diff_view,
)
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import number_text
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language.model.controller import Axes, ControllerModel, Drive, SignalLine
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.tokens import name_text

if TYPE_CHECKING:
    from rich.console import Group, RenderableType

    from fuzzyarm.control.controllers.code import Sheet
    from fuzzyarm.table.diff import TableDiff


@json_properties(
    "same settings gains lines order rulebases=changed_rulebases tables=changed_tables"
)
@dataclass(frozen=True, slots=True)
class ControllerDiff:
    """All differences in meaning; comments and the order of gains do not count.

    Attributes
    ----------
    settings, gains, lines : tuple of Change
        Name, period, set point, files, partners; numbers by name; the lines of the axes.
    rulebases : tuple of (str, RuleBaseDiff)
        By the name in the controller, in both and different.
    tables : tuple of (str, TableDiff)
        Likewise.
    order : tuple of str
        Axes with the same lines in another order.
    """

    settings: tuple[Change, ...]
    gains: tuple[Change, ...]
    lines: tuple[Change, ...]
    rulebases: tuple[tuple[str, RuleBaseDiff], ...]
    tables: tuple[tuple[str, TableDiff], ...]
    order: tuple[str, ...] = ()

    @property
    def same(self) -> bool:
        """Whether both controllers do the same."""
        differs = self.settings or self.gains or self.lines or self.order
        return not (differs or self.rulebases or self.tables)

    @property
    def changed_rulebases(self) -> dict[str, RuleBaseDiff]:
        """Differences of rule bases, by their name here."""
        return dict(self.rulebases)

    @property
    def changed_tables(self) -> dict[str, TableDiff]:
        """Differences of tables, by their name here."""
        return dict(self.tables)


def compare_controllers(before: ControllerText, after: ControllerText) -> ControllerDiff:
    """Return the differences from `before` to `after`.

    Parameters
    ----------
    before, after : ControllerText
        Two versions, with their files.
    """
    first, second = before.model, after.model
    rulebases: list[tuple[str, RuleBaseDiff]] = []
    tables: list[tuple[str, TableDiff]] = []
    for name, one, other in _pairs(before, after):
        if isinstance(one, RuleBase) and isinstance(other, RuleBase):
            rules = compare_rulebases(one, other)
            if not rules.same:
                rulebases.append((name, rules))
        elif not isinstance(one, RuleBase) and not isinstance(other, RuleBase):
            from fuzzyarm.table.diff import compare_tables

            cells = compare_tables(one, other)
            if not cells.same:
                tables.append((name, cells))
    lines, order = _lines(first, second)
    return ControllerDiff(
        tuple(changes(_settings(first), _settings(second))),
        tuple(changes(_gains(first), _gains(second))),
        lines,
        tuple(rulebases),
        tuple(tables),
        order,
    )


def controller_diff_view(diff: ControllerDiff) -> Group:
    """Return the differences as a list prefixed by ``~``, ``+`` and ``-``.

    Parameters
    ----------
    diff : ControllerDiff
        From :func:`compare_controllers`.
    """
    from rich.console import Group
    from rich.text import Text

    if diff.same:
        return Group(Text("the controllers do the same"))
    parts: list[RenderableType] = []
    for title in ("settings", "gains", "lines"):
        parts += change_lines(title, getattr(diff, title))
    parts += [Text(f"axis {axes}: the lines are in another order") for axes in diff.order]
    for name, rules in diff.rulebases:
        parts += [Text(), Text(f"rules {name}", "bold"), rulebase_diff_view(rules)]
    for name, cells in diff.tables:
        parts += [Text(), Text(f"table {name}", "bold"), table_diff_view(cells)]
    if parts and str(parts[0]) == "":
        parts = parts[1:]
    return Group(*parts)


def _pairs(before: ControllerText, after: ControllerText) -> Iterator[tuple[str, Sheet, Sheet]]:
    """Yield the rule bases and tables under the same name in both; several files by axis number."""
    for name, sheets in before.sheets.items():
        others = after.sheets.get(name, ())
        several = max(len(sheets), len(others)) > 1
        for index in range(max(len(sheets), len(others)) if others else 0):
            one, other = sheets[min(index, len(sheets) - 1)], others[min(index, len(others) - 1)]
            if one is not other:
                yield (f"{name}, axis {index + 1}" if several else name), one, other


def _settings(model: ControllerModel) -> dict[str, str]:
    settings = {"name": model.name, "period": time_text(model.period)}
    if model.every != 1:
        settings["set-point"] = f"every {model.every}"
    for axes in model.axes:
        if axes.every != 1:
            settings[f"axis {', '.join(map(name_text, axes.names))}"] = f"every {axes.every}"
    settings.update({f"use {name_text(use.name)}": ", ".join(use.files) for use in model.uses})
    for partner in model.partners:
        gains = "".join(f", {name} = {number_text(value)}" for name, value in partner.gains)
        settings[f"partner {name_text(partner.name)}"] = f"{partner.law}{gains}"
    settings.update({f"rule base {rulebase.name}": "in the file" for rulebase in model.rulebases})
    return settings


def _gains(model: ControllerModel) -> dict[str, str]:
    gains: dict[str, str] = {}
    for gain in model.gains:
        name = name_text(gain.name)
        gains[name] = gain_words(gain)
        if gain.tune is not None:
            gains[f"{name}, tune"] = tune_words(gain).removeprefix("tune ")
    return gains


def _lines(
    before: ControllerModel, after: ControllerModel
) -> tuple[tuple[Change, ...], tuple[str, ...]]:
    """Return the different lines, and the axes in which only their order differs."""
    all_changes: list[Change] = []
    order: list[str] = []
    parts = list(_parts(before, after))
    for names, old, new in parts:
        home = f"axis {names}: " if len(parts) > 1 else ""
        texts = _definitions(old, before), _definitions(new, after)
        differing = [replace(change, what=f"{home}{change.what}") for change in changes(*texts)]
        all_changes += differing
        if not differing and list(texts[0]) != list(texts[1]):
            order.append(names)
    return tuple(all_changes), tuple(order)


def _parts(
    before: ControllerModel, after: ControllerModel
) -> Iterator[tuple[str, Axes | None, Axes | None]]:
    """Yield the axes of both controllers, grouped where both share lines."""
    old, new = ({name: axes for axes in m.axes for name in axes.names} for m in (before, after))
    together: dict[tuple[Axes | None, Axes | None], list[str]] = {}
    for name in dict.fromkeys((*old, *new)):
        together.setdefault((old.get(name), new.get(name)), []).append(name_text(name))
    for (one, other), names in together.items():
        yield ", ".join(names), one, other


def _definitions(axes: Axes | None, model: ControllerModel) -> dict[str, str]:
    """Return the right-hand side of each signal, drive, zoom and learner, by name."""
    partners = [partner.name for partner in model.partners]
    definitions: dict[str, str] = {}
    for line in () if axes is None else axes.lines:
        text = line_words(line, partners)
        if isinstance(line, SignalLine | Drive):
            name, _, text = text.partition(" = ")
        else:
            name, _, text = text.partition(" by ")
        number = sum(1 for key in definitions if key.partition(" (")[0] == name)
        definitions[name if not number else f"{name} ({number + 1})"] = text
    return definitions
