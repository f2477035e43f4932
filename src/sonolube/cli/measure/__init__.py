"""Commands that measure recordings, surfaces and spectra."""
