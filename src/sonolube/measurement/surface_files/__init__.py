"""Surface files: readers of profilometer formats as height maps in metres."""
