"""What commands share: answers and their delivery, options, progress, and the reading of ranges and sizes."""
