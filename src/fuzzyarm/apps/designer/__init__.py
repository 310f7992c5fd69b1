"""The designer: a rule base as text and as a picture, in a browser.

The text stays the one source of truth: whatever the user changes in the page is an edit of the
text. `server` holds the open files, `scene` is the content of a drawing; the page itself is in
``page/``.

To add to the designer
----------------------
A hand's change is an edit of the text by a pure function of :mod:`fuzzyarm.language.edit`. A
question of the page is a record in ``requests.py`` and a line in ``_QUESTIONS`` of ``shared.py``;
a handler gets sound data and raises a ``FuzzyarmError`` for what does not fit the text. Answers
are typed in ``messages.py``; ``make types`` prints both for the page. Long work is a function of
the session, a request and a ``WindowJob``, named in ``WORKS`` of ``requests.py`` and
``open_files.py``. A form is a ``Form`` of ``forms.py``: the names of request fields.

In ``page/`` a pane is a class made of the store and of a hand's actions, named in ``DESIGN`` of
``frame.js``, with a place in the grid of its view in ``style.css``; a view is an entry in ``VIEWS``
of ``app.js``; words are in ``strings.js``; arithmetic is in ``geometry/``, with a test in
``editors/designer/test``. ``make designer`` builds what is committed. In ``tests/designer``,
``test_designer_built.py``, ``test_designer_sizes.py`` and ``test_designer_accessibility.py`` find a
pane that is not built, cuts others off or has no name. Look at the page with a long and with a
hostile file (``tools/make_designer_pictures.py``).
"""

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

__all__: list[str] = []

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
