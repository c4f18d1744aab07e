"""Builds the scenes, then trains and scores the rows of docs/results.md, on all GPUs of one machine.

    python -m benchmarks.campaign --out runs/campaign --gpus 2                        # hours on two GPUs
    python -m benchmarks.campaign --out runs/campaign --gpus 2 --rows "paper-*" --seeds 0 1 2 --paper-steps 2097152
    python -m benchmarks.campaign --out runs/campaign --rows "teacher-*" "student-*" --list
    python -m benchmarks.campaign --out runs/campaign --add

The first commands run jobs, several on a GPU as its memory allows, in the order of the patterns of `--rows`; a job
begins when the files that it needs are there (a student compiles beside its teacher and waits for it), and one whose
result is there is not run again, so a campaign continues where it was interrupted. `--list` prints the
commands in place of running them. `--add` writes the rows of all results into benchmarks/scores, for `make results`.
Rows, of which `--rows` names patterns:

    teacher-SEED            privileged teacher on procedural and places
    student-SEED            its student, and PPO from there: the rows `student` and `best`
    matte-SEED              the same in the shading of `fast`
    go2                     COCO's student of `--ship` imitates the same teacher on the Go2
    go2-teacher             a teacher on the Go2
    ideal-teacher-SEED, ideal-student-SEED, ideal-go2, ideal-go2-teacher  with sensors and motion that do not vary
    paper-SET-SEED          preset `paper` on procedural or urbanverse160, equal steps
    one-street              preset `paper` on a single street
    go2-paper-SET, go2-one-street  the same on the Go2
    streets-SET-SEED        teachers that differ in their training streets alone: procedural, urbanverse160, both
    long-streets-SET-SEED   the same on procedural and urbanverse160 with twice the env-steps
    teacher-arm-ARM-SEED    teachers as they are, with clutter, starts anywhere, episodes drawn by learnability, told
                            which arcs are free of objects
    student-arm-ARM-SEED    students of teacher-arm-base-0 (`--seeds`' first) as they are, and without one part
    goes-on-BENCHMARK-POLICY  contact does not end an episode
    scaling-STUDY-SIZE-SEED preset `fast` on so many layouts, cousins or streets (see benchmarks.scaling), and the
                            privileged teacher: scaling-teacher-STUDY-SIZE-SEED
    horizon-LENGTH-SEED     the same on halves (100 m) and whole scenes (200 m) of urbanverse160
    transfer                the shipped policies in the places of benchmarks.transfer, on all cores
    missions                the shipped policies on the missions of benchmarks.missions, on all cores
    image-streets-ARM-SEED  teachers on cousins of ten streets, distilled with exact inputs and from images alone (see
                            benchmarks.image_streets)
    gpus-NUMBER-SEED        the preset `best` on one or two GPUs that run nothing else (see benchmarks.several_gpus)
    imitation-recorded-KIND-SEED  demonstrations of the planner, with noise or plain, recorded on the processor
    imitation-NUMBER-SEED   the student of `best` fitted to demonstrations of the planner (see benchmarks.imitation)
    imitation-NUMBER-ppo-SEED  PPO from there; imitation-ppo-SEED from random weights, with equally many samples
    imitation-1000-VARIANT-SEED  without noise in the demonstrations, and with a student that sees its last action
    task-TASK-SEED          teacher and camera policy of a task beside point goals (see benchmarks.tasks)
    task-TASK-teacher-SEED  the teacher alone
    embodiment-shared-SEED  one privileged policy of many robots, told their size and dynamics; embodiment-untold-SEED
                            not told; embodiment-ROBOT-SEED of one robot (see benchmarks.embodiment)
    embodiment-score-ROBOT-SEED  these, driven with a robot on validation streets
    gait-ROBOT-SEED         the gait of a robot with legs (see benchmarks.gaits, whose `ship` puts it into the package)
    street-tuning-STREET    coco_best before and after PPO on cousins of a filmed street (see benchmarks.street_tuning)

OUT gets a folder and a log for each job, and campaign.log.
"""

import argparse
import dataclasses
import fnmatch
import functools
import json
import os
import pathlib
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator, Sequence

from benchmarks import (
    embodiment,
    gaits,
    image_streets,
    imitation,
    missions,
    results,
    scaling,
    several_gpus,
    street_tuning,
    tasks,
    transfer,
)
from benchmarks.lib.options import option
from urbanverse_mjx import settings
from urbanverse_mjx.assets.records.store import store_path
from urbanverse_mjx.scene import library

