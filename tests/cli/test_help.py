"""Every option of every command says what it is and the form of its value, as its printed help shows."""

import re

import pytest

from urbanverse_mjx.cli import main as cli

#: Words that `gen` takes apart itself, so that its help does not list them as subcommands.
OF_GEN = ("batch", "weights", "import")


def help_of(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    capsys.readouterr()
    with pytest.raises(SystemExit) as ended:
        cli.main([*words, "--help"])
    assert ended.value.code == 0
    return capsys.readouterr().out.translate(str.maketrans("│╭╮╰╯─", "      "))


def subcommands(text: str) -> list[str]:
    found = re.search(r"\{([\w,-]+)\}", text.splitlines()[0])
    return found[1].split(",") if found and "subcommands" in text else []


def entries(text: str) -> list[tuple[str, str]]:
    """(option with its metavar, its help) of the lists of positional arguments and options."""
    body = text.partition("\n\n")[2].partition("subcommands")[0]
    found: list[tuple[str, str]] = []
    for line in body.splitlines():
        if re.match(r" {1,3}(--?[a-z]|[A-Z]{2}|[{\[])", line):
            name, _, says = line.strip().partition("  ")
            found.append((name, says.strip()))
        elif found and line.startswith("    "):
            name, says = found[-1]
            found[-1] = (name, f"{says} {line.strip()}".strip())
    return found


@pytest.mark.parametrize("command", sorted(cli.COMMANDS))
def test_every_option_has_a_help_text(
    command: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    text = help_of(capsys, command)
    others = OF_GEN if command == "gen" else subcommands(text)
    texts = [(command, text), *((f"{command} {word}", help_of(capsys, command, word)) for word in others)]
    silent, bare, number = [], [], 0
    for name, shown in texts:
        for option, says in entries(shown):
            number += 1
            if not re.sub(r"\((default: .*|required|repeatable|sets: .*)\)$", "", says).strip():
                silent.append(f"{name}: {option}")
            # STR, or the name of the option once more, is no hint to the form of a text; None is no value of any.
            form = re.search(r"--([\w-]+) (\S+)$", option)
            repeated = form is not None and form[2] == form[1].replace("-", "_").upper()
            if re.search(r"\bSTR\b|\{None\b", option) or repeated:
                bare.append(f"{name}: {option}")
            if "JSON" in says.partition(" ")[0] and not option.endswith(" JSON"):
                bare.append(f"{name}: {option}")
    assert number >= len(texts), "at least --help of each was read"
    assert (silent, bare) == ([], [])


def test_the_help_names_every_scripted_policy_that_the_error_offers(capsys: pytest.CaptureFixture[str]) -> None:
    text = help_of(capsys, "evaluate")
    assert cli.main(["evaluate", "no_such_policy"]) == 2
    offered = re.search(r"or one of (.*?);", capsys.readouterr().err)
    assert offered
    for name in offered[1].split(", "):
        assert name in text
