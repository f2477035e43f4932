"""Results of other rooms as lines of text, rows of tables, and objects for JSON."""
