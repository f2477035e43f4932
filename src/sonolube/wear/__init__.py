"""Wear: Archard's law, the cube model under vibration, and wear mechanisms by material pair."""
