"""Chapter 4 of the dissertation, applications: published against computed numbers, and figures."""
