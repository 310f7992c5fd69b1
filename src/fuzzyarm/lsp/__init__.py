"""The language server: what :mod:`fuzzyarm.rulebase.queries` answers, over the protocol.

Needs the extra ``fuzzyarm[lsp]``. :mod:`fuzzyarm.lsp.session` and
:mod:`fuzzyarm.lsp.positions` know nothing of the protocol's library.
"""
