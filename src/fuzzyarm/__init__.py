"""Fuzzy control from a text file to a robot arm.

    >>> import fuzzyarm
    >>> pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    >>> pd7(e=1.3, ce=-2.2)
    {'u': -1.0677966101694918}

Importing the package is instant: names load their modules on first use. Public are the names
below and those in ``__all__`` of the packages; everything else is private.

Read, check, write
    load                Return the rule base, controller or lookup table in the file at path,
                        by its suffix.
    load_rulebase       Return the rule base in the file at path, by its suffix.
    load_controller     Return the controller in the .frb file at path, with its files.
    parse               Read text as a rule base; never raises.
    check_file          Check a file of any kind that load takes.
    check_text          Check the text of a .frb file: mistakes first; without any, doubts and
                        expectations.
    write               Return canonical text that parses to rulebase again.
    shipped             Return the path of the shipped file name, for instance pd7.frb.

Rule bases and controllers in Python
    RuleBase            A whole fuzzy system as a value: variables, rules, and how the rules
                        are evaluated.
    RuleBaseBuilder     A rule base under construction; its current value is model.
    AnyRuleBase         A rule base: the immutable value of a file, or one under construction.
    ControllerText      A controller as text, with its rule bases and tables.
    Shape               The membership function of a term, or the value of a consequent.
    from_live           Return the rule base of a live object of another fuzzy library.
    kinds               Kinds of shapes, norms, hedges and defuzzifiers, the built-in ones
                        built-in and user-defined.
    op                  The functions for definitions of shapes, norms, hedges and other
                        kinds.

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
    export_file         Write a rule base, a table or a controller as source text or as a
                        program.
    write_table         Write table whole or not at all; read_table gives back an equal table.

Prove, and run on a plant
    prove               Prove or refute properties of a rule base, or of a controller in its
                        loop.
    simulate            Run a controller on a plant, along a trajectory or references.
    simulate_many       Run a controller many times.

Tune
    tune                Tune the gains of a controller and the terms of its rule bases, or of
                        a rule base alone.

What goes wrong
    FuzzyarmError       An error with one clear sentence for a person.
    RuleBaseError       A file or a model that cannot be used.
    FileWarning         A warning of load about a file of another program.

Rooms, each with public names of its own; every one imports only those before it
    base                Foundations of every room, without fuzzy logic.
    symbolic            The mathematics of the language, each definition once.
    language            The language of .frb files: model, reading, canonical printing,
                        checks.
    requests            Requests: one frozen record for each job, field by field.
    inference           Inference: the values of a rule base, exactly as its text defines them.
    table               Lookup tables: the table, the compiler that fills it, and its files.
    plant               Plants: the protocol, the two-link arm of the study with its
                        trajectories, shipped plants.
    control             The closed loop: control laws, and runs of them on a plant.
    proof               Proofs: of a rule base at every point, of a closed loop from every start.
    learning            Rule bases from samples, and judged by samples; controllers that learn
                        along a trajectory.
    exchange            Files and objects of other programs, and programs for other machines.
    apps                User-facing programs and drawings. Nothing imports this room.
"""

from fuzzyarm import interrupts

if interrupts.is_command():
    interrupts.leave()

from fuzzyarm.base import above
from fuzzyarm.base.lazy import lazily
from fuzzyarm.version import __version__ as __version__

NAMES = {
    "apps.builder": ("RuleBaseBuilder",),
    "base.errors": ("FuzzyarmError",),
    "base.shipped_files": ("shipped",),
    "control.controllers": ("ControllerText",),
    "control.loop": ("simulate", "simulate_many"),
    "exchange.files": (
        "FileWarning",
        "check_file",
        "check_text",
        "export_file",
        "load",
        "load_controller",
        "load_rulebase",
    ),
    "exchange.live": ("from_live",),
    "inference": ("compiled", "explain", "infer", "infer_interval"),
    "language": ("RuleBaseError", "parse", "write"),
    "language.model": ("AnyRuleBase", "RuleBase", "Shape"),
    "learning.tuning": ("tune",),
    "proof.loop": ("prove",),
    "symbolic.kinds": ("kinds",),
    "symbolic.op": ("op",),
    "table": ("LookupTable", "compile_table", "compile_with_report", "read_table", "write_table"),
}
"""Public names by their module, which is loaded with the first use of a name."""

__all__ = [name for names in NAMES.values() for name in names]

PACKAGES = (
    "apps",
    "base",
    "control",
    "exchange",
    "inference",
    "language",
    "learning",
    "plant",
    "proof",
    "requests",
    "symbolic",
    "table",
)
"""The rooms: packages with public names of their own."""

above.register(
    {
        "controller_if_any": "fuzzyarm.exchange.files",
        "load": "fuzzyarm.exchange.files",
        "load_rules": "fuzzyarm.exchange.files",
        "load_sampled": "fuzzyarm.exchange.files",
        "load_sheet": "fuzzyarm.exchange.files",
        "read": "fuzzyarm.exchange.formats",
        "RuleBaseBuilder": "fuzzyarm.apps.builder",
        "check_text": "fuzzyarm.exchange.files",
        "compile_table": "fuzzyarm.table",
        "explain": "fuzzyarm.inference",
        "figure_of": "fuzzyarm.apps.notebook",
        "html_of": "fuzzyarm.apps.notebook",
        "infer": "fuzzyarm.inference",
        "rulebase_figure": "fuzzyarm.apps.show.figures",
        "table_of_request": "fuzzyarm.exchange.files",
        "text_in": "fuzzyarm.exchange.formats.conversion",
        "text_of": "fuzzyarm.apps.notebook",
        "write": "fuzzyarm.language",
    }
)  # what values are asked, and who answers: this package knows both

__getattr__, __dir__ = lazily(__name__, NAMES, ("__version__",), PACKAGES)
