"""Facts: materials, the published data, measures used in experiments, and test protocols."""
