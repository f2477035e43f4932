"""Impedance spectra: readers of analyser files."""
