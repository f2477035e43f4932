"""Force gauges: calibration with hysteresis."""
