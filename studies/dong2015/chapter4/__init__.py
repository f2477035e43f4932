"""Chapter 4 of the dissertation: applications."""
