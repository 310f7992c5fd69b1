"""The language server: what :mod:`fuzzyarm.language.queries` answers, over the protocol.

Needs the extra ``fuzzyarm[lsp]``. :mod:`fuzzyarm.lsp.session` and
:mod:`fuzzyarm.lsp.tables` know nothing of the protocol's library.
"""
