"""Friction laws: Coulomb, Dahl and LuGre along a given motion, under periodic vibration, and before a spring drive."""
