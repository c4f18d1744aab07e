"""Names of cached arrays; damage to files is tested in test_damaged_banks.py."""

import numpy as np

from urbanverse_mjx.datatypes import array_file


def test_keys_of_cached_files_depend_on_all_that_is_told() -> None:
    array = np.arange(12, dtype=np.int32).reshape(3, 4)
    key = array_file.key_of((1, "a"), {"x": array})
    assert key == array_file.key_of((1, "a"), {"x": np.asfortranarray(array)})
    assert len(key) == 24
    others = [
        array_file.key_of((2, "a"), {"x": array}),
        array_file.key_of((1, "a"), {"y": array}),
        array_file.key_of((1, "a"), {"x": array.reshape(4, 3)}),
        array_file.key_of((1, "a"), {"x": array.view(np.float32)}),
        array_file.key_of((1, "a"), {"x": array + np.int32(1)}),
        array_file.key_of((1, "a"), {"x": array, "y": array}),
    ]
    assert len({key, *others}) == 1 + len(others)
