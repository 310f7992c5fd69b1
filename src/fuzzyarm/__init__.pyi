from fuzzyarm import apps as apps
from fuzzyarm import base as base
from fuzzyarm import control as control
from fuzzyarm import exchange as exchange
from fuzzyarm import inference as inference
from fuzzyarm import language as language
from fuzzyarm import learning as learning
from fuzzyarm import plant as plant
from fuzzyarm import proof as proof
from fuzzyarm import requests as requests
from fuzzyarm import symbolic as symbolic
from fuzzyarm import table as table
from fuzzyarm.apps.builder import RuleBaseBuilder
from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.control.controllers import ControllerText
from fuzzyarm.control.loop import simulate, simulate_many
from fuzzyarm.exchange.files import (
    FileWarning,
    check_file,
    check_text,
    export_file,
    load,
    load_controller,
    load_rulebase,
)
from fuzzyarm.exchange.live import from_live
from fuzzyarm.inference import compiled, explain, infer, infer_interval
from fuzzyarm.language import parse, write
from fuzzyarm.language.model import AnyRuleBase, RuleBase, Shape
from fuzzyarm.learning.tuning import tune
from fuzzyarm.proof.loop import prove
from fuzzyarm.symbolic import kinds, op
from fuzzyarm.table import (
    LookupTable,
    compile_table,
    compile_with_report,
    read_table,
    write_table,
)
from fuzzyarm.version import __version__ as __version__

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

PACKAGES: tuple[str, ...]
