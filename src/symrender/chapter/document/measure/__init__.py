"""What the chapter measures when it is built, a subject a file."""
