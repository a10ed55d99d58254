"""What do many lights cost, and what is it worth to choose among them by what they may send?

    python bench/many_lights.py [--places N] [--samples N] [--reference-samples N] [--device auto|cpu|cuda]

Light at places strewn evenly over ``builtin:lights``, a hall of 1,000 lamps:

- time per sample against the same hall under ten of the lamps: in a lightmap bake, along whole paths, and
  of next-event samples alone, where nothing hides what the choice among lamps costs;
- mean squared error against a converged reference at equal time, the light tree against choosing lights
  uniformly. Both estimators' references are compared first: they have to agree.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np
from numpy.typing import NDArray

from irradia.core import write_text_atomic
from irradia.core.provenance import source_commit
from irradia.scene.load import load_scene
from irradia.scene.types import Scene

if TYPE_CHECKING:
    from support.places import Places

RESULTS = Path(__file__).parent / "results"
REPEATS = 5
MAY_COST = 1.5
MUST_GAIN = 3.0
_NAMES = {False: "direct light", True: "whole paths"}


@dataclass(frozen=True)
class Cost:
    """Nanoseconds per sample and place, medians of repeats taken in turn, and their range."""

    few_ns: list[float]
    many_ns: list[float]

    @property
    def ratio(self) -> float:
        """Of the medians."""
        return float(np.median(self.many_ns) / np.median(self.few_ns))


@dataclass(frozen=True)
class Gain:
    """One budget of time.

    Attributes:
        samples: Of the tree and of the uniform choice, for the same time.
        mse: Of both, over places and channels.
        relmse: Of both, each place's error over its light squared.
    """

    samples: tuple[int, int]
    mse: tuple[float, float]
    relmse: tuple[float, float]


def main() -> None:
    """Measures, prints and writes the tables."""
    arguments = _parse()
    device = _prepare(arguments.device)
    few, many = load_scene("builtin:lights-10"), load_scene("builtin:lights")
    costs = {
        "lightmap bake": _bake_cost(arguments),
        _NAMES[True]: _cost(few, many, arguments, bounces=True),
        _NAMES[False]: _cost(few, many, arguments, bounces=False),
    }
    gains = {bounces: _gains(many, arguments, bounces=bounces) for bounces in (False, True)}
    text = _markdown(costs, gains, arguments, device)
    write_text_atomic(RESULTS / "many_lights.md", text)
    print(text)
    worst = min(gain.mse[1] / gain.mse[0] for rows in gains.values() for gain in rows)
    if costs["lightmap bake"].ratio > MAY_COST or worst < MUST_GAIN:
        raise SystemExit("many lights cost more, or the tree gains less, than they must")


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--places", type=int, default=1 << 15)
    parser.add_argument("--resolution", type=int, default=256, help="of the bakes, page edge in texels")
    parser.add_argument("--samples", type=int, nargs="+", default=(16, 64), help="of the tree, one row each")
    parser.add_argument("--reference-samples", type=int, default=4096)
    parser.add_argument("--device", choices=("auto", "cpu", "cuda"), default="auto")
    return parser.parse_args()


def _prepare(device: str) -> str:
    from irradia.transport import use_device

    use_device(device)
    from irradia.transport.backend import device as used

    return f"{used.name}, {used.threads} threads" if used.kind == "cpu" else used.name


def _bake_cost(arguments: argparse.Namespace) -> Cost:
    """A gather ray with its share of next-event samples, as a bake draws them."""
    from irradia.bake.lightmap import BakeOptions, bake_lightmap
    from support.bench_scene import load_bench_scene

    sides = [load_bench_scene(f"builtin:{name}", arguments.resolution) for name in ("lights-10", "lights")]
    found: list[list[float]] = [[], []]
    for repeat in range(REPEATS + 1):
        for (scene, layout), times in zip(sides, found, strict=True):
            stats = bake_lightmap(scene, layout, BakeOptions(samples=64, seed=repeat, denoise=False)).stats
            times.append(1e9 / stats["samples_per_second"])
    return Cost(found[0][1:], found[1][1:])  # the first compiles


def _cost(few: Scene, many: Scene, arguments: argparse.Namespace, *, bounces: bool) -> Cost:
    from support.places import Places

    n_samples = max(arguments.samples)
    sides = [Places(scene, arguments.places, "auto") for scene in (few, many)]
    for side in sides:
        side.estimate(1, 0, bounces=bounces)
    found: list[list[float]] = [[], []]
    for repeat in range(REPEATS):
        for side, times in zip(sides, found, strict=True):
            seconds = side.estimate(n_samples, repeat, bounces=bounces).seconds
            times.append(1e9 * seconds / (n_samples * arguments.places))
    return Cost(*found)


def _gains(scene: Scene, arguments: argparse.Namespace, *, bounces: bool) -> list[Gain]:
    from support.places import Places

    tree, uniform = (Places(scene, arguments.places, s) for s in ("tree", "fixed"))
    truth = tree.estimate(arguments.reference_samples, 1001, bounces=bounces).light
    other = uniform.estimate(arguments.reference_samples, 1002, bounces=bounces).light
    if abs(other.mean() / truth.mean() - 1.0) > 0.01:
        raise SystemExit(f"the estimators disagree: mean {other.mean():.5g} against {truth.mean():.5g}")
    gains = []
    for n_tree in arguments.samples:
        budget = np.median([tree.estimate(n_tree, k, bounces=bounces).seconds for k in range(REPEATS)])
        n_uniform = _samples_for(budget, n_tree, uniform, bounces=bounces)
        ours, theirs = (
            [side.estimate(n, 10 + k, bounces=bounces).light for k in range(REPEATS)]
            for side, n in ((tree, n_tree), (uniform, n_uniform))
        )
        gains.append(
            Gain(
                (n_tree, n_uniform),
                (_mse(ours, truth), _mse(theirs, truth)),
                (_relmse(ours, truth), _relmse(theirs, truth)),
            )
        )
    return gains


def _samples_for(budget_s: float, n_samples: int, side: Places, *, bounces: bool) -> int:
    """How many samples a side draws in a time; it starts from as many as the other drew."""
    for _ in range(3):
        seconds = np.median([side.estimate(n_samples, k, bounces=bounces).seconds for k in range(REPEATS)])
        n_samples = max(int(n_samples * budget_s / seconds), 1)
    return n_samples


def _mse(found: list[NDArray[np.float64]], truth: NDArray[np.float64]) -> float:
    return float(np.mean([np.mean((light - truth) ** 2) for light in found]))


def _relmse(found: list[NDArray[np.float64]], truth: NDArray[np.float64]) -> float:
    floor = (0.01 * truth.mean()) ** 2
    return float(np.mean([np.mean((light - truth) ** 2 / (truth**2 + floor)) for light in found]))


def _markdown(
    costs: dict[str, Cost], gains: dict[bool, list[Gain]], arguments: argparse.Namespace, device: str
) -> str:
    lines = [
        "# Many lights",
        "",
        "Time per sample in `builtin:lights` (1,000 lamps) and `builtin:lights-10` (ten, in the same hall):",
        "",
        "| | 10 lamps | 1,000 lamps | ratio |",
        "|---|---|---|---|",
    ]
    for name, cost in costs.items():
        few, many = (_spread(times) for times in (cost.few_ns, cost.many_ns))
        lines.append(f"| {name} | {few} | {many} | **{cost.ratio:.2f}×** |")
    lines += [
        "",
        "Mean squared error at equal time, lamps chosen by the tree and uniformly:",
        "",
        "| | samples, tree | samples, uniform | MSE, tree | MSE, uniform | ratio | ratio of relMSE |",
        "|---|---|---|---|---|---|---|",
    ]
    for bounces, rows in gains.items():
        for gain in rows:
            ours, theirs = gain.mse
            relative = gain.relmse[1] / gain.relmse[0]
            lines.append(
                f"| {_NAMES[bounces]} | {gain.samples[0]} | {gain.samples[1]} | {ours:.3g} | {theirs:.3g} "
                f"| **{theirs / ours:.1f}×** | {relative:.1f}× |"
            )
    samples = " ".join(map(str, arguments.samples))
    lines += [
        "",
        f"- {arguments.places:,} places strewn over all surfaces; reference {arguments.reference_samples:,} "
        f"samples a place; medians of {REPEATS}, taken in turn.",
        f"- {device}; commit {source_commit() or 'unknown'}.",
        f"- `python bench/many_lights.py --places {arguments.places} --resolution {arguments.resolution} "
        f"--samples {samples} --reference-samples {arguments.reference_samples}`",
    ]
    return "\n".join(lines) + "\n"


def _spread(times: list[float]) -> str:
    return f"{np.median(times):.0f} ns ({min(times):.0f} – {max(times):.0f})"


if __name__ == "__main__":
    main()
