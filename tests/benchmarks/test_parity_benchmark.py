"""The parity benchmark: one tiny run of the whole, its verdicts, its complaints."""

import json
import pathlib

import pytest

from benchmarks import parity

TINY = ["--impl", "warp", "--drives", "0", "--boxes", "3", "--seconds", "1", "--json"]


@pytest.mark.extended
def test_a_tiny_run_says_what_differs_and_where(capsys: pytest.CaptureFixture[str], tmp_path: pathlib.Path) -> None:
    """C MuJoCo's part is kept first, as for a machine that cannot compile scenes."""
    assert parity.main([*TINY, "--keep", str(tmp_path)]) == 0
    assert parity.main([*TINY, "--kept", str(tmp_path)]) == 0
    result = json.loads(capsys.readouterr().out.splitlines()[-1])
    figures = result["engines"]["warp"]["boxes"]
    assert figures["drives"] == 3
    assert sum(figures["kinds"].values()) == 3
    # Float32 against C MuJoCo's float64: not equal, but near.
    assert 0.0 < figures["before_contact_max_mm"] < 1.0
    assert figures["before_contact_worst_scene"] == f"box_0_{figures['before_contact_worst_drive']}"
    assert figures["before_contact_worst_kind"] in result["largest"]["before_contact"]
    assert result["broken"] == []


@pytest.mark.extended
def test_a_broken_tolerance_is_the_exit_status(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(parity.TOLERANCES, "before_contact_max_mm", 1e-9)
    assert parity.main(TINY) == 1
    result = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert result["broken"] == ["warp boxes: before_contact_max_mm"]


def test_a_folder_without_suites_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: pathlib.Path) -> None:
    assert parity.main([*TINY, "--kept", str(tmp_path / "nothing")]) == 2
    assert "holds no kept suite" in capsys.readouterr().err


def test_the_largest_is_found_over_engines_and_suites() -> None:
    def part(before: float, after: float | None) -> dict[str, object]:
        drive = None if after is None else 4
        return {
            "before_contact_max_mm": before,
            "before_contact_worst_drive": 2,
            "before_contact_worst_scene": "alley",
            "before_contact_worst_kind": "ramp",
            "before_contact_worst_time_s": 1.25,
            "after_1s_max_mm": after,
            "after_1s_worst_drive": drive,
            "after_1s_worst_scene": "square",
            "after_1s_worst_kind": "wedge",
            "after_1s_worst_time_s": 3.0,
        }

    engines = {"warp": {"boxes": part(0.5, None)}, "jax": {"boxes": part(0.1, 2.0), "streets": part(0.2, 1.0)}}
    words = parity.largest(engines)
    assert words["before_contact"] == "0.5 mm: warp, boxes, scene alley, drive 2 (ramp), 1.25 s"
    assert words["after_1s"] == "2 mm: jax, boxes, scene square, drive 4 (wedge), 3 s"


@pytest.mark.parametrize("options", [["--drives", "-1"], ["--drives", "0", "--boxes", "0"], ["--seconds", "0"]])
def test_senseless_options_are_refused(options: list[str]) -> None:
    with pytest.raises(SystemExit):
        parity.parse(options)
