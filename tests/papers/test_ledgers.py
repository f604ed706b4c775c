"""Every equation of the papers has a computed verdict, which one slip in a formula would change."""

import math
import random
import re
from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property
from xml.etree import ElementTree

import numpy as np
import pytest
from ledger_mutations import say_the_same, slips
from refusals import refuses
from sample_sizes import sampled

from percept_obs import cli, papers
from percept_obs.checking.slips import symbols_in
from percept_obs.papers import CHWA2019, INABA2005, MA2005, NAMED, Ledger, Verdict, ma2005
from percept_obs.papers.entries import Known as How
from percept_obs.papers.mathml import shown


@dataclass
class Known:
    """A paper's ledger, how many equations the paper numbers, and how many slips there are at least."""

    ledger: Ledger
    numbered: int
    slips: int

    @property
    def formulas_that_hold(self):
        return [entry for entry in self.ledger.entries if entry.expected == Verdict.HOLDS and entry.typed]

    @cached_property
    def letters(self):
        """All symbols that a slip may put in the place of another one."""
        return set().union(*(symbols_in(formula) for entry in self.ledger.entries for formula in entry.printed))


PAPERS = {
    "Ma": Known(MA2005, 40, 3000),
    "Inaba": Known(INABA2005, 24, 1000),
    "Chwa": Known(CHWA2019, 37, 1000),
}
each_paper = pytest.mark.parametrize("known", PAPERS.values(), ids=PAPERS)


EVERY = 8
each_entry = pytest.mark.parametrize(
    "entry",
    [
        pytest.param(
            entry, id=f"{name} {entry.place}", marks=[pytest.mark.slow] * (k % EVERY > 0 or entry.known == How.RUNS)
        )
        for name, known in PAPERS.items()
        for k, entry in enumerate(known.ledger.entries)
    ],
)
"""Every entry; quick are a few of each paper, of those that nothing simulates."""


@each_paper
def test_every_number_has_one_entry_with_its_print_and_nearly_all_can_be_checked(known):
    numbered = [entry for entry in known.ledger.entries if entry.number]
    assert [entry.number for entry in numbered] == list(range(1, known.numbered + 1))
    assert all(entry.typed for entry in numbered)
    assert sum(entry.expected != Verdict.NOT_CHECKABLE for entry in numbered) >= 0.95 * known.numbered


@each_entry
def test_the_computed_verdict_is_the_recorded_one_and_comes_with_its_reasons(entry):
    """A misprint with what mends it, what is false or depends with numbers, all but what holds with a note."""
    assert entry.finding.verdict == entry.expected
    assert entry.agrees
    if entry.expected == Verdict.MISPRINT:
        assert entry.corrected != entry.printed
        assert entry.check(entry.corrected).verdict in (Verdict.HOLDS, Verdict.NOT_CHECKABLE)
    if entry.expected in (Verdict.FALSE, Verdict.DEPENDS):
        assert entry.finding.numbers
        assert all(map(math.isfinite, entry.finding.numbers.values()))
    assert entry.note or entry.expected == Verdict.HOLDS
    assert entry._repr_latex_().startswith(r"$\displaystyle \begin{gathered}")


@pytest.mark.slow
@each_paper
def test_every_entry_says_how_it_is_known(known):
    for entry in known.ledger.entries:
        assert entry.method
        assert entry.verdict.endswith(f"({entry.known})")
        assert entry.note or entry.known != How.RUNS
        if entry.known in (How.DEFINITION, How.NOT_REPRODUCED):
            assert entry.expected in (Verdict.HOLDS, Verdict.NOT_CHECKABLE)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("entry", "known"),
    [
        pytest.param(entry, known, id=f"{name} {entry.place}")
        for name, known in PAPERS.items()
        for entry in known.formulas_that_hold
    ],
)
def test_one_slip_in_a_formula_that_holds_is_noticed(entry, known):
    """A slip changes the verdict, unless what it makes is proven to say the same; ALL_SAMPLES=1 tries every slip."""
    changed = list(slips(entry.printed, known.letters))
    assert changed
    changed = random.Random(entry.place).sample(changed, sampled(1, len(changed)))
    unnoticed = [p for p in changed if entry.check(p).verdict == Verdict.HOLDS]
    different = [p for p in unnoticed if not say_the_same(p, entry.printed)]
    assert not different, different


