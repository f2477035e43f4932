"""Tasks that compare models with published tests, own runs, earlier studies and the dissertation."""
