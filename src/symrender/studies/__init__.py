"""Studies: estimators measured on one scene, each a table that states its population, its signal and its truth."""
