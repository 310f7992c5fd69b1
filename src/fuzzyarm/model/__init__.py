"""What a rule base means, free of text: its data, its shapes, its formulas."""
