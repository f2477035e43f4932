"""Statistics of measurements: correlated samples, few repeated tests, and fits of log-parameters."""
