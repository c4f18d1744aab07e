"""Asset records: the index of base shapes, the catalogue made from it, and the user's assets."""
