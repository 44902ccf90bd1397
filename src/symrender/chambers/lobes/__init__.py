"""What is true of a kind of lobe only: one record, and named functions over it (``docs/adding-a-bsdf.md``)."""
