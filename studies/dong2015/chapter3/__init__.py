"""Chapter 3 of the dissertation: cube model and multi-scale model."""