#: Scenes held out of each training set to choose checkpoints on: the last ones.
HELD_OUT = {"procedural": 8, "places": 9}
#: The same of the rows of benchmarks.imitation, and of how many scenes: they compare ways to begin, not streets.
IMITATED, IMITATED_STREETS = {"procedural": 8}, 60
#: The same for the comparison of training streets: 16 procedural streets, four layouts of five cousins.
STREETS = {
    "procedural": {"procedural": 16},
    "urbanverse160": {"urbanverse160": 20},
    "both": {"urbanverse160": 20, "procedural": 16},
}
PAPER_ROWS = {"procedural": "paper, procedural-160", "urbanverse160": "paper, UrbanVerse-160"}
#: Robot in the tables -> its environment.
ENVIRONMENTS = {"COCO": "CocoNav", "Go2": "Go2Nav"}
#: Training streets -> their name in the table.
STREET_NAMES = {"procedural": "144 procedural", "urbanverse160": "140 of UrbanVerse-160", "both": "both"}
#: Name of a row -> name in the table, and environment options.
TEACHER_ARMS = {
    "base": ("as it is", ()),
    "clutter": ("8 objects of clutter", ("randomization.clutter=8",)),
    "starts": ("half of the starts anywhere", ("randomization.starts=0.5",)),
    "learnable": ("half of the episodes by p (1 - p)", ("schedule.learnable=0.5",)),
    "arcs": ("told which arcs are free", ("observations.clear_arcs=true",)),
}
CAMERA = ("camera_position=0.03", "camera_angle=3.0", "camera_fovy=0.1")
#: The same, and options of the student.
STUDENT_ARMS: dict[str, tuple[str, tuple[str, ...], dict[str, object]]] = {
    "base": ("as it is", (), {}),
    "proprio": ("without proprioception", (), {"set": ("network.proprio=false",)}),
    "memory": ("without memory", (), {"memory": 0}),
    "auxiliary": ("without auxiliary head", (), {"set": ("auxiliary=0.0",)}),
    "camera": ("with camera randomisation", tuple(f"randomization.{x}" for x in CAMERA), {"set": ("blur=1.0",)}),
}
#: Fields of `randomization` that the teacher, who has no camera, meets too.
OF_ROBOT = ("latency", "friction_scale")
#: Options of a training whose images the environment varies already.
NOT_RELIT = ("light=0.0", "pixel_noise=0.0")
#: Prefix of rows whose sensors and motion do not vary -> end of their names in the table.
RECIPES = {"": "", "ideal-": ", ideal sensors"}
BENCHMARKS = tuple(results.BENCHMARKS)
GOES_ON = ("go_to_goal", "planner", "benchmarks/policies/coco_best", "benchmarks/policies/go2_best")
#: Env-steps of an iteration of imitation.
STEPS = 4096 * 16
#: s; trainings end by their steps.
ENDLESS = 86_400
#: GiB of GPU memory: of a teacher, imitation (two of it and a teacher took 17 to 28), imitation and PPO, the preset
#: `paper` (two CNNs at 135x240: 22 in training, 38 in the episodes of its scores), a benchmark; of the preset `fast` at
#: 54x96, not measured: it takes 7 GiB at 135x240, without the scores of 768 episodes at once.
TEACHER, IMITATION, STUDENT, PAPER, DRIVE, FAST = 12, 16, 34, 38, 14, 14
#: The same of the policy of many robots and of one robot's, without camera; not measured, from the number of envs.
MANY_ROBOTS, ONE_ROBOT = 24, 6
#: The same of a joystick environment without images; not measured.
GAIT = 10
#: Studies that drive on all cores -> what writes their rows.
OF_ALL_CORES = {"transfer": transfer.add, "missions": missions.add}


#: Name of the study of benchmarks.street_tuning, and of its folder.
STREET_TUNING = "street-tuning"
#: The same of benchmarks.image_streets, and its arms -> their name in the table.
IMAGE_STREETS = "image-streets"
IMAGE_ARMS = {"exact": "exact inputs", "images": "images alone"}
#: The same of benchmarks.several_gpus.
SEVERAL_GPUS = "gpus"
#: The same of benchmarks.tasks, the sets to train on, and the number of streets of each: tables of crowds take seconds
#: each. A teacher of FollowRoute that saw procedural streets alone arrives in 79 % of episodes in others of them, but
#: in 17 % in composed streets (docs/tasks/follow_route.md).
TASK, TASK_SETS, TASK_STREETS = "task", ("procedural", "places"), 48
#: Least number of episodes of a task's references in benchmarks/scores with which they are not driven again.
TASK_EPISODES = 256
#: Name of the study of benchmarks.embodiment, and its number of procedural streets to train on.
EMBODIMENT, EMBODIMENT_STREETS = "embodiment", 24


@dataclasses.dataclass(frozen=True)
class Row:
    """Arguments of `benchmarks.results --add`: agent in result.json, and the place of its rows (with a comparison, its
    arm); of `scaling.add` if there is a study."""

    agent: str
    policy: str = ""
    robot: str = "COCO"
    seed: int = 0
    comparison: str = ""
    arm: str = ""
    study: str = ""
    size: int = 0


@dataclasses.dataclass(frozen=True)
class Job:
    """A command of this interpreter.

    Attributes:
      needs: files that must be there before it begins.
      awaits: a file that it waits for by itself, which a job that runs may still be making.
      gives: a file that is there once it is done.
      memory: GiB of GPU memory of each GPU; 0 for a job on the processor alone.
      rows: of its result.json.
      gpus: number of GPUs; more than one are to be free of other jobs.
    """

    name: str
    command: tuple[str, ...]
    needs: tuple[pathlib.Path, ...]
    gives: pathlib.Path
    memory: int = 0
    rows: tuple[Row, ...] = ()
    awaits: pathlib.Path | None = None
    gpus: int = 1


def bank(name: str) -> pathlib.Path:
    """The bank of a set of the scene library."""
    return library.folder(name) / library.BANK


def _banks(names: Iterable[str]) -> list[str]:
    return [str(bank(name)) for name in names]


def _job(
    args: argparse.Namespace, name: str, command: Sequence[object], sets: Sequence[str], memory: int,
    rows: Sequence[Row], *needs: pathlib.Path,
) -> Job:  # fmt: skip
    words = ("-m", *(str(word) for word in command), "--out", str(args.out / name))
    files = (*(bank(x) for x in dict.fromkeys(sets)), *needs)
    return Job(name, words, files, args.out / name / "result.json", memory, tuple(rows))


@functools.cache
def _conditions() -> tuple[str, ...]:
    """Environment options of the conditions that CraftBench and AutoBench were frozen with: scores are of the same
    task, and rows of the same table of the same light."""
    from urbanverse_mjx.evaluation.frozen import Protocol

    found = Protocol.load(settings.protocol_root() / "craftbench.json").conditions
    return tuple(f"{key}={json.dumps(value)}" for key, value in found.items())


