"""Commands that design: sweeps, maps, optimisation, uncertainty, control, efficiency and horns."""
