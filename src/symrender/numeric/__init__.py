"""The conventional ray tracer, written from geometry: the independent opinion beside the symbolic pipeline."""
