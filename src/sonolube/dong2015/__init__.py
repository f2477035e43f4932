"""Hardware of the dissertation by finite elements: collar element, cutter head and tribometer actuator."""