@functools.cache
def _varied(camera: bool) -> tuple[str, ...]:
    """Environment options in which the preset `best` differs from `fast`, of which the rows are made: those of the
    robot, and with `camera` of its images and their shading too."""
    from urbanverse_mjx.envs.navigation.config import default_config

    best, fast = (default_config(name) for name in ("best", "fast"))
    found = {
        f"randomization.{name}": value
        for name, value in best.randomization.items()
        if value != fast.randomization[name] and (camera or name in OF_ROBOT)
    }
    found |= {"vision_config.shading": best.vision_config.shading} if camera else {}
    return tuple(f"{name}={json.dumps(value)}" for name, value in found.items())


def _words(
    role: str, trained: Sequence[object], holdout: Sequence[int], tests: Sequence[str], seed: int,
    own: dict[str, object], env: Sequence[str] = (),
) -> list[object]:  # fmt: skip
    """The words of a command of `benchmarks.generalise` on the banks `trained`, with options of its `own`."""
    words: list[object] = ["benchmarks.generalise", role, "--no-map", "--train", *trained]
    words += ["--holdout", *holdout, "--test", *_banks(tests), "--seed", seed, "--env", *env, *_conditions()]
    for key, value in own.items():
        words += [f"--{key.replace('_', '-')}", *(value if isinstance(value, tuple) else (value,))]
    return words


