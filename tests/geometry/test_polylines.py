"""Places along lines, by hand."""

import numpy as np

from urbanverse_mjx.geometry.polylines import arc_lengths, points_at


def test_places_along_a_line_with_a_corner() -> None:
    line = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 10.0]])
    lengths = arc_lengths(line)
    np.testing.assert_allclose(lengths, [0.0, 5.0, 11.0])
    found = points_at(line, lengths, np.array([0.0, 2.5, 5.0, 7.0, 11.0]))
    np.testing.assert_allclose(found, [[0.0, 0.0], [1.5, 2.0], [3.0, 4.0], [3.0, 6.0], [3.0, 10.0]])
