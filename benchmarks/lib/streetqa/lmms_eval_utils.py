"""How answers are read, and the functions of the lmms-eval tasks; a data set holds a copy of this file as `utils.py`.

It needs no package but Pillow, so that the copy works beside lmms-eval alone.
"""

import pathlib
import re
from collections.abc import Mapping, Sequence
from typing import Any

#: Sentences that LLaVA was trained to answer by a letter, and by a word or two (its docs/Evaluation.md).
LETTER_PROMPT = "Answer with the option's letter from the given choices directly."
SHORT_PROMPT = "Answer the question using a single word or phrase."
#: Relative error up to which a distance is right.
TOLERANCE = 0.25
_NUMBERS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
_SYNONYMS = {
    "gray": "grey",
    "sidewalk": "pavement",
    "footpath": "pavement",
    "footway": "pavement",
    "street": "road",
    "carriageway": "road",
    "roadway": "road",
    "crossing": "crosswalk",
    "straight": "straight ahead",
    "ahead": "straight ahead",
    "forward": "straight ahead",
    "silver": "grey",
}


def prompt(doc: Mapping[str, Any], form: str) -> str:
    """The text of a question; form: "mc" (with options and letters) or "free"."""
    if form == "free":
        return f"{doc['question']}\n{SHORT_PROMPT}"
    options = [f"{letter}. {text}" for letter, text in zip("ABCD", doc["options"], strict=False)]
    return "\n".join([doc["question"], *options, LETTER_PROMPT])


def plain(text: str) -> str:
    """Lower case, without punctuation and articles, with digits for numbers and one word for synonyms."""
    words = re.sub(r"[^\w\s.&+/%@$-]", " ", text.lower()).split()
    words = [word.strip(".-") for word in words]
    words = [word for word in words if word and word not in ("a", "an", "the")]
    return " ".join(str(_NUMBERS.index(word)) if word in _NUMBERS else word for word in words)


def _named(answer: str, names: Sequence[str]) -> str | None:
    """The one of several names that an answer contains, by whole words; None if none or more than one."""
    words = [word for word in plain(answer).split() if word != "nearest"]
    own, replaced = f" {' '.join(words)} ", f" {' '.join(_SYNONYMS.get(word, word) for word in words)} "
    short = {name: plain(name).removeprefix("nearest ") for name in names}
    found = [name for name in names if f" {short[name]} " in own or f" {short[name]} " in replaced]
    return found[0] if len(found) == 1 else None


def chosen(answer: str, options: Sequence[str]) -> str | None:
    """The option that an answer to a multiple-choice question names: by letter, or by the option's own words."""
    letters = "ABCD"[: len(options)]
    match = re.match(rf"^\s*(?:answer\s*(?:is)?\s*:?\s*)?[(\[]?([{letters}])(?:[)\].:,]|\s|$)", answer, re.IGNORECASE)
    # "a car" begins with an article, not with a letter.
    if match and not (match.group(1) == "a" and re.match(r"^\s*a\s+\w", answer)):
        return options[letters.index(match.group(1).upper())]
    same = [option for option in options if plain(option) == plain(answer)]
    return same[0] if len(same) == 1 else None


def right(doc: Mapping[str, Any], answer: str, form: str) -> bool:
    """Whether an answer is right.

    Args:
      doc: a question: "template", "options", "answer" and, for distances, "number" (m).
      answer: of a model. form: "mc" or "free".
    """
    if form == "mc":
        return chosen(answer, doc["options"]) == doc["answer"]
    template = doc["template"]
    if template == "distance":
        match = re.search(r"(\d+(?:[.,]\d+)?)\s*(cm|km|feet|foot|ft)?", answer.lower())
        if match is None:
            return False
        factor = {"cm": 0.01, "km": 1000.0, "feet": 0.3048, "foot": 0.3048, "ft": 0.3048}.get(match.group(2), 1.0)
        given = float(match.group(1).replace(",", ".")) * factor
        return abs(given - doc["number"]) <= TOLERANCE * doc["number"]
    if template == "count":
        match = re.search(r"\d+", plain(answer))
        return match is not None and match.group() == doc["answer"]
    if template in ("exists", "reach", "right_of_way"):
        words = plain(answer).split()
        return bool(words) and words[0] == doc["answer"]
    if template == "text":
        return plain(answer) == plain(doc["answer"])
    return _named(answer, doc["pool"]) == doc["answer"]


def doc_to_visual(doc: Mapping[str, Any]) -> list[Any]:
    """The image of a question, below the folder that holds this file's folder."""
    from PIL import Image

    return [Image.open(pathlib.Path(__file__).resolve().parent.parent / doc["image"]).convert("RGB")]


def doc_to_text_mc(doc: Mapping[str, Any], lmms_eval_specific_kwargs: Any = None) -> str:
    return prompt(doc, "mc")


def doc_to_text_free(doc: Mapping[str, Any], lmms_eval_specific_kwargs: Any = None) -> str:
    return prompt(doc, "free")


def process_results_mc(doc: Mapping[str, Any], results: Sequence[str]) -> dict[str, float]:
    return {"streetqa_accuracy": float(right(doc, results[0], "mc"))}


def process_results_free(doc: Mapping[str, Any], results: Sequence[str]) -> dict[str, float]:
    return {"streetqa_accuracy": float(right(doc, results[0], "free"))}
