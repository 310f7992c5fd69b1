"""Identifiers of the exported languages for the names in a file."""

from __future__ import annotations

import keyword
import re
import unicodedata
from collections.abc import Iterable, Mapping
from types import MappingProxyType

from fuzzyarm.symbolic.operations import OPERATIONS

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

C_FUNCTIONS = frozenset(
    operation.c[1:].partition("(")[0]
    for operation in OPERATIONS.values()
    if operation.c.startswith("@")
)
"""Functions of ``math.h`` in printed expressions, in double precision."""

C_RESERVED = frozenset([*_C_WORDS.split(), *C_FUNCTIONS, *(f"{name}f" for name in C_FUNCTIONS)])
"""Words of C and C++, of the included headers, and macros of common compilers."""

_ST_WORDS = """
    abs abstract acos action add add_dt_time add_time add_tod_time adr adrinst and and_then
    andn any any_bit any_char any_date any_derived any_elementary any_int any_magnitude
    any_num any_real any_signed any_string any_unsigned array asin at atan atan2 bit bitadr
    bool by byte cal calc calcn case char class concat concat_date_tod configuration constant
    continue cos ctd ctu ctud date date_and_time day_of_week delete derivative dint div
    divtime do dt dword else elsif en end end_action end_case end_class end_configuration
    end_for end_function end_function_block end_if end_interface end_method end_namespace
    end_program end_property end_repeat end_resource end_step end_struct end_transition
    end_type end_union end_var end_while eno eq exit exp expt extends f_edge f_trig false
    final find for from function function_block ge gt hysteresis if implements in indexof ini
    initial_step insert int integral interface internal interval is_valid is_valid_bcd jmp
    jmpc jmpcn ld ldate ldate_and_time ldn ldt le left len limit lint ln log lower_bound lreal
    lt ltime ltime_of_day ltod lword max method mid min mod move mul multime mux namespace ne
    non_retain not null of on or or_else orn overlap override persistent pid pointer pow
    priority private program property protected pt public q r r_edge r_trig ramp read_only
    read_write real ref ref_to reference repeat replace resource ret retain retc retcn return
    right rol ror round rs rtc s sel sema shl shr sin single sint sizeof split_date split_dt
    split_tod sqrt sr st step stn string struct sub sub_time super tan task then this time
    time_of_day to tod tof ton tp transition true trunc trunc_int type udint uint ulint union
    until upper_bound using usint uxint var var_access var_config var_external var_generic
    var_global var_in_out var_input var_inst var_output var_stat var_temp wchar while with
    word wstring xint xor xorn xsizeof xword
"""

ST_RESERVED = frozenset(_ST_WORDS.split())
"""Words and standard functions of IEC 61131-3 and of the large tools, in lower case.

The language ignores case. Every block and function has an ``EN`` and an ``ENO``.
"""

_JAVASCRIPT_WORDS = """
    abstract arguments async await boolean break byte case catch char class const continue debugger
    default delete do double else enum eval export extends false final finally float for function
    get goto if implements import in instanceof int interface let long native new null of package
    private protected public return set short static super switch synchronized this throw throws
    transient true try typeof undefined var void volatile while with yield
    Array BigInt Controller Float64Array Infinity Int32Array Math NaN Number Object String
    infer inferMany inputs outputs selfTest
"""

_PYTHON_WORDS = "Controller abs array float int math max min print range round self self_test"

_RUST_WORDS = """
    Self abstract as async await become bool box break char const continue crate do dyn else enum
    extern f32 f64 false final fn for gen i128 i16 i32 i64 i8 if impl in isize let loop macro match
    mod move mut override priv pub ref return self static str struct super trait true try type
    typeof u128 u16 u32 u64 u8 union unsafe unsized usize use virtual where while yield
    Controller None Option Some core libm main self_test std
"""

