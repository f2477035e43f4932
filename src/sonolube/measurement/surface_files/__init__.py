"""Surface topography files: readers of profilometer formats."""
