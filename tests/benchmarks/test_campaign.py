"""A campaign runs jobs in the order of their files, as many on a GPU as its memory holds, and continues."""

import argparse
import dataclasses
import json
import pathlib
import sys
import time
import types

import pytest

from benchmarks import campaign, embodiment, gaits, generalise, scaling, tasks
from benchmarks.campaign import Campaign, Job
from benchmarks.lib.options import parsed_options
from benchmarks.lib.unseen import named_scenes
from urbanverse_mjx.envs import registry
from urbanverse_mjx.training.config import default_ppo_config


def _args(tmp_path: pathlib.Path, *more: str) -> argparse.Namespace:
    argv, sys.argv = sys.argv, ["campaign", "--out", str(tmp_path / "out"), *more]
    try:
        args = campaign.arguments()
    finally:
        sys.argv = argv
    args.out.mkdir(exist_ok=True)
    return args


#: Notes its begin and end in a log, and writes its result.
CODE = """
import pathlib, sys, time
name, log, result, seconds = sys.argv[1:]
with open(log, "a") as f: f.write(f"begin {name}\\n")
time.sleep(float(seconds))
with open(log, "a") as f: f.write(f"end {name}\\n")
pathlib.Path(result).touch()
"""


def _job(tmp_path: pathlib.Path, name: str, memory: int, *needs: str, seconds: float = 0.1, code: str = CODE) -> Job:
    result = tmp_path / name
    words = ("-c", code, name, str(tmp_path / "log"), str(result), str(seconds))
    return Job(name, words, tuple(tmp_path / need for need in needs), result, memory)


def _events(tmp_path: pathlib.Path) -> list[str]:
    return (tmp_path / "log").read_text().splitlines()


def test_a_job_waits_for_its_files_and_for_memory(tmp_path: pathlib.Path) -> None:
    jobs = [
        _job(tmp_path, "student", 30, "teacher"),
        _job(tmp_path, "teacher", 50, "bank", seconds=1.5),
        _job(tmp_path, "other", 40, "bank"),
        _job(tmp_path, "bank", 0),
    ]
    assert Campaign(_args(tmp_path, "--gpu-memory", "80"), jobs).run() == 0
    events = _events(tmp_path)
    assert events.index("end bank") < events.index("begin teacher")
    assert events.index("end teacher") < events.index("begin other")  # 50 + 40 GiB do not fit
    assert events.index("end teacher") < events.index("begin student")


def test_a_file_of_a_running_job_does_not_count_yet(tmp_path: pathlib.Path) -> None:
    early = CODE.replace("time.sleep", "pathlib.Path(result).touch(); time.sleep")
    jobs = [_job(tmp_path, "student", 0, "teacher"), _job(tmp_path, "teacher", 0, seconds=2.5, code=early)]
    assert Campaign(_args(tmp_path), jobs).run() == 0
    assert _events(tmp_path) == ["begin teacher", "end teacher", "begin student", "end student"]


def _student(tmp_path: pathlib.Path, seconds: float) -> Job:
    """A job that runs for so long beside its teacher."""
    return dataclasses.replace(_job(tmp_path, "student", 30, seconds=seconds), awaits=tmp_path / "teacher")


def test_a_student_begins_beside_its_teacher(tmp_path: pathlib.Path) -> None:
    jobs = [_student(tmp_path, 0.1), _job(tmp_path, "teacher", 50, "bank", seconds=4.0), _job(tmp_path, "bank", 0)]
    assert Campaign(_args(tmp_path), jobs).run() == 0
    events = _events(tmp_path)
    assert events.index("begin student") < events.index("end teacher")
    assert events.index("end bank") < events.index("begin student")


