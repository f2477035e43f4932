"""Oscillating spring contacts: friction with tangential contact stiffness under harmonic oscillations of the slider."""
