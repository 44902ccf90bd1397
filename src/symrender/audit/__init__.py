"""Images of other renderers judged: is this render what its scene says, and if not, what is it?"""
