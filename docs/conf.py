"""The pages as a site: `make docs` builds it into `build/docs`, without a network.

Pages are Markdown (MyST). What `tools/make_reference.py` knows from the program itself, the Python
API above all, is written before they are read.
"""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tools"), str(HERE.parent / "src")]

import make_reference  # noqa: E402
from docutils import nodes  # noqa: E402
from highlighting import LutLexer, RuleBaseLexer  # noqa: E402
from PIL import Image  # noqa: E402
from sphinx.application import Sphinx  # noqa: E402

from fuzzyarm.version import __version__  # noqa: E402

project = "fuzzyarm"
author = "The fuzzyarm developers"
project_copyright = author
version = release = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc", "sphinx_copybutton"]
smartquotes = False  # a command in a sentence can be copied
exclude_patterns = ["pictures"]
# A type in a signature is found in the package that shows it and in the module that has it.
suppress_warnings = ["ref.python"]

# Links between pages: files of the repository, with anchors of headings as on a code forge.
myst_heading_anchors = 4
myst_enable_extensions = ["attrs_inline"]

autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
autodoc_class_signature = "mixed"
python_use_unqualified_type_names = True
numpydoc_show_class_members = False
numpydoc_xref_param_type = False
maximum_signature_line_length = 80

# What is copied is what is typed: prompts stay, and so does what the program answers.
copybutton_prompt_text = r"\$ |>>> |\.\.\. "
copybutton_prompt_is_regexp = True
copybutton_only_copy_prompt_lines = True
copybutton_line_continuation_character = "\\"

html_theme = "furo"
html_title = f"fuzzyarm {version}"
html_show_sourcelink = False
html_copy_source = False
html_static_path = ["_site"]
html_css_files = ["site.css"]
pygments_style = "friendly"
pygments_dark_style = "monokai"


def setup(app: Sphinx) -> None:
    """Write the pages of the Python API; teach Sphinx the languages of rule bases and tables."""
    make_reference.write_api_pages(HERE / "api")
    app.connect("autodoc-skip-member", _skip)
    app.connect("doctree-read", _sized)
    app.connect("autodoc-process-docstring", _without_table)
    app.add_lexer("frb", RuleBaseLexer)
    app.add_lexer("lut", LutLexer)


def _sized(app: Sphinx, doctree: nodes.document) -> None:
    """Say how large each picture is: the page keeps its place, and one that is shrunk is a link."""
    for picture in doctree.findall(nodes.image):
        path = Path(app.srcdir, picture["uri"])
        if path.suffix in (".png", ".gif", ".webp"):
            with Image.open(path) as opened:
                wide, high = opened.size
            picture["width"], picture["height"] = f"{wide}px", f"{high}px"
        if path.suffix == ".svg":
            picture["width"] = "100%"


def _skip(app: Sphinx, what: str, name: str, *others: object) -> bool | None:
    """Leave out what scikit-learn adds to every estimator."""
    return True if name.startswith("set_") and name.endswith("_request") else None


def _without_table(
    app: Sphinx, what: str, name: str, subject: object, options: object, lines: list[str]
) -> None:
    """Leave out the table of names, which is laid out for ``help(fuzzyarm)``: they follow here."""
    if name == "fuzzyarm":
        del lines[1:]
