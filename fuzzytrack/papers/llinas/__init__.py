"""Llinas, Singh, Chen & Tenne (1998): a fuzzy α-β tracker beside four others in a sensor field."""
