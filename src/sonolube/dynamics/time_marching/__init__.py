"""Time marching: trajectories of a structure with one nonlinear contact, by an exponential integrator."""
