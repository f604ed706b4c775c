"""The exam's questions in versions: other numbers by a seed, with solutions that are computed anew."""

from __future__ import annotations

import contextlib
import doctest
import io
import re

from percept_obs.exercises.individual import with_numbers
from percept_obs.site import TEXTS
from percept_obs.validation import bar


def exam(seed: str) -> tuple[str, str]:
    """Return a version of the exam, in Markdown: the questions, and the questions with their solutions.

    Parameters
    ----------
    seed : str
        Name or number of the version; the same one gives the same exam on every machine.

    Examples
    --------
    >>> questions, solutions = exam("a")  # doctest: +SKIP
    """
    import yaml

    _, front, text = (TEXTS / "exam.md").read_text("utf-8").split("---\n", 2)
    title, *questions = re.split(r"^(?=\*\*\d+\.\*\*)", text, flags=re.MULTILINE)
    names: dict[str, object] = {}
    solved = [title.replace("# Exam questions", f"# Exam questions, version {seed}").lstrip()]
    for rules, question in zip(bar(yaml.safe_load(front)["versions"], "solving"), questions, strict=True):
        own = with_numbers(question, rules, seed, "exam")
        solved.append(_BLOCK.sub(lambda found: _run(found[0], names), own))
    asked = [re.sub(r"\n<details>.*?</details>\n", "", question, flags=re.DOTALL) for question in solved]
    return "".join(asked), "".join(solved)


_BLOCK = re.compile(r"(?<=```pycon\n).*?(?=```)", re.DOTALL)


def _run(block: str, names: dict[str, object]) -> str:
    """Run the examples of a solution, and return them with what they print."""
    lines = []
    for example in doctest.DocTestParser().get_examples(block):
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(compile(example.source, "exam", "single"), names)
        first, *rest = example.source.splitlines()
        lines += [f">>> {first}", *(f"... {line}" for line in rest), printed.getvalue().rstrip()]
    return "".join(f"{line}\n" for line in lines if line)
