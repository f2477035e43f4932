"""Impedance spectra: readers of impedance analyser files."""
