"""The designer: a rule base as text and as a picture, in a browser.

The text stays the one source of truth: whatever a hand changes in the page is an edit of the
text. `server` holds the open files, `scene` says what a page draws, `written` writes a page that
needs no server; the page itself is in ``page/``.
"""
