"""Fuzzy control from a text file to a robot arm.

    >>> import fuzzyarm
    >>> pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    >>> pd7(e=1.3, ce=-2.2)
    {'u': -1.0677966101694918}

Importing this page is instant: what a name needs is loaded when the name is used. Public is
what is named here and in the ``__all__`` of the packages; everything else is private.

Read, check, write
    load                Return the rule base, controller or lookup table in the file at path, by
                        its suffix.
    load_rulebase       Return the rule base in the file at path, by its suffix.
    load_controller     Return the controller in the .frb file at path, with the files that it
                        uses.
    parse               Read text as a rule base; never raises.
    check_file          Check a file of any kind that load takes.
    check_text          Check the text of a .frb file: mistakes first; without any, doubts and
                        expectations.
    write               Return canonical text that parses to rulebase again.
    shipped             Return the path of the shipped file name, for instance pd7.frb.

Rule bases and controllers in Python
    RuleBase            A whole fuzzy system as a value: variables, rules, and how the rules are
                        evaluated.
    RuleBaseBuilder     A rule base that is being written; what it means by now is its model.
    AnyRuleBase         A rule base: the immutable value that a file means, or one that is being
                        written.
    ControllerText      A controller as text, with the rule bases and tables that it uses.
    Shape               The membership function of a term, or the value of a consequent.
    from_live           Return the rule base that a live object of another fuzzy library is.
    kinds               Kinds of shapes, norms, hedges and defuzzifiers, the built-in ones and a
                        user's own.
    op                  The functions with which shapes, norms, hedges and other definitions are
                        written.

Evaluate
    infer               Evaluate a rule base.
    infer_interval      Evaluate a rule base and return both ends of every output.
    explain             Evaluate one point and show the work.
    compiled            Make a rule base ready to be evaluated fast.

Lookup tables
    compile_table       Sample one output of a rule base.
    compile_with_report Compile a table and measure it against direct inference.
    LookupTable         A grid of values over one or more inputs, with its meaning and its
                        origin.
    read_table          Return the table in a .lut, .csv, .npz or .json file.
    export_file         Write a rule base, a table or a controller as source text or as a program.
    write_table         Write table whole or not at all; read_table gives back an equal table.

Prove, and run on a plant
    prove               Prove or refute properties of a rule base, or of a controller in its loop.
    simulate            Run a controller on a plant, along a trajectory or references.
    simulate_many       Run a controller many times.

Tune
    tune                Tune the gains of a controller and the terms of its rule bases, or of a
                        rule base alone.

What goes wrong
    FuzzyarmError       What went wrong, in one clear sentence to a person.
    RuleBaseError       A file or a model that cannot be used.
    FileWarning         A warning of load about a file of another program.

Packages with public names of their own
    api                 Load and check any file, whatever its kind.
    closed_loop         Proofs of a controller together with its plant: stable, inside, reached.
    controller          Controllers of the arm: the study's, and yours.
    export              Controllers as source text for small machines: C99 and IEC 61131-3
                        Structured Text.
    expression          Everything mathematical that the language can name, each written once.
    formats             Rule bases of other programs, in and out: FLL, FCL, FIS and FML.
    inference           Inference: memberships, norms, defuzzifiers, the engines and the trace
                        of one inference.
    language            The language of .frb files: model, reading, canonical printing, checks.
    learning            Rule bases from samples, and judged by samples; controllers that learn
                        along a trajectory.
    live                Systems of other fuzzy libraries, live: rule bases of them, and how far
                        their numbers differ.
    loop                The closed loop: one run, or many at once, of a controller on a plant.
    model               What a rule base means, free of text: its data, its shapes, its
                        formulas.
    picture             Pictures as data: lines, areas, marks and words in the coordinates of
                        the data.
    plant               Plants: the protocol, the two-link arm of the study and its
                        trajectories, shipped ones.
    proof               What holds of a rule base at every point: bounds, slopes, symmetry,
                        errors of a table.
    show                Drawings of models in the terminal; as figures in fuzzyarm.show.figures.
    sklearn             Estimators of scikit-learn whose model is a rule base that a person can
                        read.
    study               The published experiments: figures as data, and what running them again
                        gives.
    table               Lookup tables: the table, the compiler that fills it, and its files.
    tuning              Tuning: numbers that move until a cost is small, and a text that says
                        what became of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.lazy import lazily
from fuzzyarm.text import above
from fuzzyarm.version import __version__ as __version__

if TYPE_CHECKING:
    from fuzzyarm import api as api
    from fuzzyarm import controller as controller
    from fuzzyarm import export as export
    from fuzzyarm import expression as expression
    from fuzzyarm import formats as formats
    from fuzzyarm import inference as inference
    from fuzzyarm import language as language
    from fuzzyarm import learning as learning
    from fuzzyarm import live as live
    from fuzzyarm import loop as loop
    from fuzzyarm import model as model
    from fuzzyarm import plant as plant
    from fuzzyarm import proof as proof
    from fuzzyarm import show as show
    from fuzzyarm import sklearn as sklearn
    from fuzzyarm import study as study
    from fuzzyarm import table as table
    from fuzzyarm import tuning as tuning
    from fuzzyarm.api import (
        FileWarning,
        check_file,
        check_text,
        export_file,
        load,
        load_controller,
        load_rulebase,
    )
    from fuzzyarm.builder import RuleBaseBuilder
    from fuzzyarm.closed_loop import prove
    from fuzzyarm.controller import ControllerText
    from fuzzyarm.errors import FuzzyarmError
    from fuzzyarm.expression import kinds, op
    from fuzzyarm.inference import compiled, explain, infer, infer_interval
    from fuzzyarm.language import parse, write
    from fuzzyarm.live import from_live
    from fuzzyarm.loop import simulate, simulate_many
    from fuzzyarm.model import AnyRuleBase, RuleBase, Shape
    from fuzzyarm.shipped_files import shipped
    from fuzzyarm.table import (
        LookupTable,
        compile_table,
        compile_with_report,
        read_table,
        write_table,
    )
    from fuzzyarm.text.diagnostic import RuleBaseError
    from fuzzyarm.tuning import tune

__all__ = [
    "AnyRuleBase",
    "ControllerText",
    "FileWarning",
    "FuzzyarmError",
    "LookupTable",
    "RuleBase",
    "RuleBaseBuilder",
    "RuleBaseError",
    "Shape",
    "check_file",
    "check_text",
    "compile_table",
    "compile_with_report",
    "compiled",
    "explain",
    "export_file",
    "from_live",
    "infer",
    "infer_interval",
    "kinds",
    "load",
    "load_controller",
    "load_rulebase",
    "op",
    "parse",
    "prove",
    "read_table",
    "shipped",
    "simulate",
    "simulate_many",
    "tune",
    "write",
    "write_table",
]

PACKAGES = (
    "api",
    "closed_loop",
    "controller",
    "export",
    "expression",
    "formats",
    "inference",
    "language",
    "learning",
    "live",
    "loop",
    "model",
    "picture",
    "plant",
    "proof",
    "show",
    "sklearn",
    "study",
    "table",
    "tuning",
)
"""Packages and modules with public names of their own: those of their ``__all__``."""

above.register(
    {
        "RuleBaseBuilder": "fuzzyarm.builder",
        "check_text": "fuzzyarm.api",
        "compile_table": "fuzzyarm.table",
        "explain": "fuzzyarm.inference",
        "figure_of": "fuzzyarm.notebook",
        "html_of": "fuzzyarm.notebook",
        "infer": "fuzzyarm.inference",
        "rulebase_figure": "fuzzyarm.show.figures",
        "table_of_request": "fuzzyarm.api",
        "text_in": "fuzzyarm.live.conversion",
        "text_of": "fuzzyarm.notebook",
        "write": "fuzzyarm.language",
    }
)  # what values are asked, and who answers: this package knows both

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "api": (
                "FileWarning",
                "check_file",
                "check_text",
                "export_file",
                "load",
                "load_controller",
                "load_rulebase",
            ),
            "builder": ("RuleBaseBuilder",),
            "closed_loop": ("prove",),
            "controller": ("ControllerText",),
            "errors": ("FuzzyarmError",),
            "expression.kinds": ("kinds",),
            "expression.op": ("op",),
            "inference": ("compiled", "explain", "infer", "infer_interval"),
            "language": ("RuleBaseError", "parse", "write"),
            "live": ("from_live",),
            "loop": ("simulate", "simulate_many"),
            "model": ("AnyRuleBase", "RuleBase", "Shape"),
            "shipped_files": ("shipped",),
            "table": (
                "LookupTable",
                "compile_table",
                "compile_with_report",
                "read_table",
                "write_table",
            ),
            "tuning": ("tune",),
        },
        ("__version__",),
        PACKAGES,
    )
