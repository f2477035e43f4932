"""Horns: shapes, tuning by finite elements, profile, drawing and figure."""
