"""Friction models against the dissertation's friction tables: rows and figures."""
