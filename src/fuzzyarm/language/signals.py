"""The parts of a controller's lines: times, numbers, sources, sums, options.

Their nodes are the records of :mod:`fuzzyarm.language.model.controller`; here are their reading
from a cursor, their text and the names in them. The sources of signals with their options are the
table :data:`fuzzyarm.language.model.controller.SOURCES`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from fuzzyarm.base.diagnostic import Diagnostic, Figure, Span, Word, span_of
from fuzzyarm.base.numbers import TIMES, number_text
from fuzzyarm.language.model.controller import Amount, AxisSignal, Factor, Product, Source, Time
from fuzzyarm.language.phrases import NameKind, Occurrence
from fuzzyarm.language.tokens import Cursor, Fault, name_text
from fuzzyarm.symbolic.sources import CHOICE, SOURCES, Chosen, Condition, OptionKind, Setting

Body = tuple[Source | None, tuple[Product, ...]]
"""The definition of a signal, after ``=``."""


def of_signals(words: Iterable[str]) -> Iterator[Occurrence]:
    """Yield the mentions of signals, gains or partners."""
    for word in words:
        if isinstance(word, AxisSignal):
            yield Occurrence(NameKind.AXIS, word.axis, word.axis.span)
            yield Occurrence(NameKind.SIGNAL, word.signal, word.signal.span, (word.axis,))
        else:
            yield Occurrence(NameKind.SIGNAL, word, span_of(word))


def of_gain(word: str) -> Occurrence:
    """Return the mention of a gain or a partner, where no signal can be."""
    return Occurrence(NameKind.SIGNAL, word, span_of(word), is_gain=True)


# --- Times and numbers ---


def read_time(cursor: Cursor, what: str, turns: float | None = None) -> Time:
    """Read a number and a unit.

    `turns` is the product of a frequency and the corresponding time: 1 for a period, 1/(2 pi) for
    the time constant of a cut-off, None for neither.
    """
    figure = cursor.figure(what)
    cursor.suggest("times")
    token = cursor.peek()
    if token is None or token.kind != "name" or token.text not in TIMES:
        raise Fault(_without_unit(figure, cursor, turns))
    return Time(figure, cursor.take().text)


def time_text(time: Time) -> str:
    """Return the text of a time."""
    return f"{number_text(time.figure)} {time.unit}"


UNITS_ELSEWHERE = {
    **dict.fromkeys(("sec", "secs", "second", "seconds"), "s"),
    **dict.fromkeys(("msec", "msecs", "millis", "millisecond", "milliseconds"), "ms"),
    **dict.fromkeys(("µs", "μs", "usec", "usecs", "microsecond", "microseconds"), "us"),
    **dict.fromkeys(("mins", "minute", "minutes"), "min"),
    **dict.fromkeys(("hr", "hrs", "hour", "hours"), "h"),
}
"""Other names of units of time, in lower case."""

HERTZ = {"hz": 1.0, "khz": 1e3}


def _without_unit(figure: Figure, cursor: Cursor, turns: float | None) -> Diagnostic:
    """Describe a number in the position of a time without a unit."""
    token = cursor.peek()
    text_there = "nothing" if token is None or token.kind == "mark" else f"'{token.text}'"
    number = number_text(figure)
    message = f"expected a unit of time after {number}, found {text_there}"
    small = token.text.lower() if token is not None else ""
    unit = UNITS_ELSEWHERE.get(small) or (small if small in TIMES else None)
    if unit is not None:
        hint = f"write  {number} {unit}"
        return Diagnostic("missing-unit", message, cursor.span, hint=hint, replacement=unit)
    if small in HERTZ and figure > 0.0:
        span = figure.span.to(cursor.span)
        message = f"expected a time, not a frequency: {number} {token.text if token else ''}"
        if turns is None:
            return Diagnostic("missing-unit", message, span, hint=f"one of {', '.join(TIMES)}")
        milliseconds = float(f"{1e3 * turns / (HERTZ[small] * figure):.6g}")
        time = f"{number_text(milliseconds)} ms"
        if turns != 1.0:
            message += "; the time constant of a cut-off is 1 / (2 pi f)"
        return Diagnostic("missing-unit", message, span, hint=f"write  {time}", replacement=time)
    hint = f"one of {', '.join(TIMES)}, as in  {number} s"
    return Diagnostic("missing-unit", message, cursor.span, hint=hint)


def _with_unit(word: Word, figure: Figure, unit: str, span: Span) -> Diagnostic:
    """Describe a unit after a number that has the unit of a signal."""
    message = f"the {word} is a number in the unit of its signal, found '{unit}' after it"
    number = number_text(figure)
    hint = f'leave it out, or write  gain NAME = {number} "{unit}"  above and  {word} NAME'
    return Diagnostic("trailing-text", message, span, hint=hint)


def read_amount(cursor: Cursor) -> Amount:
    """Read numbers and ``pi`` between ``*`` and ``/``, up to something else."""
    start = cursor.span
    factors = [(_amount_factor(cursor), False)]
    while cursor.next_is("*") or cursor.next_is("/"):
        divides = cursor.take().text == "/"
        factors.append((_amount_factor(cursor), divides))
    return Amount(tuple(factors), start.to(cursor.tokens[cursor.position - 1].span))


def _amount_factor(cursor: Cursor) -> Figure | None:
    return None if cursor.accept("pi") else cursor.figure("a number or pi")


def amount_text(amount: Amount) -> str:
    """Return the text of an amount."""
    text = ""
    for figure, divides in amount.factors:
        text += ("/" if divides else "*") if text else ""
        text += "pi" if figure is None else number_text(figure)
    return text


def read_number(cursor: Cursor, what: str) -> Figure | Word:
    """Read a number, or the name of a gain."""
    cursor.suggest("signals")
    return cursor.figure(what) if cursor.at_figure else _read_seen(cursor, f"{what}, or a gain")


def number_or_name(value: str | float) -> str:
    """Return the text of a number, or a name."""
    return signal_text(value) if isinstance(value, str) else number_text(value)


def _read_seen(cursor: Cursor, what: str) -> Word:
    """Read the name of a signal, of another axis after ``AXIS.``."""
    word = cursor.name(what)
    if not cursor.accept("."):
        return word
    name = cursor.name(f"a signal of the axis '{word}'")
    return AxisSignal.of(word, name)


def signal_text(name: str) -> str:
    """Return the written name of a signal."""
    if isinstance(name, AxisSignal):
        return f"{name_text(name.axis)}.{name_text(name.signal)}"
    return name_text(name)


# --- Sums ---


def _read_factor(cursor: Cursor, divides: bool = False) -> Factor:
    """Read a number, or the name of a signal, a gain or a partner."""
    cursor.suggest("signals")
    # A sign belongs to the sum, which rejects `a - -1`.
    if cursor.at_figure and not cursor.next_is("-") and not cursor.next_is("+"):
        return Factor(cursor.figure("a number"), divides)
    # `partner * k` is a product with a signal of that name.
    if cursor.next_is("partner") and not cursor.next_is("*", 1):
        cursor.take()
        return Factor(cursor.name("the name of a partner"), divides, partner=True)
    return Factor(_read_seen(cursor, "a signal, a gain or a number"), divides)


def _factor_text(factor: Factor) -> str:
    return ("partner " if factor.partner else "") + number_or_name(factor.value)


def read_sum(cursor: Cursor) -> tuple[Product, ...]:
    """Read a sum of products."""
    negative = cursor.accept("-") is not None
    products = [Product(_read_factors(cursor, _read_factor(cursor)), negative)]
    while cursor.next_is("+") or cursor.next_is("-"):
        negative = cursor.take().text == "-"
        products.append(Product(_read_factors(cursor, _read_factor(cursor)), negative))
    return tuple(products)


def _read_factors(cursor: Cursor, *first: Factor) -> tuple[Factor, ...]:
    """Read the part after ``*`` and ``/``, where a number may have a sign."""
    factors = list(first)
    while cursor.next_is("*") or cursor.next_is("/"):
        divides = cursor.take().text == "/"
        if cursor.at_figure:
            factors.append(Factor(cursor.figure("a number"), divides))
        else:
            factors.append(_read_factor(cursor, divides))
    return tuple(factors)


def sum_text(products: tuple[Product, ...]) -> str:
    """Return the text of a sum of products."""
    text = ""
    for product in products:
        if text:
            text += " - " if product.negative else " + "
        elif product.negative:
            text = "-"
        first, *others = product.factors
        text += _factor_text(first) + _factors_text(others)
    return text


def _factors_text(factors: Iterable[Factor]) -> str:
    return "".join(f" {'/' if f.divides else '*'} {_factor_text(f)}" for f in factors)


def names_in_sum(products: tuple[Product, ...]) -> Iterator[Occurrence]:
    """Yield the signals, gains and partners in a sum."""
    factors = (factor.value for product in products for factor in product.factors)
    yield from of_signals(value for value in factors if isinstance(value, str))


# --- Inputs of a call, options ---


def read_inputs(cursor: Cursor) -> tuple[Word, ...]:
    """Read ``(S, …)`` after the name of a rule base or a table."""
    cursor.expect("(", "before the inputs")
    inputs = read_signals(cursor)
    cursor.expect(")", "after the inputs")
    return inputs


def inputs_text(inputs: tuple[str, ...]) -> str:
    """Return the inputs of a call as they are written."""
    return f"({', '.join(map(signal_text, inputs))})"


def read_signals(cursor: Cursor) -> tuple[Word, ...]:
    """Read signals with commas between them."""
    signals: list[Word] = []
    while not signals or cursor.accept(","):
        cursor.suggest("signals")
        signals.append(_read_seen(cursor, "a signal"))
    return tuple(signals)


Given = tuple[tuple[Word, Setting], ...]
"""Options as they are written."""


def read_options(cursor: Cursor, kinds: Mapping[str, OptionKind]) -> Given:
    """Read the options of a source, each after a comma."""
    options = []
    while cursor.accept(","):
        if not kinds:
            cursor.fail("the end of the line", (), "trailing-text")
        with cursor.up_to(","):
            options.append(_read_option(cursor, kinds))
    return tuple(options)


def _read_option(cursor: Cursor, kinds: Mapping[str, OptionKind]) -> tuple[Word, Setting]:
    word = cursor.word(f"one of {', '.join(kinds)}", kinds, "unknown-option")
    kind = kinds[word]
    if kind.accepts == "words":
        for keyword in kind.rest:
            cursor.expect(keyword, f"after {word}")
        return word, True
    if kind.accepts == "time":
        # A filter's time constant is 1 / (2 pi f) of its cut-off frequency f.
        return word, read_time(cursor, f"the time of {word}", 0.5 / math.pi)
    if kind.accepts == "range":
        low = cursor.figure("the lower end", finite=False)
        cursor.expect("..", "between the ends of the range")
        return word, (low, cursor.figure("the upper end", finite=False))
    if kind.accepts == "windup":
        if cursor.accept("hold"):
            return word, "hold"
        cursor.expect("back", f"or 'hold' after {word}")
        return word, read_time(cursor, "the time to go back in")
    if kind.accepts == "figure":
        amount: Figure | Word = cursor.figure(f"a number after {word}")
    else:
        amount = read_number(cursor, f"the {word}")
    value: Setting = amount
    token = cursor.peek()
    if kind.accepts == "chosen":
        cursor.expect("where", f"after '{number_or_name(amount)}'")
        value = Chosen(amount, read_condition(cursor))
    elif kind.alike and isinstance(amount, Figure) and token and token.kind != "mark":
        raise Fault(_with_unit(word, amount, token.text, cursor.span))
    return word, value


def options_text(options: Iterable[tuple[str, Setting]], kinds: Mapping[str, OptionKind]) -> str:
    """Return options as they are written, each after its comma."""
    return "".join(f", {_option_text(word, value, kinds[word])}" for word, value in options)


def _option_text(word: str, value: Setting, kind: OptionKind) -> str:
    if isinstance(value, Chosen):
        return f"{word} {chosen_text(value)}"
    if isinstance(value, tuple):
        return f"{word} {number_text(value[0])} .. {number_text(value[1])}"
    if isinstance(value, Time):
        return f"{word} {'back ' if kind.accepts == 'windup' else ''}{time_text(value)}"
    if isinstance(value, bool) or kind.accepts == "windup":
        return " ".join((word, *(kind.rest or ("hold",))))
    return f"{word} {number_or_name(value)}"


def names_in_options(
    options: Iterable[tuple[str, Setting]], kinds: Mapping[str, OptionKind]
) -> Iterator[Occurrence]:
    """Yield the gains in options."""
    for word, value in options:
        if isinstance(value, Chosen):
            yield from of_signals(value.names())
        elif isinstance(value, str) and kinds[word].accepts != "windup":
            yield of_gain(value)


# --- Sources ---


def read_body(cursor: Cursor) -> Body:
    """Read the definition of a signal: a source with factors and options, or a sum of products."""
    source = _read_source(cursor)
    if source is None:
        begin = cursor.span
        products = read_sum(cursor)
        if cursor.accept("where"):
            return _read_choice(cursor, products, begin), (Product(()),)
        return None, products
    factors = _read_factors(cursor)
    options = read_options(cursor, source.record.options)
    return replace(source, options=options), (Product(factors),)


def _read_choice(cursor: Cursor, products: tuple[Product, ...], begin: Span) -> Source:
    """Read the rest of ``A where CONDITION else B``."""
    (first, *_), name = products, products[0].factors[0].value
    if len(products) > 1 or len(first.factors) > 1 or first.negative or not isinstance(name, str):
        message = "a signal or a gain is chosen by 'where', one by its name"
        hint = "give a sum a line of its own; a number may follow 'else'"
        raise Fault(Diagnostic("unexpected-token", message, begin, hint=hint))
    condition = read_condition(cursor)
    cursor.expect("else", "after the condition")
    other = read_number(cursor, "a signal or a number")
    return Source(CHOICE.name, name, options=((Word("otherwise"), Chosen(other, condition)),))


def read_condition(cursor: Cursor) -> Condition:
    """Read comparisons joined by ``and``, ``or`` and ``not``; ``and`` binds closer than ``or``."""
    condition = _read_both(cursor)
    while cursor.accept("or"):
        condition = Condition("or", (condition, _read_both(cursor)))
    return condition


def _read_both(cursor: Cursor) -> Condition:
    condition = _read_one(cursor)
    while cursor.accept("and"):
        condition = Condition("and", (condition, _read_one(cursor)))
    return condition


def _read_one(cursor: Cursor) -> Condition:
    if cursor.accept("not"):
        return Condition("not", (_read_one(cursor),))
    if cursor.accept("("):
        condition = read_condition(cursor)
        cursor.expect(")", "after the condition")
        return condition
    first = read_number(cursor, "a signal or a number")
    sign = next((sign for sign in SIGNS if cursor.accept(sign, likely=True)), "")
    if not sign:
        cursor.fail(f"one of {', '.join(SIGNS)} after '{number_or_name(first)}'")
    return Condition(sign, (first, read_number(cursor, "a signal or a number")))


SIGNS = ("<", "<=", ">", ">=")
"""Comparisons."""


def condition_text(condition: Condition) -> str:
    """Return the text of a condition."""
    if condition.word in SIGNS:
        first, second = (number_or_name(part) for part in condition.operands())
        return f"{first} {condition.word} {second}"
    parts = [
        f"({condition_text(part)})" if _is_looser(part, condition) else condition_text(part)
        for part in condition.parts
        if isinstance(part, Condition)
    ]
    return f"not {parts[0]}" if condition.word == "not" else f" {condition.word} ".join(parts)


def _is_looser(part: Condition, whole: Condition) -> bool:
    """Whether a part of a condition needs parentheses."""
    closeness = ("or", "and", "not")
    order = closeness.index(whole.word)
    if part.word not in closeness:
        return False
    return closeness.index(part.word) < order or (
        part is whole.parts[-1] and part.word == whole.word != "not"
    )


def chosen_text(chosen: Chosen) -> str:
    """Return a signal and when it counts."""
    return f"{number_or_name(chosen.value)} where {condition_text(chosen.condition)}"


def _read_source(cursor: Cursor) -> Source | None:
    """Read a source without its options; None where the next word is none."""
    cursor.suggest("sources")
    token = cursor.peek()
    following = cursor.peek(1)
    means_one = following is not None and (following.kind, following.text) == ("name", "of")
    if token is None or token.kind != "name" or (token.text not in SOURCES and not means_one):
        return None
    if following is not None and following.kind not in ("name", "quoted"):
        return None  # a signal named like a source
    kind = cursor.word(f"one of {', '.join(SOURCES)}", SOURCES, "unknown-source")
    of = SOURCES[kind].of
    if of == "call":
        cursor.suggest("sheets")
        name = cursor.name(f"the name of the {kind}")
        return Source(kind, name, read_inputs(cursor))
    phrase = str(kind)
    for word in SOURCES[kind].joined.split():
        cursor.expect(word, f"after {phrase}")
        phrase += f" {word}" if word == "of" else ""
    if of == "signal":
        cursor.suggest("signals")
        return Source(kind, _read_seen(cursor, "a signal"))
    cursor.suggest("ports")
    return Source(kind, cursor.name("a port of the plant"))


def choice_text(source: Source) -> str:
    """Return the text of a choice between two signals."""
    (_, other), *_ = source.options
    assert isinstance(other, Chosen)
    condition = condition_text(other.condition)
    return f"{signal_text(source.name)} where {condition} else {number_or_name(other.value)}"


def source_text(body: Body) -> str:
    """Return the text of a signal's definition."""
    source, products = body
    if source is None:
        return sum_text(products)
    if source.kind == CHOICE.name:
        return choice_text(source)
    (product,) = products
    options = options_text(source.options, source.record.options)
    return operand_text(source) + _factors_text(product.factors) + options


def operand_text(source: Source) -> str:
    """Return the kind of a source with its operand, without options."""
    inputs = inputs_text(source.inputs) if source.record.of == "call" else ""
    return f"{source.kind}{source.record.joined} {signal_text(source.name)}{inputs}"


def names_in_source(body: Body) -> Iterator[Occurrence]:
    """Yield the names in a signal's definition."""
    source, products = body
    if source is not None:
        of = source.record.of
        if of == "signal":
            yield from of_signals((source.name,))
        else:
            kind = NameKind.USE if of == "call" else NameKind.PORT
            yield Occurrence(kind, source.name, span_of(source.name))
        yield from of_signals(source.inputs)
    yield from names_in_sum(products)
    if source is not None:
        yield from names_in_options(source.options, source.record.options)
