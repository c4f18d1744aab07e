"""StreetQA: questions about rendered streets with exact answers, for vision-language models.

    python -m benchmarks.streetqa make --out FOLDER [--seed 0]
    python -m benchmarks.streetqa blind --data FOLDER --form mc
    python -m benchmarks.streetqa perception --data FOLDER --form mc --out FILE.jsonl
    python -m benchmarks.streetqa ask --data FOLDER --form mc --out FILE.jsonl
    python -m benchmarks.streetqa score --data FOLDER --form mc --answers FILE.jsonl
    python -m benchmarks.streetqa check --data FOLDER
    python -m benchmarks.streetqa sheet --data FOLDER --out FILE.png

`make` renders views of streets of the test split (CraftBench, AutoBench) and of training streets (procedural), writes
5,000 questions on them, and files for LLaVA and lmms-eval; the sets must be built (`urbanverse scene library NAME`). An
interrupted run continues. `blind` scores answers from the words of questions alone, `perception` those of the
perception model of this package, `ask` those of a model behind an OpenAI-compatible endpoint (URBANVERSE_VISION_URL,
_MODEL, _KEY), and `score` those of a file of JSON lines {"question_id", "text"}. `check` compares answers with stock
MuJoCo's renderer and with polygons; `sheet` shows views with their questions.
"""

import argparse
import collections
import json
import pathlib
import random
import sys
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from PIL import Image, ImageDraw

from benchmarks.lib import tables
from benchmarks.lib.streetqa import balance, blind, endpoint, formats, scoring, signs, templates, views
from benchmarks.lib.streetqa.facts import Facts
from urbanverse_mjx import settings
from urbanverse_mjx.capture.street import StreetGrid
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.scene import library

#: Part of a data set -> sets of the library, the split of their scenes, and how many scenes and views of each.
PARTS = {
    "test": (("craftbench", "test", 12, 28), ("autobench", "test", 10, 28)),
    "train": (("procedural", "train", 80, 6),),
}
#: Questions of each part.
WANTED = {"test": 3000, "train": 2000}


def make(out: pathlib.Path, seed: int, wanted: Mapping[str, int], parts: Mapping[str, Any] = PARTS) -> dict[str, Any]:
    """Renders views and writes the questions; returns what was made.

    Raises:
      ValidationError: a set is not built.
    """
    questions: list[balance.Question] = []
    for part, rows in parts.items():
        found: list[templates.Candidate] = []
        for name, split, scenes, per_scene in rows:
            bank = SceneBank.load(library.bank_path(name))
            folder = library.folder(name) / library.SCENES
            sign = signs.Signs(lambda scene, folder=folder: folder / scene / "layout.json")
            chosen = [k for k in range(bank.num_scenes) if bank.meta["splits"][k] == split][:scenes]
            streets: dict[str, StreetGrid] = {}
            for view in views.make_views(bank, chosen, part, per_scene, seed, out, _progress):
                facts = Facts.of(view, bank, out / formats.IMAGES / f"{view.name}.png", streets)
                found += templates.candidates(facts, sign)
        questions += balance.choose(found, wanted[part], seed)
    record = {"seed": seed, "sets": {part: [list(row) for row in rows] for part, rows in parts.items()}}
    digest = formats.write(out, questions, record)
    counts = collections.Counter(f"{q.split} {q.template}" for q in questions)
    return {"questions": len(questions), "hash": digest, "counts": dict(sorted(counts.items()))}


def _progress(name: str) -> None:
    print(name, file=sys.stderr, flush=True)


def _counted(done: int, total: int) -> None:
    if done % 50 == 0 or done == total:
        print(f"{done}/{total}", file=sys.stderr, flush=True)


def part_of(data: pathlib.Path, split: str) -> list[dict[str, Any]]:
    """Questions of a part of a data set.

    Raises:
      ValidationError: no data set, or no such part.
    """
    rows = formats.read(data)["questions"]
    known = sorted({row["split"] for row in rows})
    v.choice(split, "split", known)
    return [row for row in rows if row["split"] == split]


def blind_scores(data: pathlib.Path, split: str, form: str) -> dict[str, Any]:
    """Scores of guesses from words alone: by template, and by template and subject, fitted to the train part; and by
    both fitted to the part itself, which no guess from these words can exceed much."""
    docs, train = part_of(data, split), part_of(data, "train")
    fits = {
        "template": blind.Blind(train, by_subject=False),
        "subject": blind.Blind(train),
        "subject, fitted to itself": blind.Blind(docs),
    }
    found: dict[str, Any] = {n: scoring.score(docs, blind.answers(docs, form, b), form) for n, b in fits.items()}
    return {"chance": scoring.chance(docs) if form == "mc" else None, **found}


def perceive(data: pathlib.Path, split: str, form: str, out: pathlib.Path) -> dict[str, str]:
    """Writes the answers of the perception model."""
    from benchmarks.lib.streetqa.perceiving import Perceiving
    from urbanverse_mjx.distillation.perception_model.inference import PerceptionModel

    model = Perceiving(PerceptionModel.load(), blind.Blind(part_of(data, "train")))
    docs = sorted(part_of(data, split), key=lambda doc: (doc["image"], doc["question_id"]))
    answers = {doc["question_id"]: model.answer(doc, str(data / doc["image"]), form) for doc in docs}
    rows = [{"question_id": k, "text": text, "model_id": "urbanverse_mjx"} for k, text in sorted(answers.items())]
    formats.write_lines(out, rows)
    return answers


