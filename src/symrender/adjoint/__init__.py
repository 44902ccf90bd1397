"""The lobe integral in reverse: the pieces of a value, replayed with their slopes and contracted with what moves."""
