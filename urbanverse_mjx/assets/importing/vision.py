"""Sends four images to an OpenAI-compatible endpoint for annotation; nothing is sent unless one is configured."""

import base64
import json
import time
import urllib.error
import urllib.request
from collections.abc import Sequence
from typing import Any

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.settings import VisionEndpoint

from ..categories import ontology
from .annotation import checked

TIMEOUT = 120.0  # s for one answer
ANSWER_BYTES = 2**20
TRIES = 3
WAIT = 2.0  # s before the second try, doubled for each further one
AGAIN = (408, 409, 429, 500, 502, 503, 504)
PROMPT = """The four images show one 3-D object from its sides; image 0 is the side that its file calls the front,
images 1, 2 and 3 are seen from 90, 180 and 270 degrees counter-clockwise. Its file is called {name}. The
images have no scale. Answer with one JSON object and these fields only:
category (exactly one name of the list below), description (one sentence), description_view_0, description_view_1,
description_view_2, description_view_3 (a few words each), height, length, width (metres of the real object; length is
the longer ground side), materials (names, most first), materials_composition (shares that sum to 1), mass (kg),
frontView (0 to 3: the image that shows its front), quality (0 to 10), movable, receptacle, walkable, enterable,
support_surface (true or false), required_force (N to move it), friction_coefficient, bounciness, surface_roughness,
reflectivity (0 to 1), surface_hardness (soft, semi-soft, hard), surface_finish (rough, matte, smooth, glossy, sleek,
grippy), traversability (pass through, push through, obstacle), affordances, interactive_parts, colors (names),
asset_composition_type (single, group, scene).
Categories: {leaves}"""


class VisionError(ValidationError):
    """The endpoint gave no usable answer."""


def annotate(endpoint: VisionEndpoint, images: Sequence[bytes], name: str) -> tuple[dict[str, Any], list[str]]:
    """(fields under the official names, omitted fields with the reason).

    Args:
      images: four PNG files, views 0 to 3.
      name: of the source file, as a hint.

    Raises:
      VisionError: no answer, none in JSON, or one whose category is no leaf.
    """
    question = PROMPT.format(name=json.dumps(name[:120]), leaves=", ".join(ontology.categories()))
    content: list[dict[str, Any]] = [{"type": "text", "text": question}]
    for image in images:
        url = "data:image/png;base64," + base64.b64encode(image).decode()
        content.append({"type": "image_url", "image_url": {"url": url}})
    answer = post(
        endpoint,
        {
            "model": endpoint.model,
            "temperature": 0,
            "response_format": {"type": "json_object"},
            "messages": [{"role": "user", "content": content}],
        },
    )
    try:
        text = answer["choices"][0]["message"]["content"]
        raw = json.loads(text[text.index("{") : text.rindex("}") + 1])  # some models fence their JSON
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise VisionError("the endpoint's answer holds no JSON object of fields") from error
    fields, complaints = checked(raw, "answer")
    try:
        fields["category"] = ontology.guess_leaf(str(fields.get("category", "-")))
    except ontology.UnknownLabelError as error:
        raise VisionError(f"the endpoint's category {str(fields.get('category'))[:60]!r} is no leaf") from error
    fields["annotation_info"] = {"vision_llm": endpoint.model, "text_llm": None}
    return fields, complaints


def post(endpoint: VisionEndpoint, body: dict[str, Any]) -> Any:
    """The endpoint's answer to a request for a chat completion; temporary errors are retried.

    Raises:
      VisionError: no answer, or none in JSON.
    """
    headers = {"Content-Type": "application/json"}
    if endpoint.key:
        headers["Authorization"] = f"Bearer {endpoint.key}"
    request = urllib.request.Request(f"{endpoint.url}/chat/completions", json.dumps(body).encode(), headers)
    for attempt in range(TRIES):
        if attempt:
            time.sleep(WAIT * 2 ** (attempt - 1))
        try:
            with urllib.request.urlopen(request, timeout=TIMEOUT) as answer:
                return json.loads(answer.read(ANSWER_BYTES))
        except urllib.error.HTTPError as error:
            if error.code not in AGAIN or attempt == TRIES - 1:
                raise VisionError(f"the endpoint answered with status {error.code}") from error
        except (OSError, ValueError) as error:
            if attempt == TRIES - 1:
                raise VisionError(f"the endpoint cannot be reached or understood ({type(error).__name__})") from error
    raise AssertionError("unreachable")
