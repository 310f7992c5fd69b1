"""A position in the tokens of one statement, and the faults found there."""

from __future__ import annotations

import math

from fuzzyarm.rulebase.diagnostic import Diagnostic, Span
from fuzzyarm.rulebase.near import near_hint
from fuzzyarm.rulebase.syntax.nodes import Figure, Word
from fuzzyarm.rulebase.syntax.tokens import Token
from fuzzyarm.rulebase.syntax.words import RESERVED


class Fault(Exception):  # noqa: N818 - it never leaves the parser
    """Reading the statement cannot go on; carries the diagnostic."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic.message)
        self.diagnostic = diagnostic


class Cursor:
    """Tokens and a position.

    Parameters
    ----------
    tokens : sequence of Token
        At least one.
    """

    def __init__(self, tokens: tuple[Token, ...] | list[Token]) -> None:
        self.tokens = tokens
        self.position = 0
        self.forgiven: list[Diagnostic] = []

    @property
    def at_end(self) -> bool:
        """Whether every token has been taken."""
        return self.position >= len(self.tokens)

    @property
    def span(self) -> Span:
        """The place of the next token, or the place just behind the last one."""
        if not self.at_end:
            return self.tokens[self.position].span
        last = self.tokens[-1]
        return Span(last.line, last.end, last.line, last.end + 1)

    @property
    def whole(self) -> Span:
        """From the first to the last token."""
        return self.tokens[0].span.to(self.tokens[-1].span)

    def peek(self, ahead: int = 0) -> Token | None:
        """Return the next token (or one further `ahead`) without taking it."""
        index = self.position + ahead
        return self.tokens[index] if index < len(self.tokens) else None

    def next_is(self, text: str) -> bool:
        """Whether the next token is the unquoted word or mark `text`."""
        token = self.peek()
        return token is not None and token.kind in ("name", "mark") and token.text == text

    def take(self) -> Token:
        """Take the next token."""
        token = self.tokens[self.position]
        self.position += 1
        return token

    def accept(self, text: str) -> Token | None:
        """Take the next token if it is the word or mark `text`."""
        return self.take() if self.next_is(text) else None

    def expect(self, text: str, where: str) -> Token:
        """Take the word or mark `text`; a fault says that it is missing `where`."""
        if not self.next_is(text):
            self.fail(f"'{text}' {where}", (text,) if text.isalpha() else ())
        return self.take()

    def fail(self, wanted: str, choices: tuple[str, ...] = (), name: str = "") -> None:
        """Raise the fault *expected …, found …*, with a hint if one of `choices` is near."""
        raise Fault(self.fault(wanted, choices, name))

    def fault(self, wanted: str, choices: tuple[str, ...] = (), name: str = "") -> Diagnostic:
        """Return the diagnostic *expected …, found …*."""
        token = self.peek()
        found = "the end of the line" if token is None else f"'{token.text}'"
        hint, replacement = near_hint(token.text, choices) if token else ("", None)
        return Diagnostic(
            name or ("incomplete-statement" if token is None else "unexpected-token"),
            f"expected {wanted}, found {found}",
            self.span,
            hint=hint,
            replacement=replacement,
        )

    def forgive(self, fault: Fault) -> None:
        """Keep the diagnostic of `fault` and skip the rest of the line.

        For faults behind the name that a statement declares: the name is known all the same,
        so its uses are not reported as mistakes too.
        """
        self.forgiven.append(fault.diagnostic)
        self.position = len(self.tokens)

    def name(self, what: str) -> Word:
        """Take a name: a plain word that is not reserved, or one in single quotes."""
        token = self.peek()
        if token is None or token.kind not in ("name", "quoted"):
            self.fail(what)
        elif token.kind == "name" and token.text in RESERVED:
            raise Fault(
                Diagnostic(
                    "reserved-word",
                    f"expected {what}, found the reserved word '{token.text}'",
                    token.span,
                    hint=f"as a name it is written '{token.text}' with its quotes",
                    replacement=f"'{token.text}'",
                )
            )
        taken = self.take()
        return Word(taken.text, taken.span)

    def word(self, what: str, choices: tuple[str, ...], name: str) -> Word:
        """Take one of the words `choices`; a fault is called `name` and hints at the nearest."""
        token = self.peek()
        if token is None or token.kind != "name" or token.text not in choices:
            self.fail(what, choices, name)
        taken = self.take()
        return Word(taken.text, taken.span)

    def string(self) -> str | None:
        """Take a string in double quotes if there is one."""
        token = self.peek()
        if token is None or token.kind != "string":
            return None
        return self.take().text

    @property
    def at_figure(self) -> bool:
        """Whether a number comes next, maybe with a sign."""
        ahead = 1 if self.next_is("-") or self.next_is("+") else 0
        token = self.peek(ahead)
        return token is not None and (
            token.kind == "number" or (token.kind == "name" and token.text in ("inf", "nan"))
        )

    def figure(self, what: str, *, finite: bool = True) -> Figure:
        """Take a number with an optional sign; a fault if it is not finite but must be."""
        if not self.at_figure:
            self.fail(what)
        start = self.span
        sign = -1.0 if self.next_is("-") else 1.0
        if self.next_is("-") or self.next_is("+"):
            self.take()
        token = self.take()
        value = sign * float(token.text)
        span = start.to(token.span)
        if token.kind == "number" and math.isinf(value):
            raise Fault(Diagnostic("bad-number", f"'{token.text}' is too large for a number", span))
        if finite and not math.isfinite(value):
            raise Fault(Diagnostic("bad-number", f"expected {what}, a finite number", span))
        return Figure(value, span)

    def finish(self) -> None:
        """Demand that nothing is left."""
        if not self.at_end:
            self.fail("the end of the line", (), "trailing-text")
