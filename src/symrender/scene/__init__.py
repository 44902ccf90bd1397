"""Scenes: shapes, materials, lights, camera; validation, loading, parameter names, gallery."""
