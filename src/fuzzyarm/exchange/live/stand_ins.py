"""Stand-ins for what a script needs and does not get: modules, windows, answers.

A module that is not installed, or that would open a window, serve a port or talk to a device,
becomes an object that swallows everything. Loaded by its path (see
:mod:`fuzzyarm.exchange.live.gather`), maybe by another Python: nothing but the standard library is
used.
"""

from __future__ import annotations

import ast
import builtins
import dis
import importlib.abc
import importlib.machinery
import os
import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from types import FrameType, FunctionType, ModuleType
from typing import Any, Self

ANSWER = "1"
"""What ``input()`` gives."""

MOST_ANSWERS = 100
"""Answers after which ``input()`` has come to its end."""

LIBRARIES = frozenset({"skfuzzy", "simpful", "pyit2fls", "fuzzylogic", "fuzzylite"})
"""Modules that nothing can stand in for: they make the systems."""

REPLACED = frozenset({
    "tkinter", "Tkinter", "turtle", "customtkinter", "ttkbootstrap", "PySimpleGUI", "easygui",
    "PyQt4", "PyQt5", "PyQt6", "PySide", "PySide2", "PySide6", "wx", "kivy", "pygame", "pyglet",
    "arcade", "ursina",
    "flask", "flask_cors", "flask_restful", "fastapi", "uvicorn", "bottle", "cherrypy", "sanic",
    "aiohttp",
    "streamlit", "dash", "gradio", "nicegui", "pywebio", "django", "socketio",
    "serial", "smbus", "smbus2", "spidev", "pigpio", "gpiozero", "RPi", "Adafruit_DHT", "board",
    "busio", "pyfirmata",
    "paho", "telebot", "telegram", "discord", "pyttsx3", "pyautogui", "keyboard", "pynput",
    "winsound",
})  # fmt: skip
"""Modules that show windows, serve or talk to devices: replaced wherever they are installed."""


class _Swallows:
    """Has everything that it is asked for, and swallows everything that is done with it."""

    _stand_in: str  # what it stands for, as the script would write it

    def __getattr__(self, name: str) -> Any:
        # Else copy, pickle and NumPy would believe that it follows their protocols.
        if name.startswith("__") and name.endswith("__"):
            raise AttributeError(name)
        value = _attribute(f"{self._stand_in}.{name}", name)
        object.__setattr__(self, name, value)
        return value

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        if len(arguments) == 1 and not options and isinstance(arguments[0], FunctionType | type):
            return arguments[0]  # a decorator
        return StandIn(f"{self._stand_in}()")

    def __mro_entries__(self, bases: tuple[Any, ...]) -> tuple[type, ...]:
        return (Swallower,)

    def __iter__(self) -> Iterator[Any]:
        return iter([StandIn(f"{self._stand_in}[{i}]") for i in range(_unpacked())])

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def __len__(self) -> int:
        return 0

    def __bool__(self) -> bool:
        return False

    def __contains__(self, _: object) -> bool:
        return False

    def __getitem__(self, key: object) -> StandIn:
        return StandIn(f"{self._stand_in}[{key!r}]")

    def __setitem__(self, key: object, value: object) -> None:
        pass

    def __delitem__(self, key: object) -> None:
        pass

    def __float__(self) -> float:
        return 0.0

    def __int__(self) -> int:
        return 0

    def __index__(self) -> int:
        return 0

    def __round__(self, digits: int = 0) -> float:
        return 0.0

    def __str__(self) -> str:
        return ""

    def __format__(self, _: str) -> str:
        return ""

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        import numpy as np

        return np.zeros((), dtype)

    def __lt__(self, _: object) -> bool:
        return False

    __le__ = __gt__ = __ge__ = __lt__

    def __add__(self, _: object) -> Self:
        return self

    __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = __add__
    __floordiv__ = __rfloordiv__ = __mod__ = __rmod__ = __pow__ = __rpow__ = __add__
    __and__ = __rand__ = __or__ = __ror__ = __xor__ = __rshift__ = __lshift__ = __add__

    def __neg__(self) -> Self:
        return self

    __pos__ = __abs__ = __invert__ = __neg__


class StandIn(_Swallows):
    """What a missing module would give."""

    def __init__(self, name: str) -> None:
        object.__setattr__(self, "_stand_in", name)


class Swallower:
    """The base of a class that is derived from a stand-in."""

    def __init__(self, *_: Any, **__: Any) -> None:
        pass

    def __init_subclass__(cls, **_: Any) -> None:
        pass

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") and name.endswith("__"):
            raise AttributeError(name)
        return _attribute(f"{type(self).__name__}.{name}", name)


