"""Errors of the evaluation of a rule base."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import did_you_mean, several_nearest


class InferenceError(FuzzyarmError, ValueError):
    """A rule base or an input that cannot be evaluated."""


class UnknownNameError(InferenceError):
    """A name unknown to the rule base.

    Attributes
    ----------
    name : str
        As given.
    known : tuple of str
        The names of the rule base.
    """

    def __init__(self, name: str, known: Iterable[str], *, what: str = "input") -> None:
        self.name = name
        self.known = tuple(known)
        near = several_nearest(name, self.known, 1)
        listed = ", ".join(self.known) or "none"
        hint = did_you_mean(*near) if near else f"there are: {listed}"
        super().__init__(f"there is no {what} '{name}'", hint=hint)


class MissingInputError(InferenceError):
    """Inputs without a value.

    Attributes
    ----------
    names : tuple of str
        The inputs.
    """

    def __init__(self, names: Iterable[str]) -> None:
        self.names = tuple(names)
        several = "s" if len(self.names) > 1 else ""
        super().__init__(f"no value for input{several} {', '.join(self.names)}")


class NotANumberError(InferenceError):
    """A value that is NaN or not a number.

    Attributes
    ----------
    name : str
        The variable.
    """

    def __init__(self, name: str, detail: str = "is not a number (NaN)") -> None:
        self.name = name
        super().__init__(f"the value of '{name}' {detail}")


class OutsideRangeError(InferenceError):
    """A value outside the range of a variable with ``outside error``.

    Attributes
    ----------
    name : str
        The variable.
    value, low, high : float
        The value and the range.
    """

    def __init__(self, name: str, value: float, low: float, high: float) -> None:
        self.name, self.value, self.low, self.high = name, value, low, high
        super().__init__(f"{name} = {value:g} lies outside its range {low:g} .. {high:g}")


class NoRuleFiredError(FuzzyarmError, ArithmeticError):
    """No rule fires for an output that states no value for that case.

    Attributes
    ----------
    output : str
        The output.
    inputs : dict of str to float
        One such input point.
    """

    def __init__(self, output: str, inputs: Mapping[str, float]) -> None:
        self.output = output
        self.inputs = dict(inputs)
        point = ", ".join(f"{name} = {value:.6g}" for name, value in self.inputs.items())
        super().__init__(
            f"no rule fires for '{output}' at {point}",
            hint="state what the output is then: a number or hold",
        )


class NothingHeldError(InferenceError):
    """An output holds its last value where no rule fires, but none was passed.

    Attributes
    ----------
    output : str
        The output.
    """

    def __init__(self, output: str) -> None:
        self.output = output
        super().__init__(
            f"no rule fires for '{output}', which holds its last value, but none was given",
            hint=f"pass held={{'{output}': value}}",
        )


class CyclicRulesError(InferenceError):
    """Outputs that depend on each other, or a rule that reads an output of a later block.

    Attributes
    ----------
    names : tuple of str
        The outputs.
    """

    def __init__(self, message: str, names: Iterable[str]) -> None:
        self.names = tuple(names)
        super().__init__(message)
