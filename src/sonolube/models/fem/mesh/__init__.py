"""Meshes: geometry and CAD files, tetrahedra of order two to eight, grading and refinement."""
