"""Time marching of batches of trajectories by an exponential integrator with a constant step."""
