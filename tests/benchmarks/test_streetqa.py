"""benchmarks.streetqa: balanced questions, reading and scoring of answers, files, blind and endpoint answers."""

import base64
import collections
import http.server
import importlib.util
import json
import pathlib
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import yaml
from PIL import Image

from benchmarks import streetqa
from benchmarks.lib.streetqa import balance, blind, endpoint, formats, scoring
from benchmarks.lib.streetqa.lmms_eval_utils import LETTER_PROMPT, right
from benchmarks.lib.streetqa.templates import Candidate
from urbanverse_mjx.assets.importing import vision
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.settings import VisionEndpoint


def candidates(split: str, skew: float, count: int = 400, seed: int = 0) -> list[Candidate]:
    """Questions whose subject tells the answer in a share `skew` of cases, and colours of unequal frequency."""
    rng = np.random.default_rng(seed)
    found = []
    for k in range(count):
        subject = ("bench", "car", "tree")[k % 3]
        usual = "no" if subject == "bench" else "yes"
        answer = usual if rng.random() < skew else ("yes" if usual == "no" else "no")
        view, scene = f"s{k % 7}_{k % 40:02d}", f"s{k % 7}"
        found.append(Candidate(view, scene, split, "exists", subject, f"Is there a {subject}?", answer, ("yes", "no")))
        colour = rng.choice(["red", "blue", "grey", "green", "white"], p=[0.5, 0.2, 0.15, 0.1, 0.05])
        found.append(Candidate(view, scene, split, "colour", subject, f"Colour of {subject}?", colour, ("any colour",)))
    return found


def docs_of(questions: list[balance.Question]) -> list[dict[str, Any]]:
    return [formats.document(q) for q in questions]


