"""Files of a data set: its own, LLaVA's for training and evaluation, and a task of lmms-eval.

LLaVA: training files are lists of {"id", "image", "conversations": [{"from", "value"}, ...]}, <image> in the first
value (its docs/Finetune_Custom_Data.md); evaluation files have a line {"question_id", "image", "text"}, its
answers {"question_id", "text"} (llava/eval/model_vqa.py). lmms-eval: a YAML file per task beside a `utils.py`
(its docs/task_guide.md) and one JSON line per question.
"""

import json
import pathlib
from collections.abc import Sequence
from typing import Any

import yaml

from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.datatypes.hashing import content_hash

from . import lmms_eval_utils
from .balance import Question
from .colours import NAMES
from .lmms_eval_utils import prompt

SCHEMA = "urbanverse.streetqa/1"
QUESTIONS, IMAGES, LABELS, LLAVA, LMMS_EVAL = "questions.json", "images", "labels", "llava", "lmms_eval"
FORMS = ("mc", "free")


def document(question: Question) -> dict[str, Any]:
    """A question as a JSON object, as all formats and `lmms_eval_utils.right` use it."""
    pool = list(NAMES) if question.template == "colour" else list(question.options)
    if question.template == "stands_on":
        pool = ["the pavement", "the road", "a crosswalk"]
    return {
        "question_id": question.id,
        "image": f"{IMAGES}/{question.view}.png",
        "scene": question.scene,
        "split": question.split,
        "template": question.template,
        "subject": question.subject,
        "question": question.text,
        "options": list(question.options),
        "answer": question.answer,
        "letter": question.letter,
        "number": question.number,
        "pool": pool,
        "facts": question.facts,
    }


def write(folder: pathlib.Path, questions: Sequence[Question], record: dict[str, Any]) -> str:
    """Writes all files but images and labels; returns the hash of the questions.

    Args:
      folder: of the data set.
      record: what it was made from; kept in `questions.json`.
    """
    docs = [document(q) for q in questions]
    digest = content_hash(docs)
    body = {"schema": SCHEMA, **record, "hash": digest, "questions": docs}
    v.write_json(folder / QUESTIONS, body)
    for split in sorted({doc["split"] for doc in docs}):
        rows = [doc for doc in docs if doc["split"] == split]
        for form in FORMS:
            v.write_json(folder / LLAVA / f"{split}_{form}.json", [conversation(doc, form) for doc in rows])
            lines = [{"question_id": d["question_id"], "image": d["image"], "text": prompt(d, form)} for d in rows]
            write_lines(folder / LLAVA / f"{split}_{form}_questions.jsonl", lines)
        write_lines(folder / LMMS_EVAL / f"{split}.jsonl", rows)
    source = pathlib.Path(lmms_eval_utils.__file__).read_text(encoding="utf-8")
    v.write_atomically(folder / LMMS_EVAL / "utils.py", lambda p: p.write_text(source, encoding="utf-8"))
    for form in FORMS:
        text = task(form)
        v.write_atomically(folder / LMMS_EVAL / f"streetqa_{form}.yaml", lambda p, text=text: p.write_text(text))
    return digest


def conversation(doc: dict[str, Any], form: str) -> dict[str, Any]:
    """A sample of LLaVA's training format."""
    answer = doc["letter"] if form == "mc" else doc["answer"]
    if form == "free" and doc["number"] is not None:
        answer = f"{doc['number']:.1f} m"
    turns = [{"from": "human", "value": f"<image>\n{prompt(doc, form)}"}, {"from": "gpt", "value": answer}]
    return {"id": doc["question_id"], "image": doc["image"], "conversations": turns}


class _Function(str):
    """Name of a function in lmms-eval's YAML."""


def task(form: str) -> str:
    """YAML of a task of lmms-eval; paths are relative to the data set's folder, from which lmms-eval is started."""
    dumper = type("Dumper", (yaml.SafeDumper,), {})
    dumper.add_representer(_Function, lambda d, name: d.represent_scalar("!function", str(name)))
    body = {
        "task": f"streetqa_{form}",
        "dataset_path": "json",
        "dataset_kwargs": {"data_files": {"test": f"{LMMS_EVAL}/test.jsonl"}},
        "test_split": "test",
        "output_type": "generate_until",
        "doc_to_visual": _Function("utils.doc_to_visual"),
        "doc_to_text": _Function(f"utils.doc_to_text_{form}"),
        "doc_to_target": "letter" if form == "mc" else "answer",
        "process_results": _Function(f"utils.process_results_{form}"),
        "generation_kwargs": {"max_new_tokens": 16, "temperature": 0, "do_sample": False},
        "metric_list": [{"metric": "streetqa_accuracy", "aggregation": "mean", "higher_is_better": True}],
        "metadata": [{"version": 1.0}],
    }
    return yaml.dump(body, Dumper=dumper, sort_keys=False)


def write_lines(path: pathlib.Path, rows: Sequence[Any]) -> None:
    """Writes JSON lines."""
    text = "".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows)
    v.write_atomically(path, lambda p: p.write_text(text, encoding="utf-8"))


def read(folder: pathlib.Path) -> dict[str, Any]:
    """Reads `questions.json`.

    Raises:
      ValidationError: no such file, another schema, or questions that were changed.
    """
    path = folder / QUESTIONS
    body = v.read_json(path, "StreetQA data set")
    if not isinstance(body, dict) or body.get("schema") != SCHEMA:
        raise v.fail(str(path), "another file", f"a data set with schema {SCHEMA!r}", "make one with `make`")
    if content_hash(body["questions"]) != body["hash"]:
        raise v.fail(str(path), "questions with another hash than recorded", "those that were made", "make it again")
    return body


def read_answers(path: pathlib.Path) -> dict[str, str]:
    """Question id -> answer, of lines {"question_id", "text"} as LLaVA writes them.

    Raises:
      ValidationError: no such file, or a line that is none.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise v.fail(str(path), "no file of text", "answers as JSON lines", "name another file") from error
    found = {}
    for number, line in enumerate(lines, 1):
        row = v.parse_json(line.encode(), f"{path}: line {number}") if line.strip() else None
        if row is None:
            continue
        if not isinstance(row, dict) or not isinstance(row.get("text"), str) or "question_id" not in row:
            raise v.fail(f"{path}: line {number}", v.show(row), 'an object with "question_id" and "text"')
        found[str(row["question_id"])] = row["text"]
    return found
