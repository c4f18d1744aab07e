"""Writes the page of a study: one HTML file beside a folder of images and videos, without server or network."""

import json
import pathlib
from typing import Any

from ..datatypes import validation as v
from ..datatypes.hashing import content_hash
from .answers import COLUMNS
from .plan import CATCHES, CHOICES, CRITERIA, StudyPlan

PAGE, MEDIA, KEY = "index.html", "media", "key.json"
CONSENT = (
    "You take part in a study of computer-made streets. You will compare images and rate videos. It takes about 30 "
    "minutes. Taking part is voluntary; you may stop at any time by closing the page, and nothing is kept. The file of "
    "your answers holds them, how long each took, and a random number instead of your name."
)


def write_page(
    plan: StudyPlan, folder: pathlib.Path, title: str = "Streets", consent: str = CONSENT, contact: str = ""
) -> pathlib.Path:
    """Writes `index.html`, and beside the folder's `media` the key, which must stay with the researcher.

    Args:
      folder: of the page; its files `media/<name>` must exist.
      consent: what participants agree to before they start. contact: who answers questions.

    Raises:
      ValidationError: a file that a trial shows is missing.
    """
    missing = sorted({f for t in plan.trials for f in t.files if not (folder / MEDIA / f).is_file()})
    if missing:
        raise v.fail(str(folder / MEDIA), f"no file {missing[0]}", "every file of the study", "render it first")
    trials = [{"id": t.id, "kind": t.kind, "files": t.files, "catch": bool(t.catch)} for t in plan.trials]
    body: dict[str, Any] = {
        "study": content_hash(plan.to_json())[:12],
        "title": title,
        "consent": consent,
        "contact": contact,
        "trials": trials,
        "criteria": CRITERIA,
        "choices": CHOICES,
        "catches": CATCHES,
        "columns": COLUMNS,
    }
    # "</" would end the script element that holds the data.
    data = json.dumps(body, ensure_ascii=False).replace("</", "<\\/")
    template = (pathlib.Path(__file__).parent / "page.html").read_text(encoding="utf-8")
    page = template.replace("__DATA__", data)
    v.write_json(folder.parent / f"{folder.name}-{KEY}", plan.to_json())
    return v.write_atomically(folder / PAGE, lambda path: path.write_text(page, encoding="utf-8"))