def test_a_student_ends_when_its_teacher_fails(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = "import time; time.sleep(2.5); raise SystemExit(3)"
    jobs = [_job(tmp_path, "teacher", 0, code=code), _student(tmp_path, 60.0)]
    begin = time.monotonic()
    assert Campaign(_args(tmp_path), jobs).run() == 1
    assert time.monotonic() - begin < 30.0
    said = capsys.readouterr().err
    assert "FAILED teacher with status 3" in said
    assert "FAILED student with status -15" in said


def test_rows_begin_in_the_order_of_their_patterns(tmp_path: pathlib.Path) -> None:
    rows = ("student-arm-memory-1", "teacher-arm-base-*", "student-arm-*")
    jobs = campaign.chosen(_args(tmp_path, "--seeds", "1", "2", "--rows", *rows))
    names = [job.name for job in jobs if job.rows]
    assert names[:4] == ["student-arm-memory-1", "teacher-arm-base-1", "teacher-arm-base-2", "student-arm-base-1"]
    assert names.count("student-arm-memory-1") == 1
    students = [job for job in jobs if job.name.startswith("student")]
    assert {job.awaits for job in students} == {tmp_path / "out" / "teacher-arm-base-1" / "result.json"}


def test_a_training_that_ends_while_it_scores_is_not_done(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Training:
        imitation, steps = types.SimpleNamespace(student=None), 9

        def __init__(self, *given: object) -> None:
            pass

        def run(self) -> dict[str, dict[str, float]]:
            return {"student": {}, "finetuned": {}}

    scored: list[str] = []

    def score(env: object, name: str, agent: object) -> dict[str, object]:
        scored.append(name)
        if len(scored) == 2:
            raise KeyboardInterrupt
        return {"craftbench": {"summary": {"SR": {"mean": 50.0}}, "ends": {}, "by_scene": {}}}

    monkeypatch.setattr(generalise, "begin", generalise.Log)
    suite = types.SimpleNamespace(score=score, check=lambda env: None)
    monkeypatch.setattr(generalise, "load", lambda *given: (None, ["s"], suite))
    monkeypatch.setattr(generalise.registry, "load", lambda *given, **named: None)
    monkeypatch.setattr(generalise, "StudentTraining", Training)
    monkeypatch.setattr(sys, "argv", ["generalise", "student", "--train", "bank.npz", "--out", str(tmp_path)])
    with pytest.raises(KeyboardInterrupt):
        generalise.main()
    assert scored == ["finetuned", "student"]
    assert not (tmp_path / "result.json").exists()
    assert generalise.main() == 0
    assert set(json.loads((tmp_path / "result.json").read_text())) == {
        "steps", "trained_on", "student", "finetuned"
    }  # fmt: skip


def test_named_scenes_are_those_to_train_on() -> None:
    assert named_scenes(None, ["a", "b"]) == ["a", "b"]
    assert named_scenes(["b"], ["a", "b"]) == ["b"]
    with pytest.raises(SystemExit, match="--scenes: found 'c', needed ids of scenes in the banks to train on"):
        named_scenes(["b", "c"], ["a", "b"])


def test_two_gpus_take_jobs_at_the_same_time(tmp_path: pathlib.Path) -> None:
    jobs = [_job(tmp_path, name, 50, seconds=2.5) for name in ("a", "b")]
    assert Campaign(_args(tmp_path, "--gpus", "2"), jobs).run() == 0
    assert {event.split()[0] for event in _events(tmp_path)[:2]} == {"begin"}


def test_a_job_of_two_gpus_waits_until_both_are_free(
    tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = CODE.replace('f"begin {name}', "f\"begin {name} {os.environ['CUDA_VISIBLE_DEVICES']}")
    code = "import os\n" + code
    jobs = [
        _job(tmp_path, "one", 1, seconds=1.5, code=code),
        dataclasses.replace(_job(tmp_path, "both", 80, seconds=1.5, code=code), gpus=2),
        _job(tmp_path, "alone", 80, seconds=1.5, code=code),
        _job(tmp_path, "last", 1, code=code),
    ]
    assert Campaign(_args(tmp_path, "--gpus", "2"), jobs).run() == 0
    events = _events(tmp_path)
    # The two begin beside each other, because a GPU is free; the rest follows as memory allows.
    at = {event: k for k, event in enumerate(events)}
    assert {"begin one 0", "begin alone 1", "begin both 0,1"} < set(events)
    assert at["begin both 0,1"] > max(at["end one"], at["end alone"])
    assert [e for e in events[at["begin both 0,1"] : at["end both"]] if e.startswith("begin")] == ["begin both 0,1"]
    # A machine with one GPU never has two.
    (tmp_path / "both").unlink()
    assert Campaign(_args(tmp_path), jobs).run() == 1
    assert "not begun: both, for want of 2 GPUs" in capsys.readouterr().err


def test_a_campaign_uses_the_gpus_that_the_environment_names(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = CODE.replace('f"begin {name}', "f\"begin {name} {os.environ['CUDA_VISIBLE_DEVICES']}")
    code = "import os\n" + code
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "3,GPU-5d")
    jobs = [_job(tmp_path, name, 50, seconds=2.5, code=code) for name in ("a", "b")]
    assert Campaign(_args(tmp_path, "--gpus", "2"), jobs).run() == 0
    assert set(_events(tmp_path)[:2]) == {"begin a 3", "begin b GPU-5d"}
    with pytest.raises(SystemExit, match="--gpus: found 3, and 3,GPU-5d in CUDA_VISIBLE_DEVICES, needed at most 2"):
        Campaign(_args(tmp_path, "--gpus", "3"), jobs)


def test_a_campaign_continues_and_names_what_failed(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    jobs = [_job(tmp_path, "a", 0), _job(tmp_path, "b", 0, code="raise SystemExit(3)"), _job(tmp_path, "c", 0, "b")]
    args = _args(tmp_path)
    assert Campaign(args, jobs).run() == 1
    said = capsys.readouterr().err
    assert "FAILED b with status 3" in said
    assert f"not begun: c, for want of {tmp_path / 'b'}" in said
    assert Campaign(args, [*jobs[:1], _job(tmp_path, "b", 0), jobs[2]]).run() == 0
    assert _events(tmp_path).count("begin a") == 1


def test_no_job_begins_after_the_time(tmp_path: pathlib.Path) -> None:
    args = _args(tmp_path, "--until", "0")
    time.sleep(0.01)
    assert Campaign(args, [_job(tmp_path, "a", 0)]).run() == 1
    assert not (tmp_path / "a").exists()


def test_an_interrupted_campaign_ends_its_jobs(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = Campaign(_args(tmp_path), [_job(tmp_path, "a", 0, seconds=60.0)])
    looks = 0

    def interrupted(self: Campaign) -> None:
        nonlocal looks
        looks += 1
        if looks > 1:
            raise KeyboardInterrupt
        self.waiting = [job for job in self.waiting if not self.start(job)]

    monkeypatch.setattr(Campaign, "look", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run.run()
    (process, _), *_ = run.running.values()
    assert process.wait(10) != 0


@pytest.mark.extended
def test_rows_bring_the_scenes_they_need(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    jobs = campaign.chosen(_args(tmp_path, "--rows", "paper-urbanverse160-*", "--seeds", "4"))
    names = ["catalogue", "scenes-urbanverse160", "scenes-craftbench", "scenes-autobench", "paper-urbanverse160-4"]
    assert [job.name for job in jobs] == names
    given = {job.gives for job in jobs}
    assert all(set(job.needs) <= given for job in jobs), "a job needs what no job gives"
    jobs = campaign.chosen(_args(tmp_path, "--rows", "horizon-100-*", "--seeds", "4"))
    names = ["catalogue", "scenes-urbanverse160", "scenes-craftbench", "halves-urbanverse160", "halves-craftbench"]
    assert [job.name for job in jobs] == [*names, "horizon-100-4"]
    given = {job.gives for job in jobs}
    assert all(set(job.needs) <= given for job in jobs)
    jobs = campaign.chosen(_args(tmp_path, "--rows", "street-tuning-*"))
    streets = campaign.street_tuning.STREETS
    assert [job.name for job in jobs] == [
        "catalogue", *(f"prepare-{x}" for x in streets), *(f"street-tuning-{x}" for x in streets)
    ]  # fmt: skip
    assert [job.memory > 0 for job in jobs] == 4 * [False] + 3 * [True]
    jobs = campaign.chosen(_args(tmp_path, "--rows", "image-streets-*-4", "--seeds", "4"))
    sets = ["catalogue", "scenes-craftbench", "scenes-validation", "prepare-image-streets"]
    assert [job.name for job in jobs] == [*sets, "image-streets-exact-4", "image-streets-images-4"]
    trained = [job.command[job.command.index("--train") + 1] for job in jobs[-2:]]
    folder = tmp_path / "out" / "image-streets"
    assert trained == [str(folder / arm / "bank.npz") for arm in ("exact", "images")]
    shown = campaign.results.COMPARISONS["image_streets"].sets
    driven = {path.parent.name for path in jobs[-1].needs if path.name == "bank.npz"}
    assert {name.split("_")[0] for name in shown} == driven, "the table shows other sets than are driven"
    with pytest.raises(SystemExit, match="'papers-x', which names no row, needed a pattern of teacher-0"):
        campaign.chosen(_args(tmp_path, "--rows", "papers-x"))


@pytest.mark.extended
def test_all_needs_are_given_by_jobs_of_all_rows(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    jobs = campaign.chosen(_args(tmp_path))
    given = {job.gives for job in jobs}
    assert all(set(job.needs) <= given for job in jobs)
    assert len({job.name for job in jobs}) == len(jobs)


@pytest.fixture
def parsed(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> list[argparse.Namespace]:
    """What the scripts of all rows find in their command lines."""
    from benchmarks import (
        comparison,
        halves,
        image_streets,
        imitation,
        missions,
        several_gpus,
        street_tuning,
        transfer,
    )

    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    scripts = {"benchmarks.generalise": generalise.arguments, "benchmarks.comparison": comparison.arguments}
    scripts |= {"benchmarks.halves": halves.arguments, "benchmarks.transfer": transfer.arguments}
    scripts |= {"benchmarks.missions": missions.arguments, "benchmarks.street_tuning": street_tuning.arguments}
    scripts["benchmarks.several_gpus"] = several_gpus.arguments
    scripts["benchmarks.imitation"] = imitation.arguments
    scripts["benchmarks.image_streets"] = image_streets.arguments
    scripts["benchmarks.tasks"] = tasks.arguments
    scripts["benchmarks.embodiment"] = embodiment.arguments
    scripts["benchmarks.gaits"] = gaits.arguments
    parsed = []
    for job in campaign.chosen(_args(tmp_path)):
        if job.command[0] == "-m":
            monkeypatch.setattr(sys, "argv", [job.name, *job.command[2:]])
            parsed.append(scripts[job.command[1]]())
            own = {"benchmarks.halves": job.gives.parent, "benchmarks.street_tuning": job.gives.parents[2]}
            own["benchmarks.image_streets"] = job.gives.parent
            wanted = own.get(job.command[1], tmp_path / "out" / job.name)
            assert parsed[-1].out == wanted
    return parsed


def test_commands_have_options_that_their_scripts_know(parsed: list[argparse.Namespace]) -> None:
    by_seed = 2 + 2 + 3 + 2 + 3 + len(campaign.TEACHER_ARMS) + (2 * 12 + 2) + 12 + 2 + 2 * len(tasks.TASKS)
    by_seed += 2 + 2 * len(embodiment.TRAINED) + len(embodiment.HELD_OUT) + len(gaits.ROBOTS)
    assert len(parsed) == 3 * by_seed + 4 + 1 + 3 + 2 * 5 + 4 + 2 * 3 + 2 * 2 + 1
    scaled = next(args for args in parsed if args.out.name == "scaling-layouts-8-2")
    assert scaled.scenes == scaling.subset("layouts", 8, 2)
    assert (scaled.preset, scaled.seed, scaled.steps) == ("fast", 2, 6_000_000)
    taught = next(args for args in parsed if args.out.name == "scaling-teacher-layouts-8-2")
    assert (taught.role, taught.scenes, taught.steps, taught.holdout) == ("teacher", scaled.scenes, 6_000_000, [0])
    assert [path.parent.name for path in taught.test] == ["craftbench"]
    light = ['vision_config.light="direct"', 'friction="uniform"']  # of version 1 of CraftBench
    assert scaled.env == ["vision_config.height=54", "vision_config.width=96", *light]
    # Those of street tuning take the same conditions by themselves; others are not judged on CraftBench.
    assert all(
        args.env[-2:] == light
        for args in parsed
        if "env" in args and not {"stage", "task", "untold", "actor"} & set(vars(args))
    )
    walks = {args.out.name: args for args in parsed if "actor" in args}
    assert set(walks) == {f"gait-{robot}-{seed}" for robot in ("mini_cheetah", "b2", "g1") for seed in (0, 1, 2)}
    assert (walks["gait-b2-1"].robot, walks["gait-b2-1"].seed, walks["gait-b2-1"].preset) == ("b2", 1, "fast")
    assert {args.steps for args in walks.values()} == {300_000_000}
    arms = {args.out.name: args for args in parsed if "-arm-" in args.out.name}
    assert all([path.parent.name for path in args.test] == ["validation"] for args in arms.values())
    for name in ("streets-both-0", "teacher-0", "student-0"):
        judged = next(args for args in parsed if args.out.name == name)
        assert [path.parent.name for path in judged.test] == ["validation", *campaign.BENCHMARKS]
    assert arms["teacher-arm-clutter-2"].env == ["randomization.clutter=8", *light]
    assert arms["student-arm-proprio-1"].set == ["network.proprio=false"]
    assert [arms[f"student-arm-{arm}-1"].memory for arm in ("memory", "base")] == [0, 256]
    assert {args.teacher.name for name, args in arms.items() if name.startswith("student")} == {"teacher-arm-base-0"}
    assert arms["student-arm-base-0"].steps * 65_536 == pytest.approx(10_000_000, rel=0.01)
    cloned = {args.out.name: args for args in parsed if args.out.name.startswith("imitation-")}
    assert {args.demonstrations for name, args in cloned.items() if args.role == "clone"} == {10, 100, 1000}
    seen = [
        (cloned[x.recorded.name].noise, x.last_action)
        for x in (cloned[f"imitation-1000{k}-1"] for k in ("", "-plain", "-noise", "-blind"))
    ]
    assert seen == [(0.2, False), (0.0, True), (0.2, True), (0.0, False)]
    recorded = [x for x in cloned.values() if x.role == "record"]
    assert {(x.demonstrations, x.seed) for x in recorded} == {(1000, seed) for seed in (0, 1, 2)}
    assert all(cloned[x.recorded.name].seed == x.seed for x in cloned.values() if x.role == "clone")
    assert cloned["imitation-100-ppo-2"].start == cloned["imitation-100-2"].out
    assert cloned["imitation-ppo-2"].start is None
    assert {args.samples for args in cloned.values()} == {8_000_000}
    assert {(tuple(args.holdout), args.train_scenes) for args in cloned.values()} == {((8,), 60)}
    go2 = next(args for args in parsed if args.out.name == "go2")
    assert go2.environment == "Go2Nav"
    assert go2.start.name == "finetuned"
    assert go2.holdout == [8, 9]
    assert go2.covered


@pytest.mark.extended
def test_students_are_trained_as_by_the_preset_and_without_its_variation(parsed: list[argparse.Namespace]) -> None:
    trained = {args.out.name: args for args in parsed}
    best = registry.get_default_config("CocoNav", "best")
    for name in ("student-2", "matte-2", "go2", "teacher-2", "ideal-student-2", "ideal-go2"):
        args = trained[name]
        fast = registry.get_default_config(args.environment, "fast")
        config = registry.with_overrides(fast, parsed_options(args.env))
        if name.startswith("ideal-"):
            assert config.randomization == fast.randomization, name
            assert not args.set
            continue
        assert config.randomization.latency == best.randomization.latency, name
        if name == "teacher-2":
            assert config.randomization.pixel_noise == 0.0
            continue
        assert config.randomization == best.randomization, name
        assert config.vision_config.shading == ("matte" if name == "matte-2" else best.vision_config.shading)
        own = default_ppo_config("best")
        assert parsed_options(args.set) == {"light": own.light, "pixel_noise": own.pixel_noise}
    for prefix in ("", "ideal-"):
        assert trained[f"{prefix}go2"].start == trained[f"{prefix}student-1"].out / "finetuned"
        assert trained[f"{prefix}student-2"].teacher.name == f"{prefix}teacher-2"


@pytest.mark.extended
def test_results_become_rows_of_scores(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(campaign.results, "SCORES", tmp_path)
    (tmp_path / "by_scene.csv").write_text("policy,robot,seed,env_steps,benchmark,scene,SR,RC,hit_episodes\n")
    (tmp_path / "training_streets.csv").write_text("arm,seed,set,scene,SR\n")
    (tmp_path / "student_arms.csv").write_text("arm,seed,set,scene,SR\n")
    (tmp_path / "imitation.csv").write_text("arm,seed,set,scene,SR\n")
    (tmp_path / "scaling.csv").write_text("study,size,seed,env_steps,scenes,subset,set,scene,SR\n")
    score = {"summary": {}, "by_scene": {"s": {"SR": 50.0, "RC": 60.0, "hit_episodes": 10.0}}}
    sets = dict.fromkeys(("craftbench", "autobench", *campaign.results.VALIDATION), score)
    args = _args(tmp_path)
    for job, agent in (
        ("paper-urbanverse160-2", "paper"),
        ("streets-both-1", "teacher"),
        ("student-arm-memory-1", "student"),
    ):
        (args.out / job).mkdir()
        (args.out / job / "result.json").write_text(json.dumps({"steps": 9, agent: sets}))
    (args.out / "scaling-cousins-1-2").mkdir()
    point = {"steps": 9, "trained_on": scaling.subset("cousins", 1, 2), "fast": {"craftbench": score}}
    (args.out / "scaling-cousins-1-2" / "result.json").write_text(json.dumps(point))
    (args.out / "imitation-10-ppo-1").mkdir()
    both = {"student": sets, "covered": sets}
    (args.out / "imitation-10-ppo-1" / "result.json").write_text(json.dumps(both))
    assert campaign.add_rows(args) == 0
    assert capsys.readouterr().out.splitlines() == [
        "paper-urbanverse160-2: paper, UrbanVerse-160",
        "streets-both-1: both",
        "student-arm-memory-1: without memory",
        "imitation-10-ppo-1: BC, 10 demonstrations, then PPO",
        "imitation-10-ppo-1: BC, 10 demonstrations, then PPO, camera covered",
        "scaling-cousins-1-2: cousins 1",
    ]
    rows = (tmp_path / "by_scene.csv").read_text().splitlines()
    assert rows[1:] == [
        f'"paper, UrbanVerse-160",COCO,2,9,{name},s,50.0,60.0,10.0' for name in ("craftbench", "autobench")
    ]
    digest = scaling.digest(point["trained_on"])
    assert (tmp_path / "scaling.csv").read_text().splitlines()[1:] == [f"cousins,1,2,9,32,{digest},craftbench,s,50.0"]
    assert (tmp_path / "student_arms.csv").read_text().splitlines()[1:] == [
        f"without memory,1,{name},s,50.0" for name in campaign.results.VALIDATION
    ]
    assert len((tmp_path / "imitation.csv").read_text().splitlines()) == 1 + 2 * len(
        campaign.results.COMPARISONS["imitation"].sets
    )
    assert "both,1,validation_composed,s,50.0" in (tmp_path / "training_streets.csv").read_text()
