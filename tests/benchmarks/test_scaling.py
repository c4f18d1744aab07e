"""Power laws of synthetic rows have the exponents that made them; the page names the rows that are not there."""

import itertools
import json
import pathlib

import numpy as np
import pytest

from benchmarks import results, scaling
from urbanverse_mjx.scene import library

HEAD = "study,size,seed,env_steps,scenes,subset,set,scene,SR"
SCENES = [f"s{k:02d}" for k in range(12)]


def _point(rates: np.ndarray) -> dict[tuple[str, str], float]:
    """(seeds, scenes) success -> by (seed, scene)."""
    return {(str(i), SCENES[k]): float(x) for i, row in enumerate(rates) for k, x in enumerate(row)}


def _law(a: float, b: float, seeds: int = 3) -> dict[int, dict[tuple[str, str], float]]:
    """Failures a n^-b on average, with scenes of different difficulty."""
    harder = np.linspace(0.2, 1.8, len(SCENES))
    return {n: _point(100.0 - np.tile(a * n**-b * harder, (seeds, 1))) for n in (1, 8, 16, 32)}


def test_a_power_law_is_found_again() -> None:
    sizes = np.array([1.0, 8.0, 16.0, 32.0])
    for a, b in ((50.0, 0.4), (30.0, 1.2), (40.0, 0.0), (20.0, -0.3)):
        assert scaling.power_law(sizes, a * sizes**-b) == pytest.approx((a, b), abs=1e-4)


def test_the_fit_is_that_of_least_squares_in_percent() -> None:
    from scipy.optimize import curve_fit

    sizes, failures = np.array([5.0, 40.0, 80.0, 160.0]), np.array([61.0, 22.0, 24.0, 11.0])
    wanted, _ = curve_fit(lambda n, a, b: a * n**-b, sizes, failures, (60.0, 0.5))
    assert scaling.power_law(sizes, failures) == pytest.approx(wanted, rel=1e-3)


def test_scenes_of_one_law_leave_no_doubt_of_the_exponent_and_seeds_do() -> None:
    sure = scaling.fit(_law(50.0, 0.4))
    assert sure is not None
    # Every scene follows the same exponent, so drawing other scenes changes the factor alone.
    assert (sure.a, sure.b, sure.low, sure.high, sure.r2) == pytest.approx((50.0, 0.4, 0.4, 0.4, 1.0), abs=1e-3)
    exponents = np.array([0.3, 0.4, 0.5])
    apart = scaling.fit(
        {n: _point(100.0 - np.tile(50.0 * n**-exponents, (12, 1)).T) for n in (1, 8, 16, 32)},
    )
    assert apart is not None
    # The standard error of a mean of three seeds, times 2 x 1.96, and never beyond the seeds themselves.
    assert apart.high - apart.low == pytest.approx(3.92 * exponents.std() / np.sqrt(3), rel=0.25)
    assert 0.3 - 1e-3 <= apart.low < apart.b < apart.high <= 0.5 + 1e-3


def test_a_fit_needs_three_sizes_a_common_seed_and_failures() -> None:
    law = _law(50.0, 0.4)
    two = {n: law[n] for n in (1, 8)}
    assert scaling.fit(two) is None
    assert scaling.fit({}) is None
    assert scaling.fit(dict.fromkeys((1, 8, 16), _point(np.full((3, 12), 100.0)))) is None
    # A point without seed 2 takes that seed out of all others; one with another seed alone takes all out.
    fewer = law | {8: {key: x for key, x in law[8].items() if key[0] != "2"}}
    found = scaling.fit(fewer)
    assert found is not None
    assert found.seeds == 2
    assert scaling.fit(law | {8: {("7", scene): 50.0 for scene in SCENES}}) is None


@pytest.mark.parametrize("study", scaling.VARIED)
def test_subsets_are_nested_and_differ_by_seed(study: str) -> None:
    sizes, each = scaling.SIZES[study], {"layouts": 5, "cousins": 32, "streets": 1}[study]
    chains = [[set(scaling.subset(study, n, seed)) for n in sizes] for seed in scaling.SEEDS]
    for chain in chains:
        assert [len(x) for x in chain] == [n * each for n in sizes]
        assert all(a < b for a, b in itertools.pairwise(chain))
        assert chain[-1] <= set(library.shipped_hashes(scaling.SETS[study]))
    assert len({frozenset(chain[1]) for chain in chains}) == 3
    if study == "layouts":
        assert all(len({name.rsplit("_Cousin_", 1)[0] for name in chain[1]}) == 8 for chain in chains)
    if study == "cousins":
        assert all(len({name.rsplit("_Cousin_", 1)[0] for name in chain[0]}) == 32 for chain in chains)


def test_both_learners_train_on_the_same_scenes() -> None:
    for study, sizes in scaling.VARIED.items():
        assert scaling.SIZES[f"teacher-{study}"] == sizes
        assert scaling.subset(f"teacher-{study}", sizes[1], 2) == scaling.subset(study, sizes[1], 2)


def test_subsets_stay_those_of_committed_rows() -> None:
    assert scaling.digest(scaling.subset("layouts", 8, 0)) == "7cf15c0f7e3a"
    assert scaling.digest(scaling.subset("cousins", 2, 1)) == "0a481be93433"
    assert scaling.digest(scaling.subset("streets", 40, 2)) == "46df0caf335c"


