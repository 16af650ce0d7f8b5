"""A generic discrete fuzzy engine, with nothing about tracking in it."""
