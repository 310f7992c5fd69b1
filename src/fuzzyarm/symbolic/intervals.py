"""Functions of intervals: hull, intersection, width, magnitude, operations of the table."""

from __future__ import annotations

from fuzzyarm.symbolic.operations import OPERATIONS, Interval


def combine(operation: str, a: Interval, b: Interval) -> Interval:
    """Return the bounds of an operation, not rounded outward."""
    return OPERATIONS[operation].bounds(a, b)


def hull(*intervals: Interval) -> Interval:
    """Return the smallest interval around some intervals."""
    return Interval(
        min(interval.low for interval in intervals), max(interval.high for interval in intervals)
    )


def overlap(a: Interval, b: Interval) -> Interval:
    """Return the intersection of two intervals; its ends cross if it is empty."""
    return Interval(max(a.low, b.low), min(a.high, b.high))


def width(interval: Interval) -> float:
    """Return the width of an interval, 0 if its ends cross."""
    return max(0.0, interval.high - interval.low)


def largest(interval: Interval) -> float:
    """Return the largest magnitude in an interval."""
    return max(abs(interval.low), abs(interval.high))


def symmetric(size: float) -> Interval:
    """Return the interval of all values up to a magnitude."""
    return Interval(-size, size)
