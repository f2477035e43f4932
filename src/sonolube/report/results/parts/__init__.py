"""Results of parts as text and JSON: natural modes, impedance spectra, horns."""
