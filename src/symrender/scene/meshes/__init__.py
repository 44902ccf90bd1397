"""Meshes from files: OBJ and PLY as vertices and faces, and where a scene names them."""
