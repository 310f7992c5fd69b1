"""What the writer of a file needs to know of a routine, whatever it is made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from numpy.typing import NDArray

from fuzzyarm.export.c_writer import CWriter


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument or a result: its name in the model and its meaning."""

    name: str
    low: float
    high: float
    description: str = ""
    scaling: str = ""


@dataclass(frozen=True, slots=True)
class Cost:
    """What one call takes at most.

    Attributes
    ----------
    operations : tuple of (str, int)
        Kind of operation and how many.
    stack : int
        Bytes of local variables, without what the compiler adds.
    """

    operations: tuple[tuple[str, int], ...]
    stack: int

    def in_words(self) -> str:
        """Return the operations as text."""
        parts = [
            f"{count} {kind if count > 1 else kind.replace('s and ', ' or ').replace('ns', 'n')}"
            for kind, count in self.operations
            if count
        ]
        return ", ".join(parts) or "none"


@dataclass(frozen=True, slots=True)
class Accuracy:
    """The difference between a routine and its model in double precision.

    Attributes
    ----------
    worst : float
        Largest absolute difference, in units of the output.
    points : int
        How many points were compared.
    against : str
        What the model is.
    """

    worst: float
    points: int
    against: str


@dataclass(frozen=True, eq=False)
class Vectors:
    """Points for a self-test: the inputs, one array for each, and what must come out."""

    inputs: tuple[NDArray[Any], ...]
    expected: NDArray[Any]
    tolerance: float


class Routine(Protocol):
    """A function to be exported, with the Python model of its arithmetic."""

    @property
    def output(self) -> Argument:
        """The result."""
        ...

    @property
    def arguments(self) -> Sequence[Argument]:
        """The arguments, in order."""
        ...

    @property
    def kind(self) -> str:
        """The C type of arguments and result."""
        ...

    def evaluate(self, *inputs: Any) -> NDArray[Any]:
        """Return what the function returns, bit for bit."""
        ...

    def literal(self, value: Any) -> str:
        """Return an argument or a result as a C literal."""
        ...

    def body(self, writer: CWriter, parameters: Sequence[str]) -> list[str]:
        """Return the statements of the function, without indentation."""
        ...

    def cost(self) -> Cost:
        """Return what one call takes."""
        ...

    def remarks(self) -> list[str]:
        """Return what the head of the file says of index order, borders and arithmetic."""
        ...

    def provenance(self) -> Sequence[tuple[str, str]]:
        """Return where it comes from, as pairs of key and text."""
        ...

    def accuracy(self) -> Accuracy:
        """Compare with the model in double precision over a dense grid."""
        ...

    def vectors(self) -> Vectors:
        """Return points for the self-test."""
        ...
