"""Prediction tasks: operating points, transients, intervals of a rig."""
