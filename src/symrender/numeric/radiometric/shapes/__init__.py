"""Shapes, a file each: where a ray meets them, their normals, the coordinates of their textures, places drawn on them."""
