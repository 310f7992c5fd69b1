"""No function takes more than eight parameters; what more there is to say is a record."""

import ast

from sources import MODULES, SOURCE, tree

MOST = 8

ESTIMATORS = {"apps/estimators.py: __init__"}
"""scikit-learn reads the parameters of an estimator from the signature of its constructor."""


def functions_of(node, in_class=False):
    """Yield functions of a module, and whether the first parameter is the object itself."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef):
            decorators = [ast.unparse(decorator) for decorator in child.decorator_list]
            yield child, in_class and "staticmethod" not in decorators, decorators
        yield from functions_of(child, isinstance(child, ast.ClassDef))


def parameters(function, *, is_method):
    """Return how many parameters a caller can fill in."""
    arguments = function.args
    named = (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)
    rest = (arguments.vararg, arguments.kwarg)
    return len(named) - is_method + sum(part is not None for part in rest)


def test_no_function_takes_more_than_eight_parameters():
    """Kernels are excepted: machine code has no records."""
    offenders = []
    for path in MODULES:
        for function, is_method, decorators in functions_of(tree(path)):
            name = f"{path.relative_to(SOURCE)}: {function.name}"
            count = parameters(function, is_method=is_method)
            if count > MOST and "kernel" not in decorators and name not in ESTIMATORS:
                offenders.append(f"{name} takes {count}")
    assert offenders == []


def test_parameters_are_counted():
    def count(text, **given):
        return parameters(ast.parse(text).body[0], **given)

    assert count("def f(a, b, /, c, *d, e=1, **g): ...", is_method=False) == 6
    assert count("def f(self, a): ...", is_method=True) == 1
