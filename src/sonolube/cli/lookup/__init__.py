"""Commands that look up materials, actuators, published tables and the schema of rig files."""