def check(data: pathlib.Path, split: str, per_scene: int) -> dict[str, Any]:
    """Compares answers with `streetqa.checking`.

    Args:
      per_scene: views of each scene.

    Returns:
      template -> [agreeing, checked], and "differ": ids of the others.
    """
    from benchmarks.lib.streetqa import checking

    body = formats.read(data)
    folder_of = {name: library.folder(name) / library.SCENES for rows in body["sets"].values() for name, *_ in rows}
    by_scene: dict[str, dict[str, list[dict[str, Any]]]] = collections.defaultdict(
        lambda: collections.defaultdict(list)
    )
    for doc in body["questions"]:
        if doc["split"] == split:
            by_scene[doc["scene"]][doc["image"]].append(doc)
    counts: dict[str, list[int]] = collections.defaultdict(lambda: [0, 0])
    differ = []
    for scene, images in sorted(by_scene.items()):
        place = next(f / scene for f in folder_of.values() if (f / scene).is_dir())
        stock = checking.StockMujoco(place, views.HEIGHT, views.WIDTH)
        for image in sorted(images)[:per_scene]:
            view = views.View.load(data / formats.LABELS / f"{pathlib.Path(image).stem}.npz")
            drawn = stock.images(view)
            for doc in images[image]:
                agrees = checking.check(doc, view, stock, drawn)
                if agrees is not None:
                    counts[doc["template"]][0] += bool(agrees)
                    counts[doc["template"]][1] += 1
                    if not agrees:
                        differ.append(doc["question_id"])
        stock.close()
        _progress(scene)
    return {"agree": dict(sorted(counts.items())), "differ": differ}


def sheet(data: pathlib.Path, out: pathlib.Path, seed: int, count: int = 12) -> list[dict[str, Any]]:
    """Writes an image of `count` random views with their questions and answers; returns those questions."""
    docs = part_of(data, "test")
    images = random.Random(seed).sample(sorted({doc["image"] for doc in docs}), count)
    tiles, shown = [], []
    for image in images:
        own = [doc for doc in docs if doc["image"] == image]
        shown += own
        tile = Image.new("RGB", (views.WIDTH * 2, views.HEIGHT + 20), "white")
        tile.paste(Image.open(data / image).convert("RGB"), (0, 20))
        pen = ImageDraw.Draw(tile)
        for k, doc in enumerate(own[:22]):
            text = f"{doc['template']}: {doc['question'][-62:]} -> {doc['answer']} {doc['number'] or ''}"
            pen.text((views.WIDTH + 4, 4 + 15 * k), text, fill="black")
        tiles.append(np.asarray(tile))
    rows = [np.concatenate(tiles[k : k + 2], 1) for k in range(0, len(tiles), 2)]
    v.write_atomically(out, lambda path: Image.fromarray(np.concatenate(rows)).save(path, "PNG"))
    return shown


def table(scores: Mapping[str, Mapping[str, Any]]) -> str:
    """Scores as Markdown."""
    rows = []
    for name, row in scores.items():
        interval = f"{row['low']}-{row['high']}" if "low" in row else ""
        rows.append([name, f"{row['accuracy']}", interval, str(row["n"])])
    return tables.markdown(["template", "accuracy %", "95 %", "questions"], rows)


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.streetqa", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("command", choices=("make", "blind", "perception", "ask", "score", "check", "sheet"))
    parser.add_argument("--data", type=pathlib.Path, help="folder of the data set")
    parser.add_argument("--out", type=pathlib.Path, help="folder or file to write")
    parser.add_argument("--seed", type=int, default=0, help="of views, questions and options")
    parser.add_argument("--split", default="test", help="part of the data set: test or train")
    parser.add_argument("--form", choices=formats.FORMS, default="mc", help="multiple choice, or free form")
    parser.add_argument("--answers", type=pathlib.Path, help="JSON lines with question_id and text")
    parser.add_argument("--jobs", type=int, default=4, help="requests at a time")
    parser.add_argument("--views", type=int, default=4, help="views of each scene that check looks at")
    a = parser.parse_args(argv)
    needed = {"make": ("out",), "score": ("data", "answers"), "blind": ("data",), "check": ("data",)}
    for name in needed.get(a.command, ("data", "out")):
        if getattr(a, name) is None:
            parser.error(f"{a.command}: found no --{name}; needed one; name a file or folder.")
    try:
        print(_run(a))
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror}; needed a place to write to; name another.", file=sys.stderr)
        return 2
    return 0


def _run(a: argparse.Namespace) -> str:
    if a.command == "make":
        return json.dumps(make(a.out, v.integer(a.seed, "--seed", 0), WANTED))
    if a.command == "blind":
        found = blind_scores(a.data, a.split, a.form)
        parts = [f"chance: {found.pop('chance')} %", *(f"{name}\n{table(rows)}" for name, rows in found.items())]
        return "\n\n".join(parts)
    if a.command == "check":
        return json.dumps(check(a.data, a.split, v.integer(a.views, "--views", 1)))
    if a.command == "sheet":
        return json.dumps({"questions": len(sheet(a.data, a.out, a.seed)), "out": str(a.out)})
    docs = part_of(a.data, a.split)
    if a.command == "perception":
        answers = perceive(a.data, a.split, a.form, a.out)
    elif a.command == "ask":
        place = settings.vision_endpoint()
        if place is None:
            raise v.fail("URBANVERSE_VISION_URL", "nothing", "the address of a vision model, such as http://host/v1")
        answers = endpoint.ask_all(place, a.data, docs, a.form, a.out, v.integer(a.jobs, "--jobs", 1, 64), _counted)
    else:
        answers = formats.read_answers(a.answers)
    return table(scoring.score(docs, answers, a.form))


if __name__ == "__main__":
    sys.exit(main())
