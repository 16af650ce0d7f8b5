"""What a reader gives of a file, for the tests of readers."""

from fuzzytrack.io.formats import open_table


def read(file, format=None, rows=None):
    """Columns of a file as lists, the description, and the notes after the last row."""
    with open_table(str(file), format=format) as source:
        kinds = {name: "gaps" if t == "number" else "text" for name, t in source.types.items()}
        columns = {name: [] for name in kinds}
        for table in source.tables(kinds, rows):
            assert len(table.rows) <= (rows or 10**9)
            for name, values in {**table.numbers, **table.cells}.items():
                columns[name] += list(values)
        assert all(note.startswith(f"{file}: ") for note in source.notes)
        notes = [note.removeprefix(f"{file}: ") for note in source.notes]
        return columns, source.description, notes
