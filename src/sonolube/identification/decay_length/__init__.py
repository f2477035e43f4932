"""Probabilities of what sets the decay length of a worn contact, by a run with vibration switched on and off."""
