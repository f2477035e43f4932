"""Rig files: sections and keys, reading, JSON schema and stated uncertainty."""
