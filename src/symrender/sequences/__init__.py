"""Many images of one scene: sweeps over its numbers and camera paths, frame by frame."""
