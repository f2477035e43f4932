"""Contact laws for dynamics: normal contact force against displacement, one law per file."""
