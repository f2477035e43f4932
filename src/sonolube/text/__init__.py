"""Text: units and numbers with them, TOML, wrapping, and text of users made printable."""
