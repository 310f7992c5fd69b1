"""Objects with the attributes of pyfuzzylite that are asked for, and nothing of its code.

pyfuzzylite takes a NumPy below 2 and cannot be installed beside fuzzyarm. The engine here is a
ramp from 0 to `slope` over x in 0 .. 1, and its exporter writes that as FLL by hand.
"""

from types import SimpleNamespace

from fuzzylite.engine import Engine, Variable

settings = SimpleNamespace(decimals=3, atol=1e-3)

FLL = """Engine: {name}
InputVariable: x
  range: 0 1
  lock-range: true
  term: low Ramp 1 0
  term: high Ramp 0 1
OutputVariable: y
  range: 0 {slope}
  aggregation: none
  defuzzifier: WeightedAverage TakagiSugeno
  default: nan
  term: nothing Constant 0
  term: all Constant {slope}
RuleBlock:
  conjunction: none
  disjunction: none
  implication: none
  activation: General
  rule: if x is low then y is nothing
  rule: if x is high then y is {term}
"""


class FllExporter:
    def to_string(self, engine):
        slope = f"{engine.slope:.{settings.decimals}f}"
        return FLL.format(name=engine.name, slope=slope, term=engine.term)


__all__ = ["Engine", "FllExporter", "Variable", "settings"]
