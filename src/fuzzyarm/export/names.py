"""Identifiers for C and Structured Text from the names in a file."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

_C_WORDS = """
    auto break case char const continue default do double else enum extern float for goto if
    inline int long register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while asm typeof bool true false nullptr constexpr alignas
    alignof thread_local static_assert noreturn
    and and_eq bitand bitor catch class compl const_cast delete dynamic_cast explicit export
    friend mutable namespace new not not_eq operator or or_eq private protected public
    reinterpret_cast static_cast template this throw try typeid typename using virtual wchar_t
    xor xor_eq decltype noexcept concept requires
    int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t size_t ptrdiff_t main
    NULL NAN INFINITY HUGE_VALF HUGE_VAL errno linux unix i386 vax near far interrupt I PI
"""

C_RESERVED = frozenset(_C_WORDS.split())
"""Words of C and C++, of the headers that are used, and macros of common compilers."""

_ST_WORDS = """
    abs acos action add and any any_bit any_date any_int any_num any_real array asin at atan bool
    by byte case concat configuration constant cos ctd ctu ctud date delete div do dint dt dword
    else elsif end eq exit exp expt f_edge f_trig false find for function function_block ge gt if
    in initial_step insert int interval jmp le left len limit lint ln log lreal lt lword max mid
    min mod move mul mux ne not of on or pointer pow priority program pt q r r_edge r_trig real
    read_only read_write ref repeat replace resource ret retain return right rol ror rs s sel sema
    shl shr sin single sint sqrt sr step st string struct sub super tan task then this time tod to
    tof ton tp transition trunc type udint uint ulint until usint var var_access var_config
    var_external var_global var_in_out var_input var_output var_temp while with word wstring xor
"""

ST_RESERVED = frozenset(_ST_WORDS.split())
"""Words and standard functions of IEC 61131-3, in lower case (the language ignores case)."""


ARDUINO_MACROS = re.compile(
    r"B[01]{1,8}|P(IN|ORT)?[A-L][0-7]?|SP[A-Z]*\d?|S[EM]\d?|SREG|[XYZ][HL]|PI|F|AVR|HIGH|LOW|INPUT"
    r"|OUTPUT|DEFAULT|EULER|SERIAL|DISPLAY|CHANGE|FALLING|RISING|INTERNAL|EXTERNAL|DEC|HEX|OCT|BIN"
    r"|M_[A-Z]+|(AC|AD|CS|DD|DOR|EE|FE|ICR|ISC|OCR|TC|TOV|TW|UB|UD|WD|WG)[A-Z0-9]*"
    r"|abs|min|max|round|constrain|radians|degrees|sq|bit|map|word|byte|boolean"
)
"""Names that the headers of an Arduino sketch define as macros or as types."""


DEVICES = frozenset(
    ["CON", "PRN", "AUX", "NUL", *(f"{port}{i}" for port in ("COM", "LPT") for i in range(1, 10))]
)
"""Names that no file and no folder has on Windows, whatever its suffix."""


class Names:
    """Hands out identifiers that are valid and different from each other.

    Parameters
    ----------
    language : str
        ``c`` or ``st``; in Structured Text names that differ in case only are the same.
    taken : iterable of str
        Names that are in use already.
    refused : pattern, optional
        Names that are not handed out either.
    """

    def __init__(
        self,
        language: str = "c",
        reserved: set[str] | None = None,
        refused: re.Pattern[str] | None = None,
    ) -> None:
        self._refused = refused
        self._folds = language == "st"
        self._reserved = ST_RESERVED if self._folds else C_RESERVED
        self._used = {self._key(name) for name in reserved or ()}

    def _key(self, name: str) -> str:
        return name.lower() if self._folds else name

    def new(self, stem: str) -> str:
        """Return an identifier like `stem` that has not been given out."""
        base = identifier(stem)
        refused = self._refused is not None and self._refused.fullmatch(base)
        if refused or self._key(base) in self._reserved:
            base = f"{base}_x"
        name, number = base, 1
        while self._key(name) in self._used:
            number += 1
            name = f"{base}_{number}"
        self._used.add(self._key(name))
        return name

    @property
    def used(self) -> frozenset[str]:
        """Names that are in use, in lower case where the language ignores it."""
        return frozenset(self._used)

    def take(self, names: Iterable[str]) -> None:
        """Hand out names that were chosen elsewhere, among those that were free."""
        self._used |= {self._key(name) for name in names}

    def inner(self) -> Names:
        """Return the names of a scope inside this one."""
        return Names("st" if self._folds else "c", set(self._used), self._refused)


def identifier(text: str) -> str:
    """Return `text` as letters, digits and single underscores, beginning with a letter.

    Accents are dropped (ė becomes e); Greek letters are spelt. Neither language allows a
    leading underscore, and Structured Text no double or trailing one.
    """
    spelt = "".join(_spell(letter) for letter in text)
    plain = unicodedata.normalize("NFKD", spelt).encode("ascii", "ignore").decode()
    words = re.sub(r"[^A-Za-z0-9]+", "_", plain).strip("_")
    if not words:
        return "x"
    return words if words[0].isalpha() else f"x{words}"


def _spell(letter: str) -> str:
    if not letter.isascii():
        try:
            name = unicodedata.name(letter)
        except ValueError:
            return "_"
        if name.startswith("GREEK"):
            return name.split(" LETTER ")[-1].split()[0].lower()
        if not unicodedata.normalize("NFKD", letter).encode("ascii", "ignore"):
            return "_"
    return letter
