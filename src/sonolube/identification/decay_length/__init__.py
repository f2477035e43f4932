"""What sets the decay length of a worn contact: hypotheses weighed by a run with vibration switched on and off."""
