"""Tasks that look up materials, actuators, published tables, schemas and example files."""
