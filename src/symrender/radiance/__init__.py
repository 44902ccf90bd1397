"""Who computes what of an image: providers of radiance, and the choice between them."""
