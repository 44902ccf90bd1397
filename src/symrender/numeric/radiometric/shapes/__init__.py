"""Shapes, a file each: where rays meet them, normals, coordinates of textures, and places on them by chance."""
