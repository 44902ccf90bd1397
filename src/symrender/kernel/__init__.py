"""The target-neutral program between an expression and the text of a kernel."""
