"""Execution: an image as units of work, run on threads or machines, kept in a journal, watched while it grows."""
