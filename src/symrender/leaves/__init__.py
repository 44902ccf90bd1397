"""What formulas are lowered to: texts made by ``targets/leaf_files.py``, and the guarded functions they call."""
