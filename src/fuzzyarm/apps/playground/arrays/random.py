"""Random numbers: NumPy's default generator, PCG64, to the bit.

Seeds: O'Neill's ``seed_seq_fe``; the generator: her PCG XSL RR 128/64; whole numbers in a range:
Lemire's method. As in NumPy's documentation of ``SeedSequence``, ``PCG64`` and ``Generator``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from fuzzyarm.apps.playground.arrays.array import (
    FLOAT,
    WHOLE,
    array_of,
    broadcast_shapes,
    broadcast_to,
    elements,
    made,
    ndarray,
)

_MASK32, _MASK64, _MASK128 = 2**32 - 1, 2**64 - 1, 2**128 - 1
_MULTIPLIER = 0x2360ED051FC65DA44385DF649FCCF645


def _seeds(seed: int) -> list[int]:
    """Return four numbers of 64 bits made of a seed."""
    words = [seed & _MASK32]
    while seed := seed >> 32:
        words.append(seed & _MASK32)
    constant = 0x43B0D7E5

    def hashed(value: int) -> int:
        nonlocal constant
        value ^= constant
        constant = constant * 0x931E8875 & _MASK32
        value = value * constant & _MASK32
        return value ^ value >> 16

    def mixed(x: int, y: int) -> int:
        result = (0xCA01F9DD * x - 0x4973F715 * y) & _MASK32
        return result ^ result >> 16

    pool = [hashed(words[k] if k < len(words) else 0) for k in range(4)]
    for source in range(4):
        for target in range(4):
            if source != target:
                pool[target] = mixed(pool[target], hashed(pool[source]))
    for word in words[4:]:
        for target in range(4):
            pool[target] = mixed(pool[target], hashed(word))
    constant, state = 0x8B51F9DD, []
    for k in range(8):
        value = pool[k % 4] ^ constant
        constant = constant * 0x58F38DED & _MASK32
        value = value * constant & _MASK32
        state.append(value ^ value >> 16)
    return [state[2 * k] | state[2 * k + 1] << 32 for k in range(4)]


class Generator:
    """Draws numbers.

    Parameters
    ----------
    seed : int
        Equal seeds give equal numbers.
    """

    def __init__(self, seed: int) -> None:
        high, low, first, second = _seeds(seed)
        self._increment = (first << 64 | second) << 1 & _MASK128 | 1
        self._state = (self._increment + (high << 64 | low)) & _MASK128
        self._step()
        self._half: int | None = None

    def _step(self) -> None:
        self._state = (self._state * _MULTIPLIER + self._increment) & _MASK128

    def _bits64(self) -> int:
        self._step()
        folded = (self._state >> 64 ^ self._state) & _MASK64
        turn = self._state >> 122
        return (folded >> turn | folded << (64 - turn)) & _MASK64

    def _bits32(self) -> int:
        if self._half is not None:
            half, self._half = self._half, None
            return half
        both = self._bits64()
        self._half = both >> 32
        return both & _MASK32

    def _below(self, count: int) -> int:
        if count == 1:
            return 0
        if count > _MASK32:
            raise NotImplementedError("so large a range needs NumPy, which this page does not have")
        product = self._bits32() * count
        if product & _MASK32 < count:
            threshold = (2**32 - count) % count
            while product & _MASK32 < threshold:
                product = self._bits32() * count
        return product >> 32

    def _one(self) -> float:
        return (self._bits64() >> 11) * 2.0**-53

    def random(self, size: Any = None) -> Any:
        """Draw between 0 and 1."""
        return _filled(self._one, size, FLOAT)

    def uniform(self, low: Any = 0.0, high: Any = 1.0, size: Any = None) -> Any:
        """Draw between two ends."""
        if size is None and (isinstance(low, ndarray | Sequence) or isinstance(high, ndarray)):
            a, b = array_of(low), array_of(high)
            shape = broadcast_shapes(a.shape, b.shape)
            ends = zip(
                elements(broadcast_to(a, shape)), elements(broadcast_to(b, shape)), strict=True
            )
            return made([p + (q - p) * self._one() for p, q in ends], FLOAT, shape)
        first, width = float(low), float(high) - float(low)
        return _filled(lambda: first + width * self._one(), size, FLOAT)

    def integers(self, low: int, high: int | None = None, size: Any = None) -> Any:
        """Draw whole numbers, the end left out."""
        first, end = (0, low) if high is None else (low, high)
        return _filled(lambda: first + self._below(int(end) - int(first)), size, WHOLE)

    def choice(self, among: Any, size: Any = None) -> Any:
        """Draw from some numbers."""
        row = array_of(among)
        return row[self.integers(0, row.size, size)]

    def permutation(self, among: Any) -> Any:
        """Return numbers, or the first whole ones, in another order (Fisher and Yates)."""
        row = array_of(range(among) if isinstance(among, int) else among).copy()
        for last in range(row.size - 1, 0, -1):
            mask = (1 << last.bit_length()) - 1
            while (other := self._bits32() & mask) > last:
                pass
            row[last], row[other] = row[other], row[last]
        return row

    def standard_normal(self, size: Any = None) -> Any:
        """Not available: its table is NumPy's."""
        raise NotImplementedError("noise is drawn by NumPy, which this page does not have")

    normal = standard_normal


def _filled(draw: Any, size: Any, kind: Any) -> Any:
    if size is None:
        return draw()
    shape = (size,) if isinstance(size, int) else tuple(size)
    return made([draw() for _ in range(math.prod(shape))], kind, shape)


def default_rng(seed: Any = None) -> Generator:
    """Return a generator for a seed; a generator itself unchanged."""
    if isinstance(seed, Generator):
        return seed
    if seed is None:
        import secrets

        seed = secrets.randbits(128)
    return Generator(int(seed))