@pytest.mark.slow
@each_paper
def test_there_are_many_slips(known):
    letters = known.letters
    assert sum(1 for entry in known.formulas_that_hold for _ in slips(entry.printed, letters)) > known.slips


@pytest.mark.slow
@each_paper
def test_a_ledger_is_a_table_with_all_formulas_and_entries_show_all_their_parts(known):
    ledger = known.ledger
    assert list(ledger.table["equation"]) == [entry.place for entry in ledger.entries]
    html = ledger._repr_html_()
    assert html.count("<tr>") == len(ledger.entries) + 1
    assert html.count("<math") == sum(len(entry.printed) for entry in ledger.entries)
    assert not re.findall(r"<mi>\w*(?:hat|dot|bar)</mi>", html)


def test_an_entry_shows_print_derivation_correction_verdict_and_reason():
    entry = MA2005[38]
    assert entry is MA2005["38"] is MA2005["(38)"]
    text, html = str(entry), entry._repr_html_()
    for part in ("print", "derivation", "correction", "verdict", "reason"):
        assert f"  {part}" in text
        assert f"<th>{part}" in html
    assert "dxi2 = wbar*P*xi1" in text
    assert "-P_11*w_11*xi1_11" in text
    assert "misprint (derived)" in text


def test_a_ledger_is_searched_by_words_in_any_column():
    found = MA2005.search("Misprint", "appendix")
    assert [entry.place for entry in found.entries][:3] == ["(37)", "(38)", "(39)"]
    assert all(entry.expected == Verdict.MISPRINT for entry in found.entries)
    assert {"figure 3", "gamma = 1"} <= {entry.place for entry in MA2005.search("seen in runs").entries}
    assert not MA2005.search("no such word").entries


def test_entries_are_found_in_all_papers_or_in_one():
    assert [len(ledger.entries) for ledger in papers.find([14])] == [1, 1, 1]
    (ledger,) = papers.find(["Figure 3", 4], "ma, chen")
    assert [entry.place for entry in ledger.entries] == ["(4)", "figure 3"]
    assert papers.find() == papers.LEDGERS


def test_a_page_holds_every_entry_and_needs_no_network():
    page = papers.page(papers.find([4]))
    assert page.count("<caption>(4)") == 3
    assert "http" not in page.replace("http://www.w3.org", "")


@pytest.fixture
def two_entries():
    return [Ledger("a paper", (MA2005["(4)"], replace(MA2005["(20)"], expected=Verdict.HOLDS)))]


def test_a_verdict_that_is_not_the_recorded_one_is_told(two_entries):
    assert not papers.judge(two_entries)
    assert "false as stated;" in papers.report(two_entries)
    assert "recorded: holds" in papers.report(two_entries)


def test_a_correction_that_mends_nothing_is_told():
    entry = MA2005["f1, f2"]
    assert entry.agrees
    assert not replace(entry, mends=("b1 -> b2",)).agrees


LINES = "# A\n## all\n### (1) | 1, I | says\n    {}\n{}"
test_a_text_that_is_no_ledger_is_refused_with_its_line = refuses(
    lambda formula, judged: Ledger.read(LINES.format(formula, judged), {"known": dict}).entries[0].finding,
    ("x = 1", "= known | fine", r"line 5 of the ledger, '= known \| fine', is not .*: 'fine' is not a valid Verdict"),
    ("x = 1\n### (2) | says", "= known", r"line 5 of the ledger, '### \(2\) \| says', is not"),
    ("x = 1", "= unknown", r"\(1\) is compared with 'unknown', and there is no such function"),
    ("x = ", "= known", "x ="),
)


