"""Methods of rule bases, complete or under construction.

Each method is a function of a package above, loaded on demand (:mod:`fuzzyarm.base.above`): a model
needs none of them.
"""

from __future__ import annotations

import os
import warnings
from abc import abstractmethod
from collections.abc import Iterable, Mapping
from typing import Any

from fuzzyarm.base import above
from fuzzyarm.base.keywords import demand_path
from fuzzyarm.base.shown import Shown
from fuzzyarm.base.value_kinds import RULE_BASE, OfKind


class RuleBaseMethods(Shown, OfKind):
    """The methods of every object with a `model`: the value of a rule base."""

    __slots__ = ()

    kind_of_value = RULE_BASE

    @property
    @abstractmethod
    def model(self) -> Any:
        """The value: immutable, with equality and hash."""

    def __call__(
        self,
        inputs: Any = None,
        /,
        *,
        held: Mapping[str, float] | None = None,
        outputs: Iterable[str] | None = None,
        **named: Any,
    ) -> Any:
        """Return the outputs at the inputs; the same as :func:`fuzzyarm.infer`.

        Parameters
        ----------
        inputs : mapping, DataFrame or Dataset, optional
            Inputs by name.
        held : mapping of str to float, optional
            Last values of outputs that hold where no rule fires.
        outputs : iterable of str, optional
            Which outputs to evaluate.
        **named : float, array_like, Series or DataArray
            Inputs by name, in the units of the file.

        Returns
        -------
        dict of str to float, ndarray, Series or DataArray; DataFrame; Dataset
            Every output by name.

        Raises
        ------
        InferenceError, NoRuleFiredError
            As :func:`fuzzyarm.infer`.

        Examples
        --------
        >>> from fuzzyarm import load, shipped
        >>> pd7 = load(shipped("pd7.frb"))
        >>> pd7(e=1.3, ce=-2.2)
        {'u': -1.0677966101694918}
        """
        return above.function("infer")(self.model, inputs, held=held, outputs=outputs, **named)

    def explain(
        self,
        inputs: Mapping[str, float] | None = None,
        /,
        *,
        held: Mapping[str, float] | None = None,
        **named: float,
    ) -> Any:
        """Return the way to the outputs at one point; the same as :func:`fuzzyarm.explain`."""
        return above.function("explain")(self.model, inputs, held=held, **named)

    def check(self) -> Any:
        """Return the result of `fuzzyarm check` on the text: errors, else doubts.

        Returns
        -------
        fuzzyarm.exchange.files.Review
            With its `diagnostics`; ``print`` shows them. Never raises for faults.
        """
        return above.function("check_text")(str(self), f"<{self.model.name}>")

    def table(self, output: str | None = None, **options: Any) -> Any:
        """Return the lookup table of an output."""
        return above.function("compile_table")(self.model, output, **options)

    def plot(self, output: str | None = None, at: Mapping[str, float] | None = None) -> Any:
        """Return a figure of all terms and of the surface of each output.

        Parameters
        ----------
        output : str, optional
            The surface of this output only.
        at : mapping of str to float, optional
            Values of the inputs not drawn, or a point to mark.

        Returns
        -------
        matplotlib.figure.Figure
            Notebooks show it; ``savefig`` writes it.
        """
        return above.function("rulebase_figure")(self.model, output, at)

    def to_file(self, path: str | os.PathLike[str], *, lossy: bool = False) -> None:
        """Write it to a file, replacing the whole file.

        Parameters
        ----------
        path : path-like
            Its suffix is the format: ``.frb``, ``.fll``, ``.fcl`` or ``.fis``.
        lossy : bool
            Whether to write a format of another program even where that would compute other
            numbers.

        Raises
        ------
        RuleBaseError
            If the rule base is incomplete, or the format cannot express it; see the findings.
        FormatError
            For another suffix.
        OSError
            If the file cannot be written.
        """
        from fuzzyarm.base.files import write_atomically

        demand_path("to_file", path)
        text = str(self.model)
        if os.path.splitext(path)[1].lower() != ".frb":
            text = above.function("text_in")(self.model, path, lossy=lossy)
        elif type(self) is not type(self.model):
            text = str(self)
        write_atomically(os.fspath(path), text)

    def __str__(self) -> str:
        """Return the text of its file, in canonical form."""
        text: str = above.function("write")(self.model)
        return text


# --- The former name of RuleBase before RuleBaseBuilder had its own ---


def new_or_begun(cls: type, *arguments: Any, **named: Any) -> Any:
    """Return a new value; of a name and a description alone, a builder, as it once was."""
    words = (*arguments, *named.values())
    if words and set(named) <= {"name", "description"} and all(isinstance(w, str) for w in words):
        return _builder()(*arguments, **named)
    return object.__new__(cls)


def of_builder(name: str) -> Any:
    """Return a class method of the builder under its old name."""
    return classmethod(lambda _, *arguments: getattr(_builder(), name)(*arguments))


def _builder() -> Any:
    message = "load returns fuzzyarm.RuleBase; fuzzyarm.RuleBaseBuilder builds one"
    warnings.warn(message, DeprecationWarning, stacklevel=3)
    return above.function("RuleBaseBuilder")
