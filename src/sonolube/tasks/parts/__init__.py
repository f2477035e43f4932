"""Task of a part by finite elements, and parts by name or STEP file."""