def test_what_is_given_and_what_a_bound_drops_is_put_in():
    text = (
        LINES.format("x = y\n    x <= z\n    drops {}\n    given (2); {}", "given")
        + "\n### (2) | 1, I | b\n    x = 2 y"
    )
    for drops, given, verdict in (
        ("z - w", "y = w; x = w", "holds"),
        ("z", "y = w; x = w", "misprint"),
        ("z - w", "y = w", "misprint"),
    ):
        entry, _ = Ledger.read(text.format(drops, given), {}).entries
        assert entry.finding.verdict == verdict


test_what_is_not_found_is_told_with_what_is_near = refuses(
    lambda find: find(),
    (lambda: papers.find(["figure 33"]), r"there is no 'figure 33'; near to it are figure 3"),
    (lambda: papers.find(paper="Khalil"), r"no paper is called 'Khalil'; there are Inaba, .*; Ma, Chen"),
    (lambda: MA2005["(41)"], r"no entry '\(41\)'; it has \(1\), \(2\)"),
    (lambda: Ledger("a paper", (MA2005["(4)"], MA2005["(4)"])), "same place"),
    error=(ValueError, KeyError),
)


@pytest.mark.slow
def test_the_report_shows_every_entry_of_every_paper_in_120_columns_and_counts_verdicts(capsys):
    assert cli.main(["check"]) == 0
    report, last = capsys.readouterr().out.rsplit("\n\n", 1)
    assert re.match(rf"{sum(len(each.entries) for each in papers.LEDGERS)} judged in ", last)
    tables = report.split("\n\n\n")
    assert len(tables) == len(papers.LEDGERS)
    for ledger, table in zip(papers.LEDGERS, tables, strict=True):
        assert max(map(len, table.splitlines())) <= 120
        assert all(f"\n{entry.place[:10]}" in table for entry in ledger.entries)
        for of, column in ((Verdict, "expected"), (How, "known")):
            counts = Counter(getattr(entry, column) for entry in ledger.entries)
            assert ", ".join(f"{counts[each]} {each}" for each in of) in table.splitlines()


@pytest.mark.slow
@pytest.mark.parametrize("name", ma2005.OBSERVERS)
@pytest.mark.parametrize("period", [0.001, 0.02])
def test_figure_3_does_not_come_out_with_other_sampling_either(name, period):
    run = ma2005.followed(35, name, "y1 alone", 0, period)
    assert math.isinf(run.settling_time(0.05, *run.observer.form.hidden))
    assert len(run.resets)


@pytest.mark.parametrize(("place", "value"), [("(38) is stable", 1.366), ("(38)", None)])
def test_the_sign_that_38_lost_is_that_of_p_and_not_of_a(place, value):
    entry = MA2005[place]
    other = entry.check(tuple(line.xreplace({entry.letters["A"]: entry.letters["-A"]}) for line in entry.printed))
    assert other.verdict == Verdict.MISPRINT
    if value:
        assert other.numbers["largest real part for A = -1, P = 1/2"] == pytest.approx(value, abs=1e-3)


def test_the_mended_38_has_the_eigenvalues_of_a_damped_oscillation():
    slope = ma2005.reduced(MA2005[38].corrected, *ma2005.ONE)
    assert sorted(np.linalg.eigvals(slope), key=np.imag) == pytest.approx([-0.5 - 0.5j, -0.5 + 0.5j])


PARTS = {"msub": 2, "msup": 2, "mfrac": 2, "msubsup": 3, "mover": 2, "munder": 2}
"""Elements of MathML, and how many parts each has."""


@pytest.mark.slow
def test_every_formula_of_a_ledger_is_whole():
    for entry in (entry for ledger in NAMED.values() for entry in ledger.entries):
        for part in entry.parts.values():
            text = re.sub(r"&#?\w+;", "x", shown(part))
            tree = ElementTree.fromstring(f"<all>{text}</all>")
            torn = [node.tag for node in tree.iter() if len(node) != PARTS.get(node.tag, len(node))]
            assert torn == [], (entry.place, part)
