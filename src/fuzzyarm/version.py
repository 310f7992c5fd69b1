"""Which fuzzyarm this is; at the bottom, since files of every kind say what made them."""

__version__ = "0.1.0"
