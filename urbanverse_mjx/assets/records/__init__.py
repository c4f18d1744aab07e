"""All records: the index of base shapes, the catalogue made of it, and the assets of the user."""
