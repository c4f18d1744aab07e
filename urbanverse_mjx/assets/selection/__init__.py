"""Which asset fits: by label, box and look, over all collections."""
