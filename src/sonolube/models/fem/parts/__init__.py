"""Parametric bodies and transducers: horns, rings, bolted piezoelectric stacks and single poled parts."""
