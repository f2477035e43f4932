"""Chapter 2 of the dissertation, experiments: published against computed numbers, and figures."""
