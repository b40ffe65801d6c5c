"""Plain task sets: read from JSON, CSV, MAST text and Cheddar XML, analysed without any model, written as MAST text."""
