"""Chapter 3 of the dissertation, models: published against computed numbers, and figures."""
