"""Friction models: the mean friction ratio under a given motion of the gap, one model a file."""
