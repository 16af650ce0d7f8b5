"""The page in the browser, without the web: texts, edits, files and surfaces of a session."""
