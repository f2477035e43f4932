"""Command that looks up the state of the installation."""
