"""Images: named float layers, their files (EXR, PNG, NPZ), pictures made of them, one atomic write."""