def test_no_answer_is_more_frequent_than_the_next_one_for_any_subject() -> None:
    found = balance.choose(candidates("test", 0.9), 10_000, 0)
    for subject in ("bench", "car", "tree"):
        count = collections.Counter(q.answer for q in found if q.template == "exists" and q.subject == subject)
        assert count["yes"] == count["no"] > 0
    colours = collections.Counter(q.answer for q in found if q.template == "colour")
    assert max(colours.values()) <= 2 * sorted(colours.values())[len(colours) // 2]


def test_the_words_of_balanced_questions_tell_nothing_and_of_others_much() -> None:
    """The same guesser reaches 90 % where nothing is balanced, and about chance where it is."""
    raw = [
        balance.Question(
            str(k), c.view, c.scene, c.split, c.template, c.subject, c.question, ("yes", "no"), c.answer, None, {}
        )
        for k, c in enumerate(candidates("test", 0.9))
        if c.template == "exists"
    ]
    guesser = blind.Blind(docs_of(raw))
    assert scoring.score(docs_of(raw), blind.answers(docs_of(raw), "mc", guesser), "mc")["all"]["accuracy"] > 85.0
    train = docs_of(balance.choose(candidates("train", 0.9, seed=1), 10_000, 0))
    test = docs_of(balance.choose(candidates("test", 0.9, seed=2), 10_000, 0))
    table = scoring.score(test, blind.answers(test, "mc", blind.Blind(train)), "mc")
    assert abs(table["exists"]["accuracy"] - 50.0) < 8.0
    assert abs(table["all"]["accuracy"] - scoring.chance(test)) < 8.0


def test_options_hold_the_answer_once_and_every_place_is_as_frequent() -> None:
    found = balance.choose(candidates("test", 0.6, 2000), 10_000, 3)
    letters = collections.Counter(q.letter for q in found if q.template == "colour")
    assert all(q.options.count(q.answer) == 1 and len(set(q.options)) == len(q.options) for q in found)
    total = sum(letters.values())
    assert len(letters) == 4
    # Four standard deviations of a binomial with a quarter each.
    assert all(abs(n / total - 0.25) < 4 * (0.25 * 0.75 / total) ** 0.5 for n in letters.values())


def test_the_seed_decides_the_questions() -> None:
    rows = candidates("test", 0.7)
    assert balance.choose(rows, 100, 5) == balance.choose(rows, 100, 5)
    assert balance.choose(rows, 100, 5) != balance.choose(rows, 100, 6)
    assert len(balance.choose(rows, 100, 5)) == 100


MC = {"template": "colour", "options": ["red", "dark grey", "a van"], "answer": "dark grey", "number": None, "pool": []}


@pytest.mark.parametrize(
    ("answer", "good"),
    [
        *[(text, True) for text in ("B", "b", "B.", "(B) dark grey", "Answer: B", "the dark grey", "Dark grey.")],
        *[(text, False) for text in ("A", "", "Because", "grey", "a dark grey or red", "D", "It is B or A")],
    ],
)
def test_letters_and_options_are_read(answer: str, good: bool) -> None:
    assert right(MC, answer, "mc") is good


def test_an_article_is_not_the_letter_a() -> None:
    assert right({**MC, "answer": "a van"}, "a van", "mc")
    assert not right({**MC, "answer": "red"}, "a van", "mc")


FREE = [
    ("count", "3", [], "three", True),
    ("count", "3", [], "There are 3 benches.", True),
    ("count", "3", [], "13", False),
    ("exists", "yes", [], "Yes, there is.", True),
    ("exists", "no", [], "There is no bench", False),
    ("colour", "grey", ["grey", "red"], "Gray", True),
    ("colour", "grey", ["grey", "red"], "red and grey", False),
    ("side", "left", ["left", "right"], "to the left", True),
    ("free_direction", "straight ahead", ["left", "straight ahead", "right"], "Straight", True),
    ("stands_on", "the pavement", ["the pavement", "the road", "a crosswalk"], "sidewalk", True),
    ("stands_on", "the road", ["the pavement", "the road", "a crosswalk"], "on a crosswalk", False),
    ("nearer", "the nearest car", ["the nearest car", "the bench"], "The car", True),
    ("nearer", "the street cabinet", ["the street cabinet", "the bench"], "street cabinet", True),
    ("nearer", "the bench", ["the nearest car", "the bench"], "car", False),
    ("text", "NO PARKING", [], "No parking.", True),
    ("text", "STOP", [], "SHOP", False),
]


@pytest.mark.parametrize(("template", "answer", "pool", "said", "good"), FREE)
def test_free_answers_are_read(template: str, answer: str, pool: list[str], said: str, good: bool) -> None:
    doc = {"template": template, "answer": answer, "pool": pool, "options": pool, "number": None}
    assert right(doc, said, "free") is good


@pytest.mark.parametrize(
    ("said", "good"), [("8 m", True), ("10 metres", True), ("10.1", False), ("about 800 cm", True), ("26 feet", True)]
)
def test_a_distance_is_right_within_a_quarter(said: str, good: bool) -> None:
    doc = {"template": "distance", "answer": "8 to 13 m", "pool": [], "options": [], "number": 8.0}
    assert right(doc, said, "free") is good
    assert not right(doc, "far away", "free")


def test_unanswered_questions_are_wrong_and_strange_answers_are_refused() -> None:
    docs = docs_of(balance.choose(candidates("test", 0.5), 60, 0))
    known = {doc["question_id"]: doc["letter"] for doc in docs[:45]}
    row = scoring.score(docs, known, "mc")["all"]
    assert (row["accuracy"], row["unanswered"], row["n"]) == (75.0, 15, 60)
    assert row["low"] < 75.0 < row["high"]
    with pytest.raises(ValidationError, match="one to 'other'"):
        scoring.score(docs, {"other": "A"}, "mc")
    with pytest.raises(ValidationError, match="no questions"):
        scoring.score([], {}, "mc")


@pytest.fixture
def data(tmp_path: pathlib.Path) -> pathlib.Path:
    """A data set of 40 + 40 questions with images of one colour."""
    questions = [q for split in ("test", "train") for q in balance.choose(candidates(split, 0.6), 40, 0)]
    formats.write(tmp_path, questions, {"seed": 0, "sets": {}})
    (tmp_path / "images").mkdir()
    for number, view in enumerate(sorted({q.view for q in questions})):
        Image.new("RGB", (48, 32), (number, 9, 200)).save(tmp_path / "images" / f"{view}.png")
    return tmp_path


def test_llava_files_pair_each_question_with_its_image_and_answer(data: pathlib.Path) -> None:
    docs = {doc["question_id"]: doc for doc in streetqa.part_of(data, "train")}
    samples = json.loads((data / "llava" / "train_mc.json").read_text())
    assert {sample["id"] for sample in samples} == set(docs)
    for sample in samples:
        doc, (human, model) = docs[sample["id"]], sample["conversations"]
        assert set(sample) == {"id", "image", "conversations"}
        assert (data / sample["image"]).is_file()
        assert [human["from"], model["from"]] == ["human", "gpt"]
        assert human["value"].startswith(f"<image>\n{doc['question']}\nA. ")
        assert human["value"].endswith(LETTER_PROMPT)
        assert right(doc, model["value"], "mc")
    lines = (data / "llava" / "test_free_questions.jsonl").read_text().splitlines()
    assert all(set(json.loads(line)) == {"question_id", "image", "text"} for line in lines)
    assert len(lines) == 40


@pytest.mark.parametrize("form", formats.FORMS)
def test_the_lmms_eval_task_scores_by_its_own_copy(data: pathlib.Path, form: str) -> None:
    """The YAML's functions are found in the copied `utils.py`, as lmms-eval does it, and give what `scoring` gives."""
    path = data / "lmms_eval" / "utils.py"
    spec = importlib.util.spec_from_file_location("copied_utils", path)
    assert spec is not None
    assert spec.loader is not None
    utils = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(utils)

    class Loader(yaml.SafeLoader):
        pass

    def function(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> Any:
        module, _, name = loader.construct_scalar(node).partition(".")
        assert module == "utils"
        return getattr(utils, name)

    Loader.add_constructor("!function", function)
    task = yaml.load((data / "lmms_eval" / f"streetqa_{form}.yaml").read_text(), Loader)
    lines = (data / task["dataset_kwargs"]["data_files"][task["test_split"]]).read_text().splitlines()
    docs = [json.loads(line) for line in lines]
    (image,) = task["doc_to_visual"](docs[0])
    assert image.size == (48, 32)
    assert docs[0]["question"] in task["doc_to_text"](docs[0])
    answers = blind.answers(docs, form, blind.Blind(docs))
    metric = task["metric_list"][0]["metric"]
    flags = [task["process_results"](doc, [answers[doc["question_id"]]])[metric] for doc in docs]
    assert round(100 * sum(flags) / len(flags), 1) == scoring.score(docs, answers, form)["all"]["accuracy"]
    targets = [task["process_results"](doc, [str(doc[task["doc_to_target"]])])[metric] for doc in docs]
    assert targets == [1.0] * len(docs)


def test_changed_questions_are_refused(data: pathlib.Path) -> None:
    path = data / "questions.json"
    path.write_text(path.read_text().replace('"answer": "yes"', '"answer": "no"', 1))
    with pytest.raises(ValidationError, match="another hash"):
        formats.read(data)


class Model(http.server.ThreadingHTTPServer):
    """An endpoint that answers every question with what `reply` says, and keeps what it was asked."""

    def __init__(self, reply: Any) -> None:
        super().__init__(("127.0.0.1", 0), Asked)
        self.reply, self.asked = reply, []


class Asked(http.server.BaseHTTPRequestHandler):
    server: Model

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.server.asked.append((self.path, self.headers.get("Authorization"), body))
        status, reply = self.server.reply(body)
        self.send_response(status)
        self.end_headers()
        self.wfile.write(json.dumps(reply).encode())

    def log_message(self, format: str, *args: Any) -> None:
        pass


def said(text: str) -> dict[str, Any]:
    return {
        "id": "x",
        "object": "chat.completion",
        "choices": [{"index": 0, "message": {"role": "assistant", "content": text}}],
    }


@pytest.fixture
def served(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    monkeypatch.setattr(vision, "WAIT", 0.0)
    servers = []

    def start(reply: Any) -> Model:
        server = Model(reply)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        servers.append(server)
        monkeypatch.setenv("URBANVERSE_VISION_URL", f"http://127.0.0.1:{server.server_port}/v1")
        monkeypatch.setenv("URBANVERSE_VISION_MODEL", "model-1")
        monkeypatch.setenv("URBANVERSE_VISION_KEY", "the key")
        return server

    yield start
    for server in servers:
        server.shutdown()
        server.server_close()


def test_an_endpoint_is_shown_the_image_and_scored(
    data: pathlib.Path, tmp_path: pathlib.Path, served: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    """A model that knows the answers to all but the questions on colours, whose first request fails."""
    docs = streetqa.part_of(data, "test")
    known = {((data / doc["image"]).read_bytes(), formats.prompt(doc, "mc")): doc for doc in docs}
    failed: list[int] = []

    def reply(body: dict[str, Any]) -> tuple[int, Any]:
        if not failed:
            failed.append(1)
            return 503, {}
        image, text = body["messages"][0]["content"]
        sent = base64.b64decode(image["image_url"]["url"].removeprefix("data:image/png;base64,"))
        doc = known[sent, text["text"]]
        return 200, said(doc["letter"] if doc["template"] == "exists" else "I cannot tell")

    server, out = served(reply), tmp_path / "answers.jsonl"
    words = ["ask", "--data", str(data), "--form", "mc", "--out", str(out), "--jobs", "2"]
    assert streetqa.main(words) == 0
    table = capsys.readouterr().out
    assert "| exists | 100.0 |" in table
    assert "| colour | 0.0 |" in table
    path, authorization, body = server.asked[-1]
    assert (path, authorization, body["model"]) == ("/v1/chat/completions", "Bearer the key", "model-1")
    assert len(server.asked) == len(docs) + 1
    # A second run asks nothing that has an answer, and the first one's answers score alike by `score`.
    assert streetqa.main(words) == 0
    assert len(server.asked) == len(docs) + 1
    capsys.readouterr()
    assert streetqa.main(["score", "--data", str(data), "--form", "mc", "--answers", str(out)]) == 0
    assert capsys.readouterr().out == table


def test_a_failing_endpoint_keeps_the_answers_it_gave(data: pathlib.Path, tmp_path: pathlib.Path, served: Any) -> None:
    docs, out, given = streetqa.part_of(data, "test"), tmp_path / "answers.jsonl", []

    def reply(body: dict[str, Any]) -> tuple[int, Any]:
        given.append(1)
        return (200, said("A")) if len(given) <= 5 else (401, {})

    server = served(reply)
    place = VisionEndpoint(f"http://127.0.0.1:{server.server_port}/v1", "model-1")
    with pytest.raises(vision.VisionError, match="status 401"):
        endpoint.ask_all(place, data, docs, "mc", out, jobs=1)
    assert len(formats.read_answers(out)) == 5


@pytest.mark.parametrize("reply", [{}, {"choices": []}, {"choices": [{"message": {"content": None}}]}])
def test_an_unusable_reply_is_named(data: pathlib.Path, served: Any, reply: Any) -> None:
    server = served(lambda body: (200, reply))
    place = VisionEndpoint(f"http://127.0.0.1:{server.server_port}/v1", "model-1")
    with pytest.raises(vision.VisionError, match="reply"):
        endpoint.ask(place, data, streetqa.part_of(data, "test")[0], "mc")


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["ask", "--out", "x.jsonl"], "URBANVERSE_VISION_URL"),
        (["score", "--answers", "missing.jsonl"], "missing.jsonl"),
        (["blind", "--split", "validation"], "split: found 'validation'"),
    ],
)
def test_mistakes_end_with_a_sentence(
    data: pathlib.Path, words: list[str], text: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("URBANVERSE_VISION_URL", raising=False)
    assert streetqa.main([*words, "--data", str(data)]) == 2
    captured = capsys.readouterr()
    assert text in captured.err
    assert "Traceback" not in captured.err