RESERVED: Mapping[str, frozenset[str]] = MappingProxyType({
    "c": C_RESERVED,
    "st": ST_RESERVED,
    "python": frozenset([*keyword.kwlist, *_PYTHON_WORDS.split()]),
    "javascript": frozenset(_JAVASCRIPT_WORDS.split()),
    "rust": frozenset(_RUST_WORDS.split()),
})  # fmt: skip
"""Reserved words by language: keywords, and names in the exported files themselves."""

_ST_TYPE = (
    r"(bool|l?real|u?[sdl]?int|byte|[dl]?word|bcd|w?string|w?char|l?time|l?date|l?dt|l?tod|any)"
)
ST_CONVERSION = re.compile(
    rf"({_ST_TYPE}_)?(to|trunc)_{_ST_TYPE}|{_ST_TYPE}_trunc", re.IGNORECASE | re.ASCII
)
"""Conversions, as in ``REAL_TO_INT``."""

_PATTERNS = {"st": ST_CONVERSION, "python": re.compile(r"K\d+")}
"""Further reserved names by language; those of Python are its constants."""


ARDUINO_MACROS = re.compile(
    r"B[01]{1,8}|P(IN|ORT)?[A-L][0-7]?|SP[A-Z]*\d?|S[EM]\d?|SREG|[XYZ][HL]|PI|F|AVR|HIGH|LOW|INPUT"
    r"|OUTPUT|DEFAULT|EULER|SERIAL|DISPLAY|CHANGE|FALLING|RISING|INTERNAL|EXTERNAL|DEC|HEX|OCT|BIN"
    r"|M_[A-Z]+|(AC|AD|CS|DD|DOR|EE|FE|ICR|ISC|OCR|TC|TOV|TW|UB|UD|WD|WG)[A-Z0-9]*"
    r"|abs|min|max|round|constrain|radians|degrees|sq|bit|map|word|byte|boolean"
)
"""Macros and types in the headers of an Arduino sketch."""


DEVICES = frozenset(
    ["CON", "PRN", "AUX", "NUL", *(f"{port}{i}" for port in ("COM", "LPT") for i in range(1, 10))]
)
"""File and folder names forbidden on Windows, with any suffix."""


class Names:
    """A source of valid, distinct identifiers.

    Parameters
    ----------
    language : str
        Key of `RESERVED`; names in Structured Text are case-insensitive.
    reserved : set of str, optional
        Names already in use.
    refused : pattern, optional
        Pattern of further forbidden names.
    """

    def __init__(
        self,
        language: str = "c",
        reserved: set[str] | None = None,
        refused: re.Pattern[str] | None = None,
    ) -> None:
        self._refused = refused
        self._language, self._folds = language, language == "st"
        self._reserved = RESERVED[language]
        self._used = {self._key(name) for name in reserved or ()}

    def _key(self, name: str) -> str:
        return name.lower() if self._folds else name

    def new(self, stem: str) -> str:
        """Return a new identifier similar to `stem`."""
        base = identifier(stem)
        patterns = [self._refused, _PATTERNS.get(self._language)]
        refused = any(pattern and pattern.fullmatch(base) for pattern in patterns)
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
        """Names in use, in lower case for a case-insensitive language."""
        return frozenset(self._used)

    def take(self, names: Iterable[str]) -> None:
        """Reserve names chosen elsewhere."""
        self._used |= {self._key(name) for name in names}

    def inner(self) -> Names:
        """Return the names of a scope inside this one."""
        return Names(self._language, set(self._used), self._refused)


def identifier(text: str) -> str:
    """Return `text` as letters, digits and single underscores, beginning with a letter.

    Accents are dropped (ė becomes e); Greek letters are spelt. C reserves leading
    underscores, Structured Text has no double or trailing ones.
    """
    words = re.sub(r"[^A-Za-z0-9]+", "_", in_ascii(text)).strip("_")
    if not words:
        return "x"
    return words if words[0].isalpha() else f"x{words}"


def in_ascii(text: str) -> str:
    """Return text without accents, with Greek letters spelt out; anything else becomes ``_``."""
    spelt = "".join(_spell(letter) for letter in text)
    return unicodedata.normalize("NFKD", spelt).encode("ascii", "ignore").decode()


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
