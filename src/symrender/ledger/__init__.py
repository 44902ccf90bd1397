"""Ledger: two images compared, in numbers and pictures, with the population behind every number."""
