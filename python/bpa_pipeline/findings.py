"""The findings of one campaign as data frames (docs/findings.md has every field)."""

from __future__ import annotations

from typing import Any

import pandas as pd


def _frame(name: str) -> property:
    def read(self: "Findings") -> pd.DataFrame:
        return pd.json_normalize(self.raw[name], max_level=0)

    return property(read, doc=f"`{name}` of the findings, a row an entry.")


class Findings:
    """What the residual search found in one campaign and diameter, or a pool. `raw` is the entry of `findings.json` as it is."""

    def __init__(self, raw: dict[str, Any], text: str, messages: list[str] | None = None) -> None:
        self.raw = raw
        #: What `pipeline summary` says of the campaign, in sentences.
        self.text = text
        self.messages = messages or []

    effects = _frame("effects")
    scatter = _frame("scatter")
    unexplained = _frame("unexplained")
    recording_errors = _frame("recording_errors")
    by_unit = _frame("by_unit")
    budget = _frame("budget")
    tested = _frame("tested")
    detection_limits = _frame("detection_limits")
    column_limits = _frame("column_limits")
    not_measurable = _frame("not_measurable")
    aliases = _frame("aliases")
    next_measurement = _frame("next_measurement")
    coefficients = _frame("coefficients")
    alternatives = _frame("alternatives")

    @property
    def campaign(self) -> str:
        """The campaign."""
        return self.raw["campaign"]

    @property
    def verdict(self) -> str:
        """`effect_found`, `none`, `unexplained` or `not_assessed`."""
        return self.raw["verdict"]

    @property
    def not_assessed(self) -> Any:
        """Why nothing could be said; only with the verdict `not_assessed`."""
        return self.raw["not_assessed"]

    @property
    def sizes(self) -> pd.DataFrame:
        """The numbers of the effects found, a row each: value with interval and unit, and how probable the effect is by chance."""
        kept = ("id", "acts_on", "p_familywise", "found_in_folds", "negligible")
        rows = []
        for effect in self.raw["effects"]:
            about = {name: effect[name] for name in kept}
            rows += [{**about, **number, "parameter": number["name"]} for number in effect["parameters"]]
        return pd.DataFrame(rows, columns=[*kept, "parameter", "value", "ci_low", "ci_high", "unit"])

    @property
    def errors(self) -> pd.DataFrame:
        """Errors before and after the effects, a row each, in `raw["unit"]`."""
        return pd.json_normalize([self.raw["before"], self.raw["after"]]).set_axis(["before", "after"])

    def __repr__(self) -> str:
        effects = ", ".join(effect["id"] for effect in self.raw["effects"]) or "no effect"
        return f"<Findings of {self.campaign}, {self.raw['diameter_mm']} mm: {self.verdict} ({effects})>"