class _Module(_Swallows, ModuleType):
    """A missing module."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.__path__ = []
        self._stand_in = name

    def __getattr__(self, name: str) -> Any:
        return _undefined if name == "__all__" else super().__getattr__(name)


def _attribute(full: str, name: str) -> Any:
    """Return what a name stands for: an exception that can be caught, or a stand-in."""
    if name[:1].isupper() and name.endswith(("Error", "Exception", "Warning")):
        return type(name, (Exception,), {})
    return StandIn(full)


def _unpacked() -> int:
    """Return how many values the code that asks for an iterator unpacks; 0 in a loop."""
    frame = sys._getframe(2)
    code, at = frame.f_code.co_code, frame.f_lasti
    is_unpacking = 0 <= at < len(code) - 1 and code[at] == dis.opmap["UNPACK_SEQUENCE"]
    return code[at + 1] if is_unpacking else 0


# --- Imports ---

used: list[str] = []
"""Modules that something stands in for, in the order of their imports."""

_undefined: list[str] = []
"""Names that a script uses and nowhere gives: what ``from module import *`` brings."""


class _Loader(importlib.abc.Loader):
    def create_module(self, spec: importlib.machinery.ModuleSpec) -> ModuleType:
        return _Module(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        pass


class StandInFinder(importlib.abc.MetaPathFinder):
    """Finds a stand-in for what a script, and not a library, imports.

    Parameters
    ----------
    home : str
        The folder of the script.
    replaced : bool
        Whether for modules of :data:`REPLACED`, wherever they are, or for those that nobody else
        has found.
    """

    def __init__(self, home: str, *, replaced: bool) -> None:
        self.home = os.path.join(os.path.realpath(home), "")
        self.replaced = replaced

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Return the specification of a stand-in, or None."""
        top = name.partition(".")[0]
        if isinstance(sys.modules.get(top), _Module) and name != top:
            return importlib.machinery.ModuleSpec(name, _Loader(), is_package=True)
        if top in LIBRARIES or name != top or (top in REPLACED) != self.replaced:
            return None
        if not self._is_asked_by_script() or os.path.exists(os.path.join(self.home, f"{top}.py")):
            return None
        used.append(top)
        return importlib.machinery.ModuleSpec(name, _Loader(), is_package=True)

    def guarded(self, imports: Callable[..., Any]) -> Callable[..., Any]:
        """Hide stand-ins from libraries: `msvcrt` would have `subprocess` take this for Windows."""

        def guarded_import(name: str, *arguments: Any, **options: Any) -> Any:
            top = name.partition(".")[0]
            is_stand_in = isinstance(sys.modules.get(top), _Module) and top not in REPLACED
            if is_stand_in and not self._is_asked_by_script():
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)
            return imports(name, *arguments, **options)

        return guarded_import

    def _is_asked_by_script(self) -> bool:
        frame: FrameType | None = sys._getframe(2)
        while frame is not None:
            file = frame.f_code.co_filename
            if "importlib" not in file and file != __file__:
                full = os.path.realpath(file)
                return full.startswith(self.home) and "site-packages" not in full
            frame = frame.f_back
        return False


# --- What else a script may want ---


class Answers:
    """Answers ``input()``, so many times, and counts how often."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self, _prompt: object = "") -> str:
        """Return an answer, whatever the question."""
        if self.count == MOST_ANSWERS:
            raise EOFError("input() was answered often enough")
        self.count += 1
        return ANSWER


def prepare(home: str) -> Answers:
    """Have imports, ``input()`` and the habits of notebooks answered in this process.

    Parameters
    ----------
    home : str
        The folder of the script.
    """
    # In front of all finders for what is replaced in any case, behind them for what is missing.
    sys.meta_path.insert(0, StandInFinder(home, replaced=True))
    missing = StandInFinder(home, replaced=False)
    sys.meta_path.append(missing)
    builtins.__import__ = missing.guarded(builtins.__import__)
    answers = Answers()
    builtins.input = answers
    notebook = {"get_ipython": lambda: StandIn("notebook"), "display": lambda *_, **__: None}
    vars(builtins).update(notebook)
    sleep = time.sleep
    time.sleep = lambda seconds: sleep(min(float(seconds), 0.01))
    return answers


def compiled(source: bytes, name: str) -> Any:
    """Return the code of a script, without the lines of a notebook that are not Python.

    Raises
    ------
    SyntaxError
        If it is not Python.
    """
    try:
        tree = ast.parse(source, name)
    except SyntaxError:
        lines = source.decode(errors="replace").split("\n")
        plain = [_plain(line) for line in lines]
        if plain == lines:
            raise
        tree = ast.parse("\n".join(plain), name)
    _undefined[:] = _free_names(tree)
    return compile(tree, name, "exec", dont_inherit=True)


def _plain(line: str) -> str:
    """Return a line without what only a notebook understands: ``%magic`` and ``!command``."""
    rest = line.lstrip()
    is_command = rest[:1] in ("%", "!", "?") or _INSTALLS.match(rest)
    return line[: len(line) - len(rest)] + "pass" if is_command else line


_INSTALLS = re.compile(r"(?:python3? -m )?(?:pip3?|conda|mamba) install\b")


def _free_names(tree: ast.AST) -> list[str]:
    """Return names that are read and never bound."""
    loads: set[str] = set()
    bound = set(dir(builtins))
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            (loads if isinstance(node.ctx, ast.Load) else bound).add(node.id)
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            bound.add(node.name)
        elif isinstance(node, ast.arg):
            bound.add(node.arg)
        elif isinstance(node, ast.alias):
            bound.add((node.asname or node.name).partition(".")[0])
        elif isinstance(node, ast.ExceptHandler) and node.name:
            bound.add(node.name)
    return sorted(loads - bound)


_OLD_NAMES = {
    "trapz": "trapezoid", "product": "prod", "cumproduct": "cumprod", "alltrue": "all",
    "sometrue": "any", "NaN": "nan", "Inf": "inf", "Infinity": "inf", "infty": "inf",
    "float_": "float64", "row_stack": "vstack", "in1d": "isin",
}  # fmt: skip
_OLD_TYPES = {"int": int, "float": float, "bool": bool, "object": object, "str": str}


def old_names(numpy: Any) -> None:
    """Give NumPy the names back that older scripts use and that it has dropped."""
    for old, new in _OLD_NAMES.items():
        if old not in vars(numpy) and hasattr(numpy, new):
            setattr(numpy, old, getattr(numpy, new))
    for old, kind in _OLD_TYPES.items():
        if old not in vars(numpy):
            setattr(numpy, old, kind)
