"""Small scenes, one mechanism of light each, with their truths: what another renderer is tested against."""
