"""Measurement: what instruments wrote, read into labelled records, and what it says of friction, wear and vibration."""
