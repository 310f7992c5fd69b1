"""Verdicts on claims about a loop: proved with a certificate, refuted by a run, or undecided.

A search (floats, :mod:`fuzzyarm.closed_loop.search`) proposes certificates; *proved* is said only
of one that :func:`verified` accepts, which makes the loop's form anew and asks the checker.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from fuzzyarm.closed_loop.affine import NotAffineError
from fuzzyarm.closed_loop.certificate import (
    Certificate,
    CertificateError,
    fingerprints_of,
    read_certificate,
)
from fuzzyarm.closed_loop.checker import is_inside, refutation
from fuzzyarm.closed_loop.enclosure import EnclosureError
from fuzzyarm.closed_loop.form import Choice, Form, FormMaker
from fuzzyarm.closed_loop.problem import LoopProblem, LoopProofError, loop_problem
from fuzzyarm.closed_loop.search import proposals, rate_of
from fuzzyarm.controller.text import ControllerText, read_controller
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.loop.course import Options, Sensor
from fuzzyarm.loop.run import Run, simulate
from fuzzyarm.model.claims import LoopClaim
from fuzzyarm.plant.own import find_plant, starting_at
from fuzzyarm.plant.plant import Plant, with_parameters
from fuzzyarm.proof.arithmetic import Stop
from fuzzyarm.proof.bounds import UnprovableError
from fuzzyarm.text.numbers import number_text
from fuzzyarm.text.shown import Shown, one_line

__all__ = ["LoopVerdict", "check_certificate", "claim_text", "prove_loop", "verified"]

PROVED, REFUTED, UNDECIDED = "proved", "refuted", "undecided"

Tell = Callable[[str, int, float], None]


@dataclass(frozen=True, repr=False)
class LoopVerdict(Shown):
    """What is known of a claim about a loop.

    Attributes
    ----------
    statement : str
        The claim, as it stands behind ``prove``.
    verdict : str
        ``proved``, ``refuted`` or ``undecided``.
    region : dict of str to (float, float)
        Where each state and each memory can be in the proved region, an ellipsoid; empty where
        nothing is proved.
    start_region : dict of str to float
        By state of the plant, how far from rest the loop may start along it alone, everything
        else at rest and the controller as it starts.
    certificate : Certificate or None
        What proves it.
    rest : dict of str to float
        Where the loop rests.
    fall : float
        By what share V falls in each period at least; 0 for a loop in continuous time.
    continuous : bool
        Whether the proof is one of the loop in continuous time only.
    evidence : tuple of str
        Of what is refuted, the start and what the run from it did.
    run : Run or None
        That run.
    uncertain : tuple of str
        The blocks of the form: what was taken as an unknown gain.
    pieces : int
        Attempts of the search.
    seconds : float
        How long it took.
    reason : str
        Why it is undecided, or what limits the region.
    line : int
        Of the file; 0 for a claim from elsewhere.
    """

    statement: str
    verdict: str
    region: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    start_region: Mapping[str, float] = field(default_factory=dict)
    certificate: Certificate | None = None
    rest: Mapping[str, float] = field(default_factory=dict)
    fall: float = 0.0
    continuous: bool = False
    evidence: tuple[str, ...] = ()
    run: Run | None = field(default=None, compare=False)
    uncertain: tuple[str, ...] = ()
    pieces: int = 0
    seconds: float = 0.0
    reason: str = ""
    line: int = 0

    @property
    def proved(self) -> bool:
        """Whether it holds."""
        return self.verdict == PROVED

    def __repr__(self) -> str:
        return one_line(self, f"{self.verdict}: {self.statement}")

    def __str__(self) -> str:
        lines = [f"{self.verdict}: {self.statement}"]
        if self.region:
            how = "in continuous time" if self.continuous else "as sampled"
            lines.append(f"  {how}, from everywhere in an ellipsoid around rest that reaches to")
            for name, (low, high) in self.region.items():
                alone = self.start_region.get(name)
                words = "" if alone is None else f" (± {alone:.4g} along it alone)"
                lines.append(f"    {name} in {low:.4g} .. {high:.4g}{words}")
        if self.reason:
            lines.append(f"  {self.reason}")
        return "\n".join([*lines, *(f"  {line}" for line in self.evidence)])


def claim_text(claim: LoopClaim) -> str:
    """Return a claim as it stands behind ``prove``.

    Parameters
    ----------
    claim : LoopClaim
        Which.
    """
    from fuzzyarm.language.loop_claims import claim_node

    return str(claim_node(claim)).removeprefix("prove ")


# ── the case ─────────────────────────────────────────────────────────────────────────


def prove_loop(
    text: ControllerText,
    claim: LoopClaim,
    *,
    plant: Plant | None = None,
    connect: Mapping[str, str] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
    budget: float = math.inf,
    continuous: bool = False,
    tell: Tell | None = None,
) -> LoopVerdict:
    """Prove or refute a claim about a controller in its loop.

    Parameters
    ----------
    text : ControllerText
        The controller.
    claim : LoopClaim
        What is claimed.
    plant : Plant, optional
        In place of the one that the claim names.
    connect : mapping of str to str, optional
        From names of the controller to ports of the plant, where they differ.
    sensors : mapping of str to Sensor, optional
        By port; exact ones by default.
    budget : float
        Seconds after which it stays undecided.
    continuous : bool
        Of the loop as if the controller ran without a period.
    tell : callable, optional
        Called with the claim, the number of attempts and NaN.

    Returns
    -------
    LoopVerdict
        With its certificate or its evidence.
    """
    case = _Case(text, claim, plant, connect, sensors, budget, tell, continuous=continuous)
    return case.verdict()


class _Case:
    """One claim on trial."""

    def __init__(
        self,
        text: ControllerText,
        claim: LoopClaim,
        plant: Plant | None,
        connect: Mapping[str, str] | None,
        sensors: Mapping[str, Sensor] | None,
        budget: float,
        tell: Tell | None,
        *,
        continuous: bool,
    ) -> None:
        self.text, self.claim, self.continuous = text, claim, continuous
        self.statement = claim_text(claim)
        self.plant, self.connect, self.sensors = plant, connect, dict(sensors or {})
        self.started = time.monotonic()
        watch = None if tell is None else (lambda count, gap: tell(self.statement, count, gap))
        self.stop = Stop(budget, watch)
        self.attempts = 0

    def verdict(self) -> LoopVerdict:
        """Judge the claim."""
        self.stop.say(0)
        try:
            problem = problem_of(
                self.text, self.claim, plant=self.plant, connect=self.connect, sensors=self.sensors
            )
        except FuzzyarmError as error:
            return self._said(UNDECIDED, reason=_sentence(error))
        if self.claim.output:
            refuted = self._attacked(problem)
            if refuted is not None:
                return refuted
        try:
            found = self._searched(FormMaker(problem, self.stop))
        except (FuzzyarmError, EnclosureError) as error:
            found = self._said(UNDECIDED, reason=_sentence(error))
        if found.verdict == UNDECIDED and not self.claim.output:
            return self._attacked(problem) or found
        return found

    def _said(self, verdict: str, **facts: Any) -> LoopVerdict:
        return LoopVerdict(
            self.statement,
            verdict,
            pieces=self.attempts,
            seconds=time.monotonic() - self.started,
            line=max(0, self.claim.span.line),
            **facts,
        )

    def _searched(self, maker: FormMaker) -> LoopVerdict:
        best: tuple[float, LoopVerdict] | None = None
        reason = "no quadratic function was found that falls"
        prints = fingerprints_of(self.text, self.text.path) if self.text.path else {}
        for proposal in proposals(
            maker,
            self.claim,
            self.stop,
            continuous=self.continuous,
            wanted=_wanted(maker, self.claim),
        ):
            self.attempts += 1
            self.stop.say(self.attempts)
            if isinstance(proposal, str):
                reason = proposal
                continue
            certificate = Certificate(
                self.claim,
                self.text.path,
                prints,
                proposal.choice,
                self.continuous,
                proposal.p,
                proposal.multipliers,
                proposal.rate,
                proposal.form.names,
            )
            against, facts = verified(maker, certificate, form=proposal.form)
            if against:
                reason = against
                continue
            if best is None or proposal.size > best[0]:
                verdict = self._said(PROVED, certificate=certificate, **facts)
                best = (proposal.size, verdict)
            if self.claim.output:
                break
        if best is not None:
            verdict = self._with_rate(maker, best[1])
            seconds = time.monotonic() - self.started
            return replace(verdict, seconds=seconds, pieces=self.attempts)
        over = "time ran out" if self.stop.now else reason
        return self._said(UNDECIDED, reason=over, rest=_plain(maker.rest))

    def _with_rate(self, maker: FormMaker, verdict: LoopVerdict) -> LoopVerdict:
        """Add by how much V falls in each period."""
        certificate = verdict.certificate
        assert certificate is not None
        if certificate.rate or certificate.continuous:
            return verdict
        form = maker.form(certificate.choice)
        rate = rate_of(form, certificate.p, certificate.multipliers)
        return replace(verdict, certificate=replace(certificate, rate=rate), fall=_float_down(rate))

    # --- runs that refute ---

    def _attacked(self, problem: LoopProblem) -> LoopVerdict | None:
        """Return a refutation by a run, if one of some runs is one."""
        claim = self.claim
        for start, values in _starts(problem, claim):
            run = _simulated(problem, self.sensors, self.connect, start, values, claim)
            if run is None:
                return None
            against = _breach(problem, claim, run, start)
            if against:
                words = ", ".join(f"{name} = {number_text(x)}" for name, x in start.items())
                moved = {
                    n: x
                    for n, x in values.items()
                    if x != problem.parameters[n].low
                    or problem.parameters[n].low != problem.parameters[n].high
                }
                words += "".join(f", {name} = {number_text(x)}" for name, x in moved.items())
                return self._said(REFUTED, evidence=(f"from {words}", against), run=run)
        return None


def problem_of(
    text: ControllerText,
    claim: LoopClaim,
    *,
    plant: Plant | None = None,
    connect: Mapping[str, str] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
) -> LoopProblem:
    """Return the loop of a claim.

    Parameters
    ----------
    text, claim, plant, connect, sensors
        As for :func:`prove_loop`.
    """
    return loop_problem(
        text,
        plant if plant is not None else find_plant(claim.plant),
        start={name: (low, high) for name, low, high in claim.start},
        parameters={name: (low, high) for name, low, high in claim.parameters},
        set_point=dict(claim.at),
        sensors=sensors,
        connect=connect,
    )


def _float_down(x: Fraction) -> float:
    near = float(x)
    return near if Fraction(near) <= x else math.nextafter(near, 0.0)


def _sentence(error: Exception) -> str:
    hint = getattr(error, "hint", "")
    return f"{error} ({hint})" if hint else str(error)


def _plain(values: Mapping[str, Fraction]) -> dict[str, float]:
    return {name: float(value) for name, value in values.items()}


# ── what a certificate proves ────────────────────────────────────────────────────────


def verified(
    maker: FormMaker, certificate: Certificate, *, form: Form | None = None
) -> tuple[str, dict[str, Any]]:
    """Return why a certificate does not prove its claim (empty: it does), and what it proves.

    Parameters
    ----------
    maker : FormMaker
        Of the loop.
    certificate : Certificate
        Which.
    form : Form, optional
        The loop's form under the certificate's choice, where it has been made already.
    """
    if form is None:
        form = maker.form(certificate.choice, continuous=certificate.continuous)
    if certificate.states != form.names:
        return "it is of other states", {}
    p = certificate.p
    against = refutation(form, p, certificate.multipliers, certificate.rate)
    if against:
        return against, {}
    level = Fraction(0)
    claim = certificate.claim
    if claim.start or claim.output:
        for vertex in start_vertices(maker, form):
            level = max(level, _value(p, vertex))
        if level > 1:
            return "its region does not hold the whole start", {}
    reach = _reach(form, Fraction(1), p)
    facts: dict[str, Any] = {
        "region": {
            name: (float(form.rest[name]) - half, float(form.rest[name]) + half)
            for name, half in reach.items()
        },
        "start_region": _along_alone(maker, form, p),
        "rest": _plain(form.rest),
        "fall": float(certificate.rate),
        "continuous": certificate.continuous,
        "uncertain": form.words,
    }
    if claim.output:
        against = _outside(maker, form, certificate, level)
        if against:
            return against, facts
    return "", facts


def _value(p: Sequence[Sequence[Fraction]], z: Sequence[Fraction]) -> Fraction:
    return sum(
        (x * weight * y for x, row in zip(z, p, strict=True) if x
         for weight, y in zip(row, z, strict=True)),
        Fraction(0),
    )  # fmt: skip


def start_vertices(maker: FormMaker, form: Form) -> list[tuple[Fraction, ...]]:
    """Return the corners of the start, as deviations from rest; memory as the loop starts with it.

    Parameters
    ----------
    maker : FormMaker
        Of the loop.
    form : Form
        Of it.
    """
    problem = maker.problem
    ends = [
        tuple(
            dict.fromkeys((Fraction(problem.start[name].low), Fraction(problem.start[name].high)))
        )
        for name in problem.states
    ]
    if 2 ** sum(len(each) > 1 for each in ends) > 4096:
        raise LoopProofError("a start of more than 12 intervals")
    return [
        _with_memory(maker, form, dict(zip(problem.states, corner, strict=True)))
        for corner in product(*ends)
    ]


def _with_memory(
    maker: FormMaker, form: Form, states: Mapping[str, Fraction]
) -> tuple[Fraction, ...]:
    """Return z of the moment before the first period, of states of the plant."""
    begin = maker.begin
    found = []
    for name in form.names:
        if name in states:
            value = states[name]
        elif name in form.seeds:
            seed = form.seeds[name]
            value = seed.constant + sum(
                (w * (states[of] - form.rest[of]) for of, w in seed.parts.items()), Fraction(0)
            )
        else:
            value = Fraction(begin[name])
        found.append(value - form.rest[name])
    return tuple(found)


def _along_alone(maker: FormMaker, form: Form, p: Sequence[Sequence[Fraction]]) -> dict[str, float]:
    """Return how far the loop may start along each state, the memory as it is at the start."""
    rest = {name: form.rest[name] for name in maker.problem.states}
    base = np.array([float(x) for x in _with_memory(maker, form, rest)])
    plain = np.array([[float(x) for x in row] for row in p])
    found = {}
    for name in rest:
        way = (
            np.array([float(x) for x in _with_memory(maker, form, {**rest, name: rest[name] + 1})])
            - base
        )
        a, b, c = way @ plain @ way, 2.0 * way @ plain @ base, base @ plain @ base - 1.0
        inside = b * b - 4.0 * a * c
        if c < 0.0 and inside >= 0.0:
            found[name] = min((-b + math.sqrt(inside)) / (2 * a), (b + math.sqrt(inside)) / (2 * a))
    return found


def _reach(form: Form, level: Fraction, p: Sequence[Sequence[Fraction]]) -> dict[str, float]:
    """Return how far each state is from rest at most where V is at most a level."""
    inverse = np.linalg.inv(np.array([[float(x) for x in row] for row in p]))
    found = {}
    for k, name in enumerate(form.names):
        half = math.sqrt(float(level) * max(float(inverse[k, k]), 0.0))
        row = tuple(Fraction(int(i == k)) for i in range(form.size))
        for wider in (1.0 + 1e-9, 1.0 + 1e-6, 1.01, 2.0):
            if level and is_inside(p, row, Fraction(half * wider), level):
                half *= wider
                break
        else:
            half = 0.0 if not level else math.inf
        found[name] = half
    return found


def _outside(maker: FormMaker, form: Form, certificate: Certificate, level: Fraction) -> str:
    """Return why an output may leave the claimed interval in the claimed time; empty: it cannot."""
    claim = certificate.claim
    if certificate.continuous:
        return "a claim about an output is proved of the sampled loop"
    periods = int(Fraction(claim.begin) / Fraction(maker.problem.period)) if claim.begin else 0
    left = _power_up(1 - certificate.rate, periods) * level
    reach = _reach(form, left, certificate.p)
    if any(math.isinf(half) for half in reach.values()):
        return "its region has no bounds"
    low, high = maker.output_between_samples(claim.output, reach)
    if claim.low <= low and high <= claim.high:
        return ""
    when = f" {claim.begin:g} s after the start" if claim.begin else ""
    return f"{claim.output} stays in {low:.6g} .. {high:.6g}{when}, as far as the region says"


def _power_up(base: Fraction, exponent: int) -> Fraction:
    """Return a power, rounded up to 128 bits."""
    total, factor = Fraction(1), base
    while exponent:
        if exponent & 1:
            total = _up_to_bits(total * factor)
        factor = _up_to_bits(factor * factor)
        exponent >>= 1
    return total


def _up_to_bits(x: Fraction, bits: int = 128) -> Fraction:
    shift = bits - (x.numerator.bit_length() - x.denominator.bit_length())
    if shift <= 0:
        return x
    return Fraction(-((-x.numerator << shift) // x.denominator), 1 << shift)


def _wanted(maker: FormMaker, claim: LoopClaim) -> tuple[float, float] | None:
    return (claim.low, claim.high) if claim.output else None


def check_certificate(
    certificate: Certificate | str, text: ControllerText | None = None, plant: Plant | None = None
) -> LoopVerdict:
    """Check a certificate, without any search.

    Parameters
    ----------
    certificate : Certificate or str
        Or its file.
    text : ControllerText, optional
        The controller; by default its file is read, from the folder at hand or from that of the
        certificate.
    plant : Plant, optional
        In place of the one that the claim names.

    Returns
    -------
    LoopVerdict
        ``proved``, or ``undecided`` with what is wrong.

    Raises
    ------
    CertificateError
        If it is not a certificate, or one of other files.
    """
    started = time.monotonic()
    place = Path(".")
    if isinstance(certificate, str):
        place = Path(certificate).parent
        certificate = read_certificate(certificate)
    if text is None:
        path = next(
            (p for p in (Path(certificate.controller), place / certificate.controller,
                         place / Path(certificate.controller).name) if p.is_file()),
            None,
        )  # fmt: skip
        if path is None:
            raise CertificateError(f"the controller {certificate.controller} is not there")
        text = read_controller(str(path))
    now = fingerprints_of(text, text.path)
    for name, fingerprint in certificate.fingerprints.items():
        if now.get(name) != fingerprint:
            raise CertificateError(f"{name} is not the file that was proved")
    statement = claim_text(certificate.claim)
    try:
        maker = FormMaker(problem_of(text, certificate.claim, plant=plant))
        against, facts = verified(maker, certificate)
    except (NotAffineError, UnprovableError, LoopProofError, EnclosureError) as error:
        against, facts = _sentence(error), {}
    verdict = UNDECIDED if against else PROVED
    return LoopVerdict(
        statement,
        verdict,
        certificate=certificate,
        reason=f"the certificate does not prove it: {against}" if against else "",
        seconds=time.monotonic() - started,
        **({} if against else facts),
    )


# ── runs ─────────────────────────────────────────────────────────────────────────────

RUNS = 24
"""Random starts, beside the corners, from which a claim is attacked."""


def _starts(
    problem: LoopProblem, claim: LoopClaim
) -> Iterator[tuple[dict[str, float], dict[str, float]]]:
    """Yield starts and parameters: corners, then drawn."""
    spans = dict(problem.start)
    if not claim.start and not claim.output:  # stability: from near the set point
        spans = _near_set_point(problem)
    generator = np.random.default_rng(0)
    corners = list(product(*(dict.fromkeys(span) for span in spans.values())))
    values = {name: span.low for name, span in problem.parameters.items()}
    other = {name: span.high for name, span in problem.parameters.items()}
    for corner in corners[:32]:
        start = dict(zip(spans, corner, strict=True))
        yield start, values
        if other != values:
            yield start, other
    if len(corners) > 1 or other != values:
        for _ in range(RUNS):
            yield (
                {n: float(generator.uniform(s.low, s.high)) for n, s in spans.items()},
                {n: float(generator.uniform(s.low, s.high)) for n, s in problem.parameters.items()},
            )


def _near_set_point(problem: LoopProblem) -> dict[str, Any]:
    from fuzzyarm.expression.operations import Interval

    interface = problem.site.interface
    spans = dict(problem.start)
    for (axis, name), port in interface.outputs.items():
        if name in spans:
            wide = port.high - port.low
            off = 1e-3 * (wide if math.isfinite(wide) else 1.0)
            at = problem.set_point[axis, name]
            spans[name] = Interval(at - off, at + off)
    return spans


def _simulated(
    problem: LoopProblem,
    sensors: Mapping[str, Sensor],
    connect: Mapping[str, str] | None,
    start: Mapping[str, float],
    values: Mapping[str, float],
    claim: LoopClaim,
) -> Run | None:
    plant = problem.plant
    if values:
        plant = with_parameters(plant, values)
    plant = starting_at(plant, [start[name] for name in problem.states])
    interface = problem.site.interface
    references = {
        interface.label(port): value
        for port, value in problem.set_point.items()
        if not interface.references[port].order and port in interface.outputs
    }
    duration = plant.duration or 1000 * problem.period
    if claim.output and claim.when == "during" and math.isfinite(claim.end):
        duration = claim.end
    elif claim.begin:
        duration = max(duration, 1.5 * claim.begin)
    try:
        return simulate(
            problem.text,
            plant,
            references=references,
            duration=max(duration, 2 * problem.period * problem.text.model.every),
            options=Options(sensors=dict(sensors)),
            connect=connect,
        )
    except FuzzyarmError:
        return None


def _breach(problem: LoopProblem, claim: LoopClaim, run: Run, start: Mapping[str, float]) -> str:
    """Return in words how a run breaks a claim; empty where it does not."""
    if run.diverged is not None and not claim.output:
        return f"the run diverges after {run.diverged:.4g} s: {run.cause}"
    if claim.output:
        values = np.asarray(run.outputs[claim.output])
        end = claim.end if claim.when == "during" else math.inf
        chosen = (run.time >= claim.begin - 1e-9) & (run.time <= end + 1e-9)
        slack = 1e-9 * (claim.high - claim.low)
        wrong = chosen & ((values > claim.high + slack) | (values < claim.low - slack))
        if wrong.any():
            k = int(np.argmax(wrong))
            return f"{claim.output} = {values[k]:.6g} after {run.time[k]:.6g} s"
        if run.diverged is not None and claim.begin <= run.diverged <= end:
            return f"the run diverges after {run.diverged:.4g} s: {run.cause}"
        return ""
    if claim.start:
        return ""
    # From near rest: it is not stable where the loop swings far beyond where it started.
    interface = problem.site.interface
    for (axis, name), port in interface.outputs.items():
        if name not in run.outputs and interface.label((axis, name)) not in run.outputs:
            continue
        values = np.asarray(run.outputs[interface.label((axis, name))])
        at = problem.set_point[axis, name]
        wide = port.high - port.low
        far = 0.05 * (wide if math.isfinite(wide) else 50.0)
        late = np.abs(values[len(values) // 2 :] - at)
        if name in start and len(late) and late.max() > far and late[-len(late) // 3 :].max() > far:
            return (
                f"{name} is still {late.max():.4g} away after half of {run.time[-1]:.4g} s,"
                f" from {abs(start[name] - at):.4g}"
            )
    return ""
