"""Recordings over time: readers of data-acquisition files."""
