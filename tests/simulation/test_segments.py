"""Tables in which pieces come and go: segments do not overlap, and pieces stay as they are while others change."""

import numpy as np
import pytest
import warp as wp

from urbanverse_mjx.simulation.segments import Segments, SegmentTables, put_row


def test_segments_never_overlap_and_gaps_are_used_again() -> None:
    rng, segments = np.random.default_rng(0), Segments()
    held: dict[int, int] = {}
    most = 0
    for _ in range(500):
        if held and rng.random() < 0.5:
            first = int(rng.choice(list(held)))
            segments.give_back(first)
            del held[first]
        number = int(rng.integers(1, 40))
        first = segments.take(number)
        assert first not in held
        held[first] = number
        owner = np.zeros(segments.size, int)
        for begin, length in held.items():
            owner[begin : begin + length] += 1
        assert owner.max() == 1
        assert owner.sum() == sum(held.values()), "all lie within the table"
        most = max(most, sum(held.values()))
    # What is in use at most, a gap here and there, and a tenth to spare; all that was taken is twice as much.
    assert most <= segments.size < 1.25 * most
    assert Segments().take(0) == 0


def test_a_gap_of_the_right_length_is_taken_before_the_end() -> None:
    segments = Segments()
    first = [segments.take(n) for n in (4, 6, 5)]
    assert first == [0, 4, 10]
    segments.give_back(4)
    assert segments.take(7) == 15
    assert segments.take(6) == 4


def test_pieces_stay_while_tables_grow_and_others_change() -> None:
    rng = np.random.default_rng(1)
    with wp.ScopedDevice("cpu"):
        tables = SegmentTables({"rows": (wp.vec4, 2), "bytes": (wp.uint8, 3)})
        held: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        for turn in range(40):
            if len(held) == 4:
                oldest = next(iter(held))
                tables.segments.give_back(oldest)
                del held[oldest]
            number = int(rng.integers(1, 60))
            rows, values = (
                rng.normal(size=(number, 2, 4)).astype(np.float32),
                rng.integers(0, 255, (number, 3), np.uint8),
            )
            first = tables.take(number)
            for name, array in (("rows", rows), ("bytes", values)):
                assert len(list(tables.write(name, first, array))) == 1
            held[first] = rows, values
            for begin, (floats, small) in held.items():
                end = begin + len(floats)
                found = tables.tables["rows"].numpy().reshape(-1, 2, 4)[begin:end]
                np.testing.assert_array_equal(found, floats, err_msg=str(turn))
                np.testing.assert_array_equal(tables.tables["bytes"].numpy().reshape(-1, 3)[begin:end], small)
        assert tables.num_bytes == sum(table.capacity for table in tables.tables.values())


def test_large_pieces_are_copied_in_parts() -> None:
    with wp.ScopedDevice("cpu"):
        tables = SegmentTables({"rows": (wp.vec4, 1)})
        values = np.arange(4 * (1 << 19), dtype=np.float32).reshape(-1, 4)  # 8 MiB
        first = tables.take(len(values))
        assert len(list(tables.write("rows", first, values))) == 2
        np.testing.assert_array_equal(tables.tables["rows"].numpy()[first : first + len(values)], values)


@pytest.mark.parametrize("kind", [wp.float32, wp.vec3, wp.mat33])
def test_a_row_of_an_array_is_replaced_alone(kind: type) -> None:
    shape = tuple(getattr(kind, "_shape_", ()))
    table = wp.zeros((3, 5), dtype=kind, device="cpu")
    row = np.random.default_rng(2).normal(size=(5, *shape)).astype(np.float32)
    put_row(table, 1, row)
    np.testing.assert_array_equal(table.numpy()[1], row)
    assert not table.numpy()[[0, 2]].any()
