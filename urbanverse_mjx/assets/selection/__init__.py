"""Which asset fits: by label, box and appearance, over all collections."""
