"""The study of Appendix B's units against the simulation: what is missing is run, and kept."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from cardiosurf.config import Loaded, load, overlay
from cardiosurf.config.scenario_file import read_scenario
from cardiosurf.discrete.play import Rule
from cardiosurf.errors import InputError
from cardiosurf.study.critical import Search, find_changes
from cardiosurf.study.discrete_game import Game, play_config
from cardiosurf.study.discrete_questions import (
    N_MAX,
    QUESTIONS,
    Asked,
    Packed,
    Played,
    Question,
)
from cardiosurf.study.question import parse_question
from cardiosurf.study.results import ASKED, Entry, Results, asked_hash, current
from cardiosurf.study.store import RunStore
from cardiosurf.study.threshold import find_threshold
from cardiosurf.study.threshold_plan import Plan, key_path, plan_levels, plan_search

SCAN = 9
GAMES = 7
"""Games that a search on a mesh begins with."""


@dataclass(frozen=True)
class Study:
    """Where the study's configs, runs and results are.

    Attributes
    ----------
    root : Path
        The project's folder, with ``configs`` and ``scenarios``.
    results : Results
        Where results are kept.
    folder : Path
        Where the runs are.
    say : callable
        Called with a line whenever something has been made.
    """

    root: Path
    results: Results
    folder: Path
    say: Callable[[str], object] = field(default=lambda line: None)

    def config(self, name: str, changes: Sequence[str] = ()) -> Loaded:
        """Return a config by its path, or that of ``scenario/case``.

        Raises
        ------
        InputError
            There is none, or it is wrong.
        """
        if name.endswith(".yaml"):
            return load(str(self.root / name), tuple(changes))
        scenario, case = name.split("/")
        file = read_scenario(self.root / "scenarios" / f"{scenario.replace('-', '_')}.yaml")
        for ready in file.cases():
            if ready.case.name == case:
                return overlay(ready.loaded, list(changes))
        raise InputError(name, "is no case", f"a case of {file.path}")

    def asked(self, question: Question) -> str:
        """Return the hash of what a question asks of the simulation and the units."""
        parts: list[Any] = [N_MAX, question.loads]
        for one in (question.simulated, question.units):
            if isinstance(one, Asked):
                parts += [self.config(one.config, one.set).sha256, asdict(one)]
            elif isinstance(one, Played):
                parts += [self.config(one.case).sha256, one.edge]
            elif isinstance(one, Packed):
                parts.append(one.answer.__name__)
            else:
                parts.append(str(one))
        return asked_hash(*parts)

    def entries(self) -> dict[str, Entry | None]:
        """Return the kept result of each question, None where it answers something else."""
        there = self.results.read("discrete")
        return {one.name: current(there.get(one.name), self.asked(one)) for one in QUESTIONS}


def update(study: Study, questions: Sequence[Question] = QUESTIONS) -> None:
    """Ask what has no current answer, and keep the answers.

    Parameters
    ----------
    study : Study
        Where all is.
    questions : sequence of Question
        Which of them.

    Raises
    ------
    InputError
        A config is wrong, or a folder cannot be written to.
    NumericalError
        A run broke down.
    """
    there = study.entries()
    for question in questions:
        if there[question.name] is not None:
            continue
        entry: Entry = {ASKED: study.asked(question), "simulated": _simulated(study, question)}
        entry["units"] = {f"{n_max:g}": _units(study, question, n_max) for n_max in N_MAX}
        study.results.keep("discrete", question.name, entry)
        study.say(f"{question.name}: asked")


def _simulated(study: Study, question: Question) -> dict[str, Any] | None:
    """Return the critical value that a question asks of the simulation; None if it is kept."""
    asked = question.simulated
    if not isinstance(asked, Asked):
        return None
    loaded = study.config(asked.config, asked.set)
    plan = Plan(
        loaded,
        key_path(asked.vary),
        plan_search(asked.between, asked.tolerance, scan=SCAN, workers=1),
        plan_levels(loaded, asked.edges),
        parse_question("conduction", [target.name for target in loaded.config.targets]),
    )
    found = find_threshold(plan, RunStore(study.folder)).to_json()
    return {key: found[key] for key in ("vary", "between", "changes", "levels")} | {
        "runs": len(found["runs"])
    }


def _units(study: Study, question: Question, n_max: float) -> dict[str, Any]:
    """Return the units' answer."""
    rule, asked = Rule(n_max=n_max), question.units
    if isinstance(asked, Packed):
        return {"value": round(asked.answer(rule), 3), "unit": asked.unit}
    if isinstance(asked, Played):
        loaded = study.config(asked.case, (f"mesh.edge_length={asked.edge}",))
        return _told(play_config(loaded.config, rule, loads=question.loads))
    return {
        "searches": [
            {"edge": edge, "changes": _critical(study, question, asked, (rule, edge))}
            for edge in asked.edges
        ]
    }


def _critical(
    study: Study, question: Question, asked: Asked, how: tuple[Rule, float]
) -> list[dict[str, Any]]:
    """Return all changes of the game's answer on one mesh."""
    rule, edge = how
    loaded = study.config(asked.config, (*asked.set, f"mesh.edge_length={edge}"))

    def ask(_: int, values: Sequence[float]) -> list[str]:
        configs = (overlay(loaded, [f"{asked.vary}={value!r}"]).config for value in values)
        return [_word(play_config(one, rule, loads=question.loads)) for one in configs]

    search = Search(*asked.between, asked.tolerance, scan=GAMES)
    found = [change.brackets[0] for change in find_changes(ask, (edge,), search)]
    return [asdict(bracket) for bracket in found if bracket is not None]


def _word(game: Game) -> str:
    """Return whether all targets conduct, as a threshold search asks."""
    conducts = all(target.verdict == "conduction" for target in game.targets)
    return "conduction" if conducts else "no conduction"


def _told(game: Game) -> dict[str, Any]:
    """Return what is kept of a game."""
    return {
        "targets": {one.name: one.verdict for one in game.targets},
        "failures": game.failures,
        "most_activations": game.most_activations,
        "ended": game.ended,
        "units": game.units,
    }
