"""Storage: files that appear whole or not at all, files that grow, inputs read once, and interruptions."""
