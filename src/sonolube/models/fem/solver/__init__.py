"""Finite-element method of linear piezoelectricity: meshes, matrices, factorisation, natural modes and response."""
