"""Radiometric scenes on the numeric side: a path tracer, written from geometry."""
