"""The engine of the stand-in."""


class Variable:
    def __init__(self, name):
        self.name, self.value, self.enabled = name, float("nan"), True


class Engine:
    def __init__(self, name="", slope=1.0, error=0.0, term="all"):
        self.name, self.slope, self.error, self.term = name, slope, error, term
        self.input_variables, self.output_variables = [Variable("x")], [Variable("y")]

    def restart(self):
        self.output_variables[0].value = float("nan")

    def process(self):
        x = min(1.0, max(0.0, self.input_variables[0].value))
        self.output_variables[0].value = self.slope * x + self.error
