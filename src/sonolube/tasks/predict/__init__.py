"""Tasks that predict what a rig or a part does."""
