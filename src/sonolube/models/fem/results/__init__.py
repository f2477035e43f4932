"""Results of finite elements: modes of a part, spectra, fields at points, figures and files."""
