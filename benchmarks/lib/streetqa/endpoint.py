"""Answers of any vision model behind an OpenAI-compatible endpoint."""

import base64
import concurrent.futures
import json
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from urbanverse_mjx.assets.importing.vision import VisionError, post
from urbanverse_mjx.settings import VisionEndpoint

from .formats import read_answers
from .lmms_eval_utils import prompt


def ask(endpoint: VisionEndpoint, folder: pathlib.Path, doc: Mapping[str, Any], form: str) -> str:
    """A model's answer to one question.

    Raises:
      VisionError: no answer, or none in text.
    """
    image = base64.b64encode((folder / doc["image"]).read_bytes()).decode()
    content = [
        {"type": "image_url", "image_url": {"url": f"data:image/png;base64,{image}"}},
        {"type": "text", "text": prompt(doc, form)},
    ]
    body = {"model": endpoint.model, "temperature": 0, "messages": [{"role": "user", "content": content}]}
    reply = post(endpoint, body)
    try:
        text = reply["choices"][0]["message"]["content"]
    except (KeyError, IndexError, TypeError) as error:
        raise VisionError("the endpoint's reply has no choices[0].message.content") from error
    if not isinstance(text, str):
        raise VisionError(f"the endpoint's reply has content of type {type(text).__name__}; needed text")
    return text


def ask_all(
    endpoint: VisionEndpoint,
    folder: pathlib.Path,
    docs: Sequence[Mapping[str, Any]],
    form: str,
    out: pathlib.Path,
    jobs: int = 4,
    progress: Callable[[int, int], None] = lambda *_: None,
) -> dict[str, str]:
    """Asks every question that `out` has no answer to, and appends each answer to it, so that a run can be continued.

    Args:
      folder: of the data set; out: JSON lines {"question_id", "text", "model_id"}; jobs: requests at a time.
      progress: called with the numbers of answers and of questions.

    Returns:
      question id -> answer, of all in `out`.

    Raises:
      VisionError: a request failed; answers so far are in `out`.
      ValidationError: `out` is no file of answers.
    """
    known = read_answers(out) if out.is_file() else {}
    missing = [doc for doc in docs if doc["question_id"] not in known]
    out.parent.mkdir(parents=True, exist_ok=True)
    with out.open("a", encoding="utf-8") as file, concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        running = {pool.submit(ask, endpoint, folder, doc, form): doc for doc in missing}
        try:
            for answered in concurrent.futures.as_completed(running):
                doc, text = running[answered], answered.result()
                row = {"question_id": doc["question_id"], "text": text, "model_id": endpoint.model}
                file.write(json.dumps(row, ensure_ascii=False) + "\n")
                file.flush()
                known[doc["question_id"]] = text
                progress(len(known), len(docs))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return known
