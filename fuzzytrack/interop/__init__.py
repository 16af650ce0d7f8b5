"""Exchange with other software: its formats, its source code and its classes.

Nothing is imported here: each module or folder stands alone, and what it needs beyond the package
is an extra of its own.
"""
