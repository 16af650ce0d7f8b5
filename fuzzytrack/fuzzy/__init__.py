"""A generic discrete fuzzy engine; it knows nothing of tracking."""
