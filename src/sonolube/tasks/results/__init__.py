"""What answers of several tasks share: records of a rig, what was measured on it, its texts, tables by status."""
