"""From the syntax tree, or from a RuleBase, to canonical text."""
