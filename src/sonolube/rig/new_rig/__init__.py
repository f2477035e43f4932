"""A first rig file from what is known before a test: surfaces, pin, vibration, and the text of the file."""
