"""The commands, as a table: the module of a command is imported when it is called.

A command is a module with ``configure(parser)``, which adds its arguments, and
``run(arguments) -> int``, which does the work and returns the exit status.
"""

from __future__ import annotations

COMMANDS: dict[str, tuple[str, str]] = {
    "check": ("fuzzyarm.cli.check", "find mistakes and doubts in rule bases and tables"),
    "fmt": ("fuzzyarm.cli.fmt", "rewrite rule bases in canonical form"),
    "eval": ("fuzzyarm.cli.eval", "the outputs at one point, and why"),
    "show": ("fuzzyarm.cli.show", "rules, terms and tables in the terminal"),
    "plot": ("fuzzyarm.cli.plot", "terms and control surfaces as a figure"),
    "compile": ("fuzzyarm.cli.compile", "sample a rule base to a lookup table"),
    "diff": ("fuzzyarm.cli.diff", "what differs between two tables or rule bases"),
    "convert": ("fuzzyarm.cli.convert", "rule bases of other programs, in and out"),
    "corpus": ("fuzzyarm.cli.corpus", "how a folder of other programs' files comes in"),
    "simulate": ("fuzzyarm.cli.simulate", "run a controller on the robot arm"),
    "learn": ("fuzzyarm.cli.learn", "train a table on the robot arm and see it grow"),
    "reproduce": ("fuzzyarm.cli.reproduce", "run the study's published experiments again"),
    "identify": ("fuzzyarm.cli.identify", "fit unprinted gains to published figures"),
    "new": ("fuzzyarm.cli.new", "a commented rule base to start from"),
    "studio": ("fuzzyarm.cli.studio", "write a rule base and see what it means, as you type"),
    "watch": ("fuzzyarm.cli.watch", "draw a file again whenever it is saved"),
    "lsp": ("fuzzyarm.cli.lsp", "the language server for editors"),
    "demo": ("fuzzyarm.cli.demo", "the whole story on a shipped rule base"),
}
"""Name → (module, one-line summary), in the order of the help page."""
