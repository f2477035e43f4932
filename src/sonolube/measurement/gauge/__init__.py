"""Force gauges: calibration of a displacement sensor with hysteresis, by polynomial branches or Preisach's model."""
