"""From the syntax tree to the RuleBase: names resolved, numbers judged."""