def _of_teacher(steps: int, robot: str = "CocoNav") -> dict[str, object]:
    """Options of a teacher's own."""
    return {"steps": steps, "seconds": ENDLESS, "checkpoints": max(8, steps // 300_000), "environment": robot}


def _tests(rows: Sequence[Row]) -> tuple[str, ...]:
    """The sets that the tables of rows show: arms of a comparison of validation sets are not driven on benchmarks."""
    sets = {
        kept for row in rows for kept in (results.COMPARISONS[row.comparison].sets if row.comparison else BENCHMARKS)
    }
    return ("validation", *(x for x in BENCHMARKS if x in sets))


def _generalise(
    args: argparse.Namespace, name: str, role: str, held: dict[str, int], seed: int, own: dict[str, object],
    rows: Sequence[Row], *needs: pathlib.Path, env: Sequence[str] = (),
) -> Job:  # fmt: skip
    """A job of `benchmarks.generalise` on the sets `held`, without their last scenes, with options of its `own`."""
    tests = _tests(rows)
    words = _words(role, _banks(held), tuple(held.values()), tests, seed, own, env)
    memory = TEACHER if role == "teacher" else STUDENT if "finetune_steps" in own else IMITATION
    return _job(args, name, words, (*held, *tests), memory, rows, *needs)


def _teacher(
    args: argparse.Namespace, name: str, held: dict[str, int], seed: int, steps: int, row: Row, robot: str = "CocoNav",
    env: Sequence[str] = (),
) -> Job:  # fmt: skip
    return _generalise(args, name, "teacher", held, seed, _of_teacher(steps, robot), [row], env=env)


def _student(
    args: argparse.Namespace, name: str, seed: int, own: dict[str, object], rows: Sequence[Row], *needs: pathlib.Path,
    env: Sequence[str] = (), teacher: str = "",
) -> Job:  # fmt: skip
    folder = args.out / (teacher or f"teacher-{seed}")
    own = {"memory": 256, "teacher": folder, **own}
    job = _generalise(args, name, "student", HELD_OUT, seed, own, rows, *needs, env=env)
    return dataclasses.replace(job, awaits=folder / "result.json")


def _paper(
    args: argparse.Namespace, name: str, streets: str, seed: int, policy: str, *scenes: str, robot: str = "COCO"
) -> Job:
    words: list[object] = ["benchmarks.comparison", "--train", *_banks([streets]), "--test", *_banks(BENCHMARKS)]
    words += ["--scenes", *scenes] if scenes else []
    words += ["--environment", ENVIRONMENTS[robot]] if robot != "COCO" else []
    words += ["--steps", args.paper_steps, "--seed", seed, "--num-envs", 1024, "--env", *_conditions()]
    return _job(args, name, words, (streets, *BENCHMARKS), PAPER, [Row("paper", policy, robot, seed)])


def _one_robot(args: argparse.Namespace, robot: str) -> Iterator[Job]:
    """The preset `paper` on both sets of streets and on one street, with one seed of a robot."""
    for streets, policy in PAPER_ROWS.items():
        yield _paper(args, f"{robot.lower()}-paper-{streets}", streets, args.ship, policy, robot=robot)
    name = f"{robot.lower()}-one-street"
    yield _paper(args, name, "procedural", args.ship, "one street", "procedural_000", robot=robot)


def _halves(args: argparse.Namespace, name: str) -> pathlib.Path:
    """The bank of the halves of a set, which this campaign cuts for itself."""
    return args.out / f"{name}_halves" / library.BANK


def _fast(args: argparse.Namespace, row: Row, trained: pathlib.Path, tests: Sequence[pathlib.Path]) -> Job:
    """A point of benchmarks.scaling: the preset `fast` at 54x96 with equal env-steps, trained and driven in the
    conditions that CraftBench was frozen with."""
    name = f"{row.study}-{row.size}-{row.seed}"
    name = f"scaling-{name}" if row.study in scaling.SIZES else name
    words: list[object] = ["benchmarks.comparison", "--preset", "fast", "--train", trained, "--test", *tests]
    words += ["--env", "vision_config.height=54", "vision_config.width=96"]
    words += [*_conditions(), "--steps", args.scaling_steps, "--seed", row.seed]
    if row.study in scaling.SIZES:
        words += ["--scenes", *scaling.subset(row.study, row.size, row.seed)]
    return _job(args, name, words, (), FAST, [row], trained, *tests)


def _scaled_teacher(args: argparse.Namespace, row: Row) -> Job:
    """A point of benchmarks.scaling of the privileged teacher; its final parameters are driven."""
    streets, tests = scaling.SETS[scaling.varied(row.study)], ("craftbench",)
    own = _of_teacher(args.scaling_steps) | {"checkpoints": 1}
    own |= {"scenes": tuple(scaling.subset(row.study, row.size, row.seed))}
    words = _words("teacher", _banks([streets]), (0,), tests, row.seed, own)
    return _job(args, f"scaling-{row.study}-{row.size}-{row.seed}", words, (streets, *tests), TEACHER, [row])


def _studies(args: argparse.Namespace) -> Iterator[Job]:
    """The points of benchmarks.scaling, all of a seed before the next seed."""
    for seed in args.seeds:
        for study, sizes in scaling.SIZES.items():
            for size in sizes:
                if study.startswith(scaling.TEACHER):
                    yield _scaled_teacher(args, Row("teacher", seed=seed, study=study, size=size))
                else:
                    row = Row("fast", seed=seed, study=study, size=size)
                    yield _fast(args, row, bank(scaling.SETS[study]), [bank("craftbench")])
        tests = [bank("craftbench"), _halves(args, "craftbench")]
        for length, trained in ((100, _halves(args, "urbanverse160")), (200, bank("urbanverse160"))):
            yield _fast(args, Row("fast", seed=seed, study="horizon", size=length), trained, tests)


def _goes_on(args: argparse.Namespace, name: str, policy: str) -> Job:
    called = f"goes-on-{name}-{pathlib.Path(policy).name}"
    robot = "Go2Nav" if "go2_" in policy else "CocoNav"
    options = {"policy": policy, "protocol": "full", "contact": "goes_on", "at_once": 768, "env_name": robot}
    options["pictures"] = False
    code = "from urbanverse_mjx import pipeline; pipeline.benchmark({!r}, {!r}, pipeline.BenchmarkOptions(**{!r}))"
    words = ("-c", code.format(name, str(args.out / called), options))
    return Job(called, words, (bank(name),), args.out / called / "timing.json", DRIVE)


def _imitation_then_ppo(args: argparse.Namespace, relit: tuple[str, ...]) -> dict[str, object]:
    """Options of a student that goes on by PPO; relit: options of both about their images."""
    own: dict[str, object] = {"steps": args.imitation, "seconds": ENDLESS, "validate_every": 80, "covered": ()}
    own |= {"finetune_steps": args.ppo, "finetune_seconds": ENDLESS, "set": relit}
    return own | {"set_finetune": ("imitation=0.0", "final_imitation=0.0", *relit)}


def _best(args: argparse.Namespace) -> Iterator[Job]:
    """The students after their teachers, and the Go2 after the student that it starts from."""
    for prefix, ending in RECIPES.items():
        varied = not prefix
        env = _varied(camera=True) if varied else ()
        relit = NOT_RELIT if varied else ()
        for seed in args.seeds:
            teacher = f"{prefix}teacher-{seed}"
            agents = {"student": "student", "finetuned": "best", "covered": "best, camera covered"}
            rows = [Row(agent, f"{policy}{ending}", seed=seed) for agent, policy in agents.items()]
            own = _imitation_then_ppo(args, relit)
            yield _student(args, f"{prefix}student-{seed}", seed, own, rows, env=env, teacher=teacher)
            if varied:
                rows = [Row("finetuned", "best, matte", seed=seed)]
                matte = (*env, 'vision_config.shading="matte"')
                yield _student(args, f"matte-{seed}", seed, own, rows, env=matte, teacher=teacher)
        start = args.out / f"{prefix}student-{args.ship}"
        own = {"steps": args.go2, "seconds": ENDLESS, "validate_every": 20, "covered": (), "set": relit}
        own |= {"environment": "Go2Nav", "start": start / "finetuned"}
        row = Row("student", f"go2_best{ending}", "Go2", args.ship)
        name, teacher = f"{prefix}go2", f"{prefix}teacher-{args.ship}"
        yield _student(args, name, args.ship, own, [row], start / "result.json", env=env, teacher=teacher)
        row = Row("teacher", f"teacher{ending}", "Go2", args.ship)
        env = _varied(camera=False) if varied else ()
        yield _teacher(args, f"{name}-teacher", HELD_OUT, args.ship, args.teacher_steps, row, "Go2Nav", env)


def _arms(args: argparse.Namespace) -> Iterator[Job]:
    """Ablations, judged on validation streets."""
    for seed in args.seeds:
        for arm, (called, env) in TEACHER_ARMS.items():
            row = Row("teacher", seed=seed, comparison="teacher_arms", arm=called)
            yield _teacher(args, f"teacher-arm-{arm}-{seed}", HELD_OUT, seed, args.arm_steps, row, env=env)
    for seed in args.seeds[:2]:
        for arm, (called, env, options) in STUDENT_ARMS.items():
            row = Row("student", seed=seed, comparison="student_arms", arm=called)
            iterations = -(-args.arm_steps // STEPS)
            own = {"steps": iterations, "seconds": ENDLESS, "validate_every": iterations, **options}
            teacher = f"teacher-arm-base-{args.seeds[0]}"
            yield _student(args, f"student-arm-{arm}-{seed}", seed, own, [row], env=env, teacher=teacher)


def _street_tuning(args: argparse.Namespace) -> Iterator[Job]:
    """Policies of the streets of benchmarks.street_tuning; what they need is prepared on the processor before."""
    out = args.out / STREET_TUNING
    for street in street_tuning.STREETS:
        words = ("-m", "benchmarks.street_tuning", "tune", "--streets", street, "--out", str(out))
        needs, gives = out / "prepared" / street / street_tuning.PREPARED, out / "tuned" / street / street_tuning.RESULT
        yield Job(f"{STREET_TUNING}-{street}", words, (needs,), gives, STUDENT, (Row("film", study=STREET_TUNING),))


def _image_streets(args: argparse.Namespace) -> Iterator[Job]:
    """Teachers on the banks of benchmarks.image_streets; two streets' cousins choose their checkpoints. What they need
    is prepared on the processor before."""
    for seed in args.seeds:
        for arm, called in IMAGE_ARMS.items():
            folder = args.out / IMAGE_STREETS
            trained = folder / arm / image_streets.BANK
            row = Row("teacher", seed=seed, comparison="image_streets", arm=called)
            sets, held = _tests([row]), (2 * image_streets.COUSINS,)
            words = _words("teacher", [trained], held, sets, seed, _of_teacher(args.street_steps))
            name = f"{IMAGE_STREETS}-{arm}-{seed}"
            yield _job(args, name, words, sets, TEACHER, [row], folder / image_streets.BANKS)


def _several_gpus(args: argparse.Namespace) -> Iterator[Job]:
    """The same training on one and on two GPUs. Nothing else runs on them, because speeds are compared."""
    for seed in args.seeds[: len(several_gpus.SEEDS)]:
        for gpus in several_gpus.GPUS:
            words: list[object] = ["benchmarks.several_gpus", "--train", *_banks(["procedural"])]
            words += ["--test", *_banks([several_gpus.TEST]), "--seed", seed, "--env", *_conditions()]
            sets, row = ("procedural", several_gpus.TEST), Row(several_gpus.AGENT, study=SEVERAL_GPUS, seed=seed)
            job = _job(args, f"{SEVERAL_GPUS}-{gpus}-{seed}", words, sets, args.gpu_memory, [row])
            yield dataclasses.replace(job, gpus=gpus)


def _tasks(args: argparse.Namespace) -> Iterator[Job]:
    """The teacher of each task alone, and the three stages of the preset `best`, between baseline and planner on
    validation streets."""
    for seed in args.seeds:
        for task, (page, _) in tasks.TASKS.items():
            for ending, camera in (("-teacher", ()), ("", ("--camera",))):
                words: list[object] = ["benchmarks.tasks", "--task", task, "--train", *_banks(TASK_SETS)]
                words += ["--train-scenes", TASK_STREETS, "--test", *_banks(["validation"]), *camera]
                words += ["--steps", args.task_steps, "--seed", seed]
                words += ["--alone"] if tasks.driven_references(task) >= TASK_EPISODES else []
                name = f"{TASK}-{pathlib.Path(page).stem}{ending}-{seed}"
                memory = STUDENT if camera else TEACHER
                yield _job(args, name, words, (*TASK_SETS, "validation"), memory, [Row(task, study=TASK, seed=seed)])


def _of_imitation(seed: int, *own: object) -> list[object]:
    """The words of a command of `benchmarks.imitation`; own: its role first."""
    words = ["benchmarks.imitation", *own, "--train", *_banks(IMITATED), "--holdout", *IMITATED.values()]
    return [*words, "--train-scenes", IMITATED_STREETS, "--seed", seed, "--env", *_conditions()]


def _imitated(
    args: argparse.Namespace, name: str, arm: str, seed: int, own: Sequence[object], *needs: pathlib.Path
) -> Job:
    words = _of_imitation(seed, *own, "--test", *_banks(["validation"]))
    rows = [Row("student", comparison="imitation", arm=arm, seed=seed)]
    rows.append(dataclasses.replace(rows[0], agent="covered", arm=f"{arm}, camera covered"))
    memory = IMITATION if own[0] == "clone" else STUDENT
    return _job(args, f"imitation-{name}-{seed}", words, (*IMITATED, "validation"), memory, rows, *needs)


def _recorded(args: argparse.Namespace, noisy: bool, seed: int) -> Job:
    """The demonstrations of a seed, recorded on the processor."""
    name = f"imitation-recorded-{'noise' if noisy else 'plain'}-{seed}"
    noise = () if noisy else ("--noise", 0.0)
    words = _of_imitation(seed, "record", "--demonstrations", max(imitation.COUNTS), *noise)
    return _job(args, name, words, tuple(IMITATED), 0, ())


def _cloned(
    args: argparse.Namespace, recorded: Job, name: str, arm: str, seed: int, count: int, *options: object
) -> Job:
    """Behaviour cloning of the first `count` demonstrations that a job records."""
    own = ["clone", "--recorded", recorded.gives.parent, "--demonstrations", count, *options]
    return _imitated(args, name, arm, seed, own, recorded.gives)


def _imitation(args: argparse.Namespace) -> Iterator[Job]:
    """Demonstrations, behaviour cloning, and PPO after it and without it."""
    most = max(imitation.COUNTS)
    for seed in args.seeds:
        recorded = {noisy: _recorded(args, noisy, seed) for noisy in (True, False)}
        yield from recorded.values()
        for count in imitation.COUNTS:
            yield _cloned(args, recorded[True], f"{count}", f"BC, {count} demonstrations", seed, count)
        for name, (noisy, options, called) in imitation.VARIANTS.items():
            arm = f"BC, {most} demonstrations, {called}"
            yield _cloned(args, recorded[noisy], f"{most}-{name}", arm, seed, most, *options)
        for count in imitation.COUNTS:
            start = args.out / f"imitation-{count}-{seed}"
            own = ["ppo", "--start", start, "--samples", args.samples]
            arm = f"BC, {count} demonstrations, then PPO"
            yield _imitated(args, f"{count}-ppo", arm, seed, own, start / "result.json")
        own = ["ppo", "--samples", args.samples, "--set", *imitation.ALONE]
        yield _imitated(args, "ppo", results.COMPARISONS["imitation"].reference, seed, own)


def _embodiment(args: argparse.Namespace) -> Iterator[Job]:
    """The policy of many robots, told them and not, and one of each robot; and all of them driven with each robot."""
    for seed in args.seeds:
        folders = {}
        arms = {"shared": embodiment.TRAINED, "untold": embodiment.TRAINED}
        for arm, robots in (arms | {name: (name,) for name in embodiment.TRAINED}).items():
            words: list[object] = ["benchmarks.embodiment", "train", "--robots", *robots]
            # A robot that is always the same has nothing to be told.
            words += [] if arm == "shared" else ["--not-told"]
            words += ["--train", *_banks(["procedural"]), "--train-scenes", EMBODIMENT_STREETS]
            words += ["--steps", args.embodiment_steps, "--seed", seed, "--env"]
            memory = MANY_ROBOTS if arm in arms else ONE_ROBOT
            name = f"{EMBODIMENT}-{arm}-{seed}"
            folders[arm] = args.out / name
            yield _job(args, name, words, ("procedural",), memory, ())
        for robot in (*embodiment.TRAINED, *embodiment.HELD_OUT):
            own = {name: folders[name] for name in arms} | ({"own": folders[robot]} if robot in folders else {})
            words = ["benchmarks.embodiment", "score", "--robot", robot, "--test", *_banks(["validation"])]
            words += [word for name, folder in own.items() for word in (f"--{name}", folder)]
            needs = [folder / "result.json" for folder in own.values()]
            row = Row("shared", robot=robot, seed=seed, study=EMBODIMENT)
            name = f"{EMBODIMENT}-score-{robot}-{seed}"
            yield _job(args, name, [*words, "--env"], ("validation",), ONE_ROBOT, [row], *needs)


def _gaits(args: argparse.Namespace) -> Iterator[Job]:
    """The gaits of the robots with legs, on the terrain of `urbanverse scene terrain`."""
    for seed in args.seeds:
        for robot in gaits.ROBOTS:
            words = ["benchmarks.gaits", "train", "--robot", robot, "--steps", args.gait_steps, "--seed", seed]
            words += ["--preset", args.gait_preset]
            words += ["--processes", args.gait_processes, "--trials", args.gait_trials]
            yield _job(args, f"gait-{robot}-{seed}", [*words, "--env"], (), GAIT, (), settings.terrain_bank_path())


def trainings(args: argparse.Namespace) -> Iterator[Job]:
    """All jobs that train or score, whatever `--rows` says, in the order in which they should begin."""
    for prefix, ending in RECIPES.items():
        for seed in args.seeds:
            row, env = Row("teacher", f"teacher{ending}", seed=seed), () if prefix else _varied(camera=False)
            yield _teacher(args, f"{prefix}teacher-{seed}", HELD_OUT, seed, args.teacher_steps, row, env=env)
    for seed in args.seeds:
        for streets, policy in PAPER_ROWS.items():
            yield _paper(args, f"paper-{streets}-{seed}", streets, seed, policy)
    for seed in args.seeds:
        for name, held in STREETS.items():
            row = Row("teacher", seed=seed, comparison="training_streets", arm=STREET_NAMES[name])
            yield _teacher(args, f"streets-{name}-{seed}", held, seed, args.street_steps, row)
            if name != "both":
                row = dataclasses.replace(row, comparison="long_training_streets")
                yield _teacher(args, f"long-streets-{name}-{seed}", held, seed, 2 * args.street_steps, row)
    yield from _best(args)
    yield _paper(args, "one-street", "procedural", args.ship, "one street", "procedural_000")
    yield from _one_robot(args, "Go2")
    for name in BENCHMARKS:
        for policy in GOES_ON:
            yield _goes_on(args, name, policy)
    yield from _arms(args)
    yield from _imitation(args)
    yield from _studies(args)
    yield from _street_tuning(args)
    yield from _image_streets(args)
    yield from _several_gpus(args)
    yield from _tasks(args)
    yield from _embodiment(args)
    yield from _gaits(args)
    for name in OF_ALL_CORES:
        command = ("-m", f"benchmarks.{name}", "--out", str(args.out / name))
        # A GPU of its own each, because trainings beside them would want for processors.
        yield Job(name, command, (), args.out / name / "result.json", args.gpu_memory, (Row(name, study=name),))


def _with_env(job: Job, options: Sequence[str]) -> Job:
    """A job with further environment options, if it takes any."""
    if "--env" not in job.command:
        return job
    at = job.command.index("--env") + 1
    return dataclasses.replace(job, command=(*job.command[:at], *options, *job.command[at:]))


def chosen(args: argparse.Namespace) -> list[Job]:
    """The jobs that `--rows` names, after those that build the scenes which they need.

    Raises:
      SystemExit: a pattern names no row.
    """
    known = [_with_env(job, args.env) for job in trainings(args)]
    for pattern in args.rows:
        if not fnmatch.filter([job.name for job in known], pattern):
            names = ", ".join(job.name for job in known)
            raise SystemExit(f"error: --rows: found {pattern!r}, which names no row, needed a pattern of {names}.")
    # Each in the place of the first pattern that names it.
    named = {job.name: job for pattern in args.rows for job in known if fnmatch.fnmatch(job.name, pattern)}
    wanted = list(named.values())
    files = {path for job in wanted for path in job.needs}
    halves = []
    for name in ("urbanverse160", "craftbench"):
        path = _halves(args, name)
        if path in files:
            words = ("-m", "benchmarks.halves", name, "--out", str(path.parent))
            halves.append(Job(f"halves-{name}", words, (bank(name),), path))
            files.add(bank(name))
    store, prepares = store_path(), []
    for street in street_tuning.STREETS:
        path = args.out / STREET_TUNING / "prepared" / street / street_tuning.PREPARED
        if path in files:
            words = ("-m", "benchmarks.street_tuning", "prepare", "--streets", street)
            words += ("--out", str(args.out / STREET_TUNING))
            prepares.append(Job(f"prepare-{street}", words, (store,), path))
    banks = args.out / IMAGE_STREETS / image_streets.BANKS
    if banks in files:
        words = ("-m", "benchmarks.image_streets", "--out", str(args.out / IMAGE_STREETS))
        prepares.append(Job(f"prepare-{IMAGE_STREETS}", words, (store,), banks))
    if settings.terrain_bank_path() in files:
        code = "from urbanverse_mjx.pipeline.banks import ensure_terrain_bank; ensure_terrain_bank()"
        prepares.append(Job("terrain", ("-c", code), (), settings.terrain_bank_path()))
    # UrbanVerse-160 first: packing its bank takes minutes of one process, beside which the others are built.
    sets = ("urbanverse160", "craftbench", "autobench", "validation", "procedural", "places")
    code = "import sys; from urbanverse_mjx import pipeline; sys.exit(not pipeline.build_library({!r}, quiet=False).ok)"
    builds = [Job(f"scenes-{x}", ("-c", code.format(x)), (store,), bank(x)) for x in sets if bank(x) in files]
    if any(store in job.needs for job in prepares) or any(not job.gives.exists() for job in builds):
        make = "from urbanverse_mjx.assets.records.store import ensure_store; ensure_store()"
        builds.insert(0, Job("catalogue", ("-c", make), (), store))
    return builds + halves + prepares + wanted


def visible_gpus(number: int) -> list[str]:
    """Names of the GPUs to use, as in CUDA_VISIBLE_DEVICES: the first ones of that variable where it is set.

    Raises:
      SystemExit: it names fewer.
    """
    named = [name for name in os.environ.get("CUDA_VISIBLE_DEVICES", "").split(",") if name]
    if not named:
        return [str(k) for k in range(number)]
    if len(named) < number:
        raise SystemExit(
            f"error: --gpus: found {number}, and {','.join(named)} in CUDA_VISIBLE_DEVICES, needed at most "
            f"{len(named)}; unset that variable to use all GPUs."
        )
    return named[:number]


class Campaign:
    """Runs jobs; a GPU takes as many as its memory holds, the first that can begin before the others."""

    def __init__(self, args: argparse.Namespace, jobs: Sequence[Job]) -> None:
        self.args, self.begin = args, time.monotonic()
        self.devices = visible_gpus(args.gpus)
        self.waiting = [job for job in jobs if not job.gives.exists()]
        self.running: dict[Job, tuple[subprocess.Popen[bytes], tuple[int, ...]]] = {}
        self.failed: list[Job] = []

    def say(self, text: str) -> None:
        line = f"{time.monotonic() - self.begin:7.0f} s  {text}"
        with (self.args.out / "campaign.log").open("a", encoding="utf-8") as file:
            file.write(line + "\n")
        print(line, file=sys.stderr, flush=True)

    def free_gpus(self, job: Job) -> tuple[int, ...] | None:
        """The GPUs with the most free memory, if that is enough; several only where nothing else runs."""
        if not job.memory:
            return ()
        used = [sum(x.memory for x, (_, at) in self.running.items() if g in at) for g in range(self.args.gpus)]
        order = sorted(range(self.args.gpus), key=lambda g: used[g])[: job.gpus]
        most = self.args.gpu_memory if job.gpus == 1 else job.memory
        fits = len(order) == job.gpus and all(used[g] + job.memory <= most for g in order)
        return tuple(sorted(order)) if fits else None

    def start(self, job: Job) -> bool:
        """Starts a job if its files are there and a GPU has memory for it."""
        # A file of a running job may be incomplete or of an earlier run.
        unfinished = {other.gives for other in self.running}
        if not all(path.exists() and path not in unfinished for path in job.needs):
            return False
        if job.awaits and not (job.awaits.exists() or job.awaits in unfinished):
            return False
        gpus = self.free_gpus(job)
        if gpus is None:
            return False
        visible = ",".join(self.devices[g] for g in gpus)
        # Building scenes needs no GPU, and a context of CUDA in every worker costs half a GiB there.
        device = (
            {"CUDA_VISIBLE_DEVICES": visible} if job.memory else {"CUDA_VISIBLE_DEVICES": "", "JAX_PLATFORMS": "cpu"}
        )
        env = {**os.environ, "XLA_PYTHON_CLIENT_PREALLOCATE": "false", "OPENBLAS_NUM_THREADS": "1", **device}
        env.pop("PYTHONDONTWRITEBYTECODE", None)  # with it every worker compiles what it imports, for seconds
        # Sets of scenes are built at the same time, those of the first jobs before the others.
        nice = ["nice", "-n", str(sum(not other.memory for other in self.running))]
        with (self.args.out / f"{job.name}.log").open("wb") as log:
            command = [*nice, sys.executable, *job.command]
            process = subprocess.Popen(command, env=env, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        self.running[job] = process, gpus
        self.say(f"begin {job.name}" + (f" on GPU {visible}" if job.memory else ""))
        return True

    def look(self) -> None:
        """Takes note of jobs that ended, and starts others."""
        for job, (process, _) in list(self.running.items()):
            if process.poll() is None:
                continue
            del self.running[job]
            if process.returncode or not job.gives.exists():
                self.failed.append(job)
                for other, (waiting, _) in self.running.items():
                    if other.awaits == job.gives:
                        waiting.terminate()
                self.say(f"FAILED {job.name} with status {process.returncode}; see {self.args.out / job.name}.log")
            else:
                self.say(f"done {job.name}")
        late = self.args.until is not None and time.monotonic() - self.begin > self.args.until
        if not late:
            self.waiting = [job for job in self.waiting if not self.start(job)]

    def run(self) -> int:
        """Runs until no job can begin any more; returns the exit status."""
        try:
            while True:
                self.look()
                if not self.running:
                    break
                time.sleep(1.0)
        finally:
            for process, _ in self.running.values():
                process.send_signal(signal.SIGTERM)
        for job in self.waiting:
            missing = [str(path) for path in (*job.needs, job.awaits) if path and not path.exists()]
            missing += [f"{job.gpus} GPUs"] if job.gpus > self.args.gpus else []
            self.say(f"not begun: {job.name}" + (f", for want of {missing[0]}" if missing else ""))
        return 1 if self.failed or self.waiting else 0


def add_rows(args: argparse.Namespace) -> int:
    """Writes the rows of all results that are there into benchmarks/scores."""
    for job in trainings(args):
        for row in job.rows if job.gives.is_file() else ():
            if row.study in OF_ALL_CORES:
                OF_ALL_CORES[row.study](job.gives.parent)
            elif row.study == SEVERAL_GPUS:
                several_gpus.add(job.gives)
            elif row.study == TASK:
                tasks.add(job.gives)
            elif row.study == EMBODIMENT:
                embodiment.add(job.gives)
            elif row.study == STREET_TUNING:
                street_tuning.add(job.gives)
            elif row.study:
                scaling.add(results.SCORES, job.gives, row.study, row.size, row.seed)
            elif row.comparison:
                results.add_arm(results.SCORES, job.gives, row.agent, row.comparison, row.arm, row.seed)
            else:
                results.add(results.SCORES, job.gives, row.agent, row.policy, row.robot, row.seed)
            print(f"{job.name}: {f'{row.study} {row.size or ""}' if row.study else row.arm or row.policy}")
    return 0


def arguments() -> argparse.Namespace:
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("--out", type=pathlib.Path, required=True)
    cli.add_argument("--rows", nargs="+", default=["*"], help="patterns of rows; default: all")
    cli.add_argument("--seeds", nargs="+", type=int, default=[0, 1, 2])
    cli.add_argument("--ship", type=int, default=1, help="seed of the Go2's rows and of one street")
    cli.add_argument("--gpus", type=int, default=1, help="number, of those in CUDA_VISIBLE_DEVICES where it is set")
    cli.add_argument("--gpu-memory", type=int, default=80, help="GiB of each GPU")
    cli.add_argument("--until", type=float, help="s from now after which no job begins")
    cli.add_argument("--teacher-steps", type=int, default=12_000_000, help="env-steps")
    cli.add_argument(
        "--street-steps",
        type=int,
        default=6_000_000,
        help="env-steps of the teachers of streets-*, half of long-streets-*",
    )
    cli.add_argument("--arm-steps", type=int, default=10_000_000, help="env-steps of teacher-arm-* and student-arm-*")
    cli.add_argument("--paper-steps", type=int, default=4_587_520, help="env-steps; a multiple of 131,072")
    cli.add_argument("--scaling-steps", type=int, default=6_000_000, help="env-steps, rounded up to rollouts")
    cli.add_argument("--task-steps", type=int, default=40_000_000, help="env-steps of a task's teacher")
    cli.add_argument("--embodiment-steps", type=int, default=1_400_000, help="env-steps of each robot of embodiment-*")
    cli.add_argument("--gait-steps", type=int, default=300_000_000, help="env-steps of gait-*")
    cli.add_argument("--gait-preset", default="fast", help="of the training and the environment of gait-*")
    cli.add_argument("--gait-trials", type=int, default=100, help="trials of each kind of gait-*")
    cli.add_argument("--gait-processes", type=int, default=4, help="that judge a gait of gait-*")
    cli.add_argument("--imitation", type=int, default=320, help="iterations of a student")
    cli.add_argument("--ppo", type=int, default=200, help="iterations of PPO after it")
    cli.add_argument(
        "--samples", type=int, default=8_000_000, help="env-steps of imitation-*-ppo-* and imitation-ppo-*"
    )
    cli.add_argument("--go2", type=int, default=100, help="iterations of the Go2's student")
    cli.add_argument(
        "--env",
        type=option,
        nargs="+",
        default=[],
        metavar="KEY=JSON",
        help="environment options of all trainings, as 'impl=\"warp\"'",
    )
    cli.add_argument("--list", action="store_true", help="print the commands, run nothing")
    cli.add_argument("--add", action="store_true", help="add the rows of all results to benchmarks/scores")
    return cli.parse_args()


def main() -> int:
    args = arguments()
    args.out = args.out.absolute()
    if args.add:
        return add_rows(args)
    jobs = chosen(args)
    if args.list:
        for job in jobs:
            print(shlex.join(("python", *job.command)))
        return 0
    args.out.mkdir(parents=True, exist_ok=True)
    return Campaign(args, jobs).run()


if __name__ == "__main__":
    sys.exit(main())
