"""Program to text, one file per language; pure: no compiler, no device."""
