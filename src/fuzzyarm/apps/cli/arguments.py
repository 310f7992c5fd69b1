"""The fields of a request as arguments of a command, and the words of a command as a request."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any, TypeVar

from fuzzyarm.apps.cli.command import Argument, Command, UsageError
from fuzzyarm.requests.experiment import AT_THE_END
from fuzzyarm.requests.fields import Request, RequestError, RequestField, fields_of

AnyRequest = TypeVar("AnyRequest", bound=Request)


WHICH_ONE = """\
Which command to use:

  sweep, simulate --sweep   how errors depend on gains, parameters and loads; no file changes
  tune                      numbers of a file that make a cost small, in its loop or on samples
  learn                     a table that fills itself while its controller runs on a plant
  fit                       rules from a file of samples, without a plant

"""
"""Advice on the help page of each command that looks for numbers."""

_EXAMPLES = "Examples\n--------\n"


def with_choice(description: str | None) -> str:
    """Insert the advice before the examples of a help text."""
    return (description or "").replace(_EXAMPLES, WHICH_ONE + _EXAMPLES)


def request_command(
    name: str,
    description: str | None,
    run: Callable[[AnyRequest], int],
    kind: type[AnyRequest],
    *more: Argument,
) -> Command:
    """Return the record of a command with the fields of a request and others as arguments."""

    def run_words(words: argparse.Namespace) -> int:
        try:
            return run(request_of(kind, words))
        except RequestError as error:
            raise of_option(error, kind) from None

    arguments = [*map(argument_of, fields_of(kind)), *more]
    found = dict.fromkeys(argument.group for argument in arguments)
    groups = [*(group for group in found if group not in AT_THE_END), *AT_THE_END]
    arguments.sort(key=lambda argument: groups.index(argument.group))
    return Command(name, description, run_words, tuple(arguments))


def request_of(kind: type[AnyRequest], words: argparse.Namespace) -> AnyRequest:
    """Return the request in parsed words."""
    values = vars(words)
    return kind(**{field.name: values[field.name] for field in fields_of(kind)})


def of_option(error: RequestError, kind: type[Request]) -> UsageError:
    """Convert an error about a field into one about its option."""
    spelling = {field.json_name: field.spelling for field in fields_of(kind)}
    renamed = error.called(spelling.get(error.field, error.field))
    return UsageError(renamed.message, hint=renamed.hint)


def argument_of(field: RequestField) -> Argument:
    """Return a field as an argument."""
    first, *others = field.spec.words.split()
    names = [first, *(word for word in others if word.startswith("-"))]
    values = others[len(names) - 1 :]
    options: dict[str, Any] = {"help": field.spec.help}
    if first.startswith("-"):
        options |= {"dest": field.name, **_of_option(field)}
    else:
        names = [field.name]
        options |= _of_position(field)
    if field.kind != "truth":
        options["type"] = _reader(field)
        if field.choices:
            options["choices"] = field.choices
    if values:
        options["metavar"] = values[0] if len(values) == 1 else tuple(values)
    return Argument(tuple(names), options, field.spec.group, field.spec.either)


def _of_option(field: RequestField) -> dict[str, Any]:
    """Return the keywords of argparse for an option."""
    if field.is_required:
        return {"required": True}
    if field.kind == "truth":
        action = argparse.BooleanOptionalAction if field.spec.is_negatable else "store_true"
        return {"action": action, "default": field.default}
    if field.spec.is_repeated:
        return {"action": "append", "default": []}  # argparse copies the list
    count = {} if field.count is None else {"nargs": field.count or "+"}
    return {"default": field.default, **count}


def _of_position(field: RequestField) -> dict[str, Any]:
    """Return the keywords of argparse for a positional argument."""
    if field.count is not None:
        return {"nargs": "*"}
    return {} if field.is_required else {"nargs": "?", "default": field.default}


def _reader(field: RequestField) -> Callable[[str], Any]:
    """Return a converter for a word; range errors are left to the request (another exit status)."""

    def read(word: str) -> Any:
        try:
            return field.item(word)
        except RequestError as error:
            if error.is_usage:
                raise argparse.ArgumentTypeError(str(error.called(field.spelling))) from None
            return word

    return read