def _result(folder: pathlib.Path, trained_on: list[str], rates: dict[str, float], agent: str = "fast") -> pathlib.Path:
    sets = {name: {"by_scene": {scene: {"SR": rate} for scene in SCENES}} for name, rate in rates.items()}
    path = folder / "result.json"
    path.write_text(json.dumps({"steps": 6_029_312, "trained_on": trained_on, agent: sets}))
    return path


def test_a_result_of_other_scenes_is_refused(tmp_path: pathlib.Path) -> None:
    (tmp_path / "scaling.csv").write_text(HEAD + "\n")
    path = _result(tmp_path, scaling.subset("layouts", 8, 1), {"craftbench": 50.0})
    with pytest.raises(SystemExit, match="found a training on 40 scenes that are not those of layouts, 8, seed 0"):
        scaling.add(tmp_path, path, "layouts", 8, 0)
    assert (tmp_path / "scaling.csv").read_text() == HEAD + "\n"


def test_the_page_says_what_is_there_and_what_is_absent(tmp_path: pathlib.Path) -> None:
    (tmp_path / "scaling.csv").write_text(HEAD + "\n")
    said = scaling.text(scaling.read(tmp_path))
    assert said.startswith("Not run yet: `scaling-layouts-*`, `scaling-cousins-*`, `scaling-streets-*`, ")
    assert (
        "`scaling-teacher-layouts-*`, `scaling-teacher-cousins-*`, `scaling-teacher-streets-*`, `horizon-*`; " in said
    )
    assert "|" not in said
    scaling.draw(scaling.read(tmp_path), tmp_path / "figure.png")
    assert not (tmp_path / "figure.png").exists()

    for n in (1, 8, 16):
        for seed in scaling.SEEDS:
            if (n, seed) == (16, 2):
                continue
            path = _result(tmp_path, scaling.subset("layouts", n, seed), {"craftbench": 100.0 - 60.0 * n**-0.5})
            scaling.add(tmp_path, path, "layouts", n, seed)
    rows = scaling.read(tmp_path)
    said = scaling.text(rows)
    assert "| layouts, 5 cousins each | PPO from images | 1 | 3 | 40.0 [40.0, 40.0] |" in said
    assert "| layouts, 5 cousins each | PPO from images | 16 | 2 | 85.0 [85.0, 85.0] |" in said
    assert "| a n^-b, layouts, 5 cousins each | PPO from images | 60.0 | 0.500 [0.500, 0.500] | 1.00 | 2 |" in said
    assert "Not run yet: `scaling-layouts-16-2`, `scaling-layouts-32-*`, `scaling-cousins-*`" in said
    scaling.draw(rows, tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 5_000
    scaling.draw({}, tmp_path / "figure.png")
    assert not (tmp_path / "figure.png").exists()


def test_a_teacher_has_rows_of_benchmarks_beside_those_of_ppo(tmp_path: pathlib.Path) -> None:
    (tmp_path / "scaling.csv").write_text(HEAD + "\n")
    for prefix, agent, rate in (("", "fast", 40.0), ("teacher-", "teacher", 90.0)):
        rates = {"craftbench": rate, "validation_composed": 1.0}
        path = _result(tmp_path, scaling.subset("streets", 5, 0), rates, agent)
        scaling.add(tmp_path, path, f"{prefix}streets", 5, 0)
    with pytest.raises(SystemExit, match="teacher"):  # what PPO learnt is no row of the teacher
        scaling.add(tmp_path, _result(tmp_path, ["a"], {"craftbench": 1.0}), "teacher-streets", 5, 0)
    rows = scaling.read(tmp_path)
    assert set(rows["teacher-streets", 5]) == {"craftbench"}
    said = scaling.text(rows)
    assert "| procedural streets | PPO from images | 5 | 1 | 40.0 [40.0, 40.0] |" in said
    assert "| procedural streets | privileged teacher | 5 | 1 | 90.0 [90.0, 90.0] |" in said
    assert "`scaling-teacher-streets-5-1`, `scaling-teacher-streets-5-2`, `scaling-teacher-streets-40-*`" in said
    scaling.draw(rows, tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 5_000


def test_the_horizon_compares_both_trainings_on_both_tests(tmp_path: pathlib.Path) -> None:
    (tmp_path / "scaling.csv").write_text(HEAD + "\n")
    for n, rates in ((100, (30.0, 20.0)), (200, (44.0, 41.0))):
        for seed in scaling.SEEDS:
            path = _result(tmp_path, ["a"], dict(zip(scaling.TESTED, rates, strict=True)))
            scaling.add(tmp_path, path, "horizon", n, seed)
    said = scaling.text(scaling.read(tmp_path))
    assert "| halves (100 m) | 3 | 30.0 [30.0, 30.0] | 20.0 [20.0, 20.0] |" in said
    assert "| whole scenes (200 m) | 3 | 44.0 [44.0, 44.0] | 41.0 [41.0, 41.0] |" in said
    assert "| whole scenes - halves | | 14.0 [14.0, 14.0] | 21.0 [21.0, 21.0] |" in said
    assert "`horizon" not in said


def test_the_page_holds_the_tables_of_the_rows() -> None:
    page = results.PAGE.read_text(encoding="utf-8")
    assert results.with_table(page, scaling.text(scaling.read(results.SCORES)), scaling.MARKS) == page, (
        "run make results"
    )
