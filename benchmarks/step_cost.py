"""What a control step of each controller costs: operations counted, time measured in the loop.

Time is that of the compiled closed loop less that of the same loop with a law that does nothing,
in the same process and in turns; the ratio is to that of a linear PD as text on the same motors
(`pd-motor`), measured in the same run. So is the time of each operation.

usage: python benchmarks/step_cost.py [CONTROLLER ...]
"""

from __future__ import annotations

import sys

from fuzzyarm.apps.study.comparison import compared_names, cost_of

BESIDE = "pd-motor"


def main() -> None:
    """Print a line for each controller."""
    beside = cost_of(BESIDE).seconds
    print("| controller | operations | comparisons among them | ns | ratio | ns an operation |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name in sys.argv[1:] or compared_names():
        cost = cost_of(name)
        total, time = cost.operations.total, 1e9 * cost.seconds
        print(
            f"| {name} | {total:.0f} | {cost.operations.comparisons:.0f} | {time:.0f} "
            f"| {cost.seconds / beside:.2f} | {time / total:.2f} |"
        )


if __name__ == "__main__":
    main()
