"""Compare two tables cell by cell, or two rule bases rule by rule.

Tables are compared by the names of their inputs: one with rows and columns swapped is
turned round first, and that is said. Rule bases are compared by meaning: the order of rules,
comments and layout do not count. The exit status is 0 whether or not they differ; with
--json the answer has a field `same`.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.arguments import WordError

if TYPE_CHECKING:
    from fuzzyarm.table.diff import TableDiff


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm diff``."""
    parser.add_argument("before", metavar="A", help="a table or a rule base")
    parser.add_argument("after", metavar="B", help="another of the same kind")
    parser.add_argument("--json", action="store_true", help="print the differences as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Compare and print."""
    from fuzzyarm.api import load
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.show.diff import compare_rulebases, rulebase_diff_view, table_diff_view
    from fuzzyarm.show.drawing import make_console
    from fuzzyarm.table.diff import compare_tables

    before, after = load(arguments.before), load(arguments.after)
    if isinstance(before, RuleBase) != isinstance(after, RuleBase):
        raise WordError("a rule base and a table cannot be compared", hint="compile the rule base")
    if isinstance(before, RuleBase) and isinstance(after, RuleBase):
        rules = compare_rulebases(before, after)
        if arguments.json:
            print(json.dumps({"same": rules.same, **asdict(rules)}, indent=2))
        else:
            make_console().print(rulebase_diff_view(rules))
    elif not isinstance(before, RuleBase) and not isinstance(after, RuleBase):
        cells = compare_tables(before, after)
        if arguments.json:
            print(json.dumps(as_data(cells), indent=2))
        else:
            make_console().print(table_diff_view(cells))
    return 0


def as_data(diff: TableDiff) -> dict[str, Any]:
    """Return the differences of two tables as JSON data."""
    return {
        "same": diff.same,
        "comparable": diff.comparable,
        "transposed": diff.transposed,
        "header": [{"what": w, "before": a, "after": b} for w, a, b in diff.header],
        "cells": [
            {
                "inputs": dict(zip(diff.before.names, change.levels, strict=True)),
                "before": change.before,
                "after": change.after,
            }
            for change in diff.changes
        ],
    }
