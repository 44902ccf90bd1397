"""The mean of a pixel: its area cut where radiance breaks, Gauss rules between."""
