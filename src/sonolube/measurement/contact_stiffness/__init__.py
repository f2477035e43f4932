"""Normal contact stiffness from the shift of a resonance between free and pressed."""
