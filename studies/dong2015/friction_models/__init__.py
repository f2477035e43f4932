"""Friction models against the published friction reductions: variants, mechanisms and computed motions."""
