"""The fields of a request as arguments of a command, and the words of a command as a request."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any, TypeVar

from fuzzyarm.cli.command import Argument, Command, UsageError
from fuzzyarm.requests.fields import Request, RequestError, RequestField, fields_of

AnyRequest = TypeVar("AnyRequest", bound=Request)


WHICH_ONE = """\
Which command to use:

  sweep, simulate --sweep   how errors depend on gains, parameters and loads; no file changes
  tune                      numbers of a file that make a cost small, in its loop or on samples
  learn                     a table that fills itself while its controller runs on a plant
  fit                       rules from a file of samples, without a plant

"""
"""Of the commands that look for numbers, on the help page of each."""

_EXAMPLES = "Examples\n--------\n"


def with_choice(description: str | None) -> str:
    """Return a help text which says, before its examples, which of such commands is for what."""
    return (description or "").replace(_EXAMPLES, WHICH_ONE + _EXAMPLES)


def request_command(
    name: str, description: str | None, run: Callable[[AnyRequest], int], kind: type[AnyRequest]
) -> Command:
    """Return the record of a command whose arguments are the fields of a request."""

    def run_words(words: argparse.Namespace) -> int:
        try:
            return run(request_of(kind, words))
        except RequestError as error:
            raise of_option(error, kind) from None

    arguments = [argument_of(known) for known in fields_of(kind)]
    groups = list(dict.fromkeys(argument.group for argument in arguments))
    arguments.sort(key=lambda argument: groups.index(argument.group))
    return Command(name, description, run_words, tuple(arguments))


def request_of(kind: type[AnyRequest], words: argparse.Namespace) -> AnyRequest:
    """Return the request that parsed words are."""
    values = vars(words)
    return kind(**{known.name: values[known.name] for known in fields_of(kind)})


def of_option(error: RequestError, kind: type[Request]) -> UsageError:
    """Return an error that names the option in place of the field."""
    spelling = {known.json_name: known.spelling for known in fields_of(kind)}
    own = error.called(spelling.get(error.field, error.field))
    return UsageError(own.message, hint=own.hint)


def argument_of(known: RequestField) -> Argument:
    """Return a field as an argument."""
    first, *others = known.said.words.split()
    names = [first, *(word for word in others if word.startswith("-"))]
    values = others[len(names) - 1 :]
    options: dict[str, Any] = {"help": known.said.help}
    if first.startswith("-"):
        options |= {"dest": known.name, **_of_option(known)}
    else:
        names = [known.name]
        options |= _of_position(known)
    if known.kind != "truth":
        options["type"] = _reader(known)
        if known.choices:
            options["choices"] = known.choices
    if values:
        options["metavar"] = values[0] if len(values) == 1 else tuple(values)
    return Argument(tuple(names), options, known.said.group, known.said.either)


def _of_option(known: RequestField) -> dict[str, Any]:
    """Return the keywords of argparse for an option."""
    if known.is_required:
        return {"required": True}
    if known.kind == "truth":
        action = argparse.BooleanOptionalAction if known.said.is_negatable else "store_true"
        return {"action": action, "default": known.default}
    if known.said.is_repeated:
        return {"action": "append", "default": []}  # which argparse copies
    count = {} if known.count is None else {"nargs": known.count or "+"}
    return {"default": known.default, **count}


def _of_position(known: RequestField) -> dict[str, Any]:
    """Return the keywords of argparse for a positional argument."""
    if known.count is not None:
        return {"nargs": "*"}
    return {} if known.is_required else {"nargs": "?", "default": known.default}


def _reader(known: RequestField) -> Callable[[str], Any]:
    """Return what reads a word of the command line, and says what is wrong of another kind.

    What is out of range is told when the request is made: its exit status is another.
    """

    def read(word: str) -> Any:
        try:
            return known.item(word)
        except RequestError as error:
            if error.is_usage:
                raise argparse.ArgumentTypeError(str(error.called(known.spelling))) from None
            return word

    return read
