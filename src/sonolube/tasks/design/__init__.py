"""Tasks that design: sweeps, maps, plans, optimisation, control and horns."""
