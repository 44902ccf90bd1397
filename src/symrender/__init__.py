"""symrender: the oracle for rendering."""
