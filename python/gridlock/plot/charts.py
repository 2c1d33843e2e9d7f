"""Charts of series, measured curves and sweeps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import Error
from ..simulation import Simulation
from ..sweeps import SweepDirectory
from .style import GREY, LINE_COLOURS, MARKERS, axis_label, new_axes, sequential

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray


def line(axes: Axes, x: ArrayLike, y: ArrayLike, error: ArrayLike | None = None, *, label: str = "", **look: Any) -> None:
    """A line with a band of one standard error. Points without a value are left out; an error that is not known has no width.

    :param look: the properties of a line of matplotlib, such as ``color`` and ``linestyle``.
    """
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    is_known = np.isfinite(x) & np.isfinite(y)
    if "color" in look:
        look.setdefault("linestyle", "-")  # and not that of the next colour in turn
    (drawn,) = axes.plot(x[is_known], y[is_known], label=label or None, **look)
    if error is not None:
        half = np.nan_to_num(np.asarray(error, dtype=np.float64))[is_known]
        axes.fill_between(x[is_known], y[is_known] - half, y[is_known] + half, color=drawn.get_color(), alpha=0.25, linewidth=0)


def points(axes: Axes, x: ArrayLike, y: ArrayLike, error: ArrayLike | None = None, *, label: str = "", number: int = 0, **look: Any) -> None:
    """Points, joined by a line, with bars of one standard error; ``number`` chooses the shape of curve 0, 1, 2 …"""
    look = {"color": LINE_COLOURS[number % len(LINE_COLOURS)], "marker": MARKERS[number % len(MARKERS)],
            "linestyle": ("-", "--", ":")[number // len(LINE_COLOURS) % 3], **look}
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    is_known = np.isfinite(x) & np.isfinite(y)
    half = None if error is None else np.nan_to_num(np.asarray(error, dtype=np.float64))[is_known]
    axes.errorbar(x[is_known], y[is_known], half, label=label or None, elinewidth=0.7, **look)


def histogram(axes: Axes, middles: ArrayLike, heights: ArrayLike, error: ArrayLike | None = None, *, label: str = "", **look: Any) -> None:
    """Steps over bins of equal width, with a bar of one standard error in the middle of each."""
    middles, heights = np.asarray(middles, dtype=np.float64), np.asarray(heights, dtype=np.float64)
    width = middles[1] - middles[0] if len(middles) > 1 else 1.0
    edges = np.append(middles - 0.5 * width, middles[-1:] + 0.5 * width)
    colour = look.pop("color", LINE_COLOURS[0])
    axes.stairs(heights, edges, label=label or None, color=colour, fill=True, alpha=0.3)
    axes.stairs(heights, edges, color=colour, **look)
    if error is not None:
        axes.errorbar(middles, heights, np.nan_to_num(np.asarray(error, dtype=np.float64)), linestyle="none", color=colour,
                      elinewidth=0.7, capsize=0)


def reference(axes: Axes, at: float, label: str = "") -> None:
    """A thin line across the chart, with a word below its right end."""
    axes.axhline(at, color=GREY, linewidth=0.7, linestyle=":", zorder=1)
    if label:
        axes.annotate(label, (1.0, at), (-2, -2), xycoords=("axes fraction", "data"), textcoords="offset points", ha="right", va="top",
                      color=GREY, fontsize="small", annotation_clip=True, in_layout=False)


def _begin_at_zero(axes: Axes) -> None:
    """Both axes, whose other ends suit all that is drawn."""
    axes.autoscale()
    axes.set(xlim=(0, None), ylim=(0, None))


def series(run: Any, columns: str | Sequence[str], *, against: str = "time", axes: Axes | None = None) -> Axes:
    """Columns of the series of a simulation or a run directory against time."""
    table = run.series
    present = list(table.dtype.names or ())
    names = [columns] if isinstance(columns, str) else list(columns)
    for name in [*names, against]:
        if name not in present:
            raise Error(f"the series has no column {name}\n  hint: it has {', '.join(present)}")
    axes = axes if axes is not None else new_axes()
    for name in names:
        line(axes, table[against], table[name], label=axis_label(name))
    axes.set(xlabel=axis_label(against), ylabel=axis_label(names[0]) if len(names) == 1 else "")
    if len(names) > 1:
        axes.legend()
    return axes


def _unit_of_distance(run: Any, unit: float | None) -> tuple[float, str]:
    """The length in which distances are drawn, and the words of the axis."""
    if unit is not None:
        return unit, "distance r" if unit == 1.0 else f"distance r / {unit:.4g}"
    if isinstance(run, Simulation):
        radii = run.agents.radius if "radius" in run.agents.names else None
    else:
        radii = run.final.columns.get("radius") if (run.path / "final.xyz").exists() else None
    if radii is None or len(radii) == 0:
        return 1.0, "distance r"
    is_equal = radii.min() == radii.max()
    return 2.0 * float(radii.mean()), "distance r / diameter σ" if is_equal else "distance r / mean diameter"


def curve(run: Any, name: str, *, unit: float | None = None, axes: Axes | None = None, label: str = "") -> Axes:
    """A measured curve with its errors: "pair_correlation", "speed_distribution", "velocity_autocorrelation", "density_profile_x",
    "density_profile_y", "mean_squared_displacement", "local_density", "cluster_sizes" (clusters of one size, the mean over each range),
    "orientation_correlation" (g₆(r) of the table of g(r), beside r^(−1/4), below which no hexatic falls), "stress_growth" (shear and
    bulk growth over the lag, which become the viscosities), "free_time_distribution", "free_path_distribution".

    :param unit: the length that distances of g(r) are given in; the mean diameter where left out, of agents that have one.
    """
    is_of_orientation = name == "orientation_correlation"
    file = "pair_correlation" if is_of_orientation else name
    table = run.distributions.get(file) if isinstance(run, Simulation) else run.table(file)
    if table is None or (is_of_orientation and name not in (table.dtype.names or ())):
        raise Error(f"there is no curve {name} yet\n  hint: there are {', '.join(run.distributions) or 'none'}")
    axes = axes if axes is not None else new_axes()
    x, y = list(table.dtype.names or ())[:2]
    error = table["error"] if "error" in (table.dtype.names or ()) else None
    axes.set(xlabel=axis_label(x), ylabel=axis_label(y))
    if is_of_orientation:
        _draw_orientation_correlation(axes, table, *_unit_of_distance(run, unit), label)
        return axes
    if name == "speed_distribution":
        histogram(axes, table[x], table[y], error, label=label or "measured")
        line(axes, table[x], table["maxwell"], label="Maxwell", color=LINE_COLOURS[1])
        _begin_at_zero(axes)
        axes.legend()
        return axes
    if name == "pair_correlation":
        length, text = _unit_of_distance(run, unit)
        axes.set_xlabel(text)
        line(axes, table[x] / length, table[y], error, label=label)
        reference(axes, 1.0)
        _begin_at_zero(axes)
    elif name == "cluster_sizes":
        sizes = table["largest_size"] - table[x] + 1
        line(axes, table[x], table[y] / sizes, error / sizes, label=label)
        axes.set(xscale="log", yscale="log", xlabel="disks in a cluster", ylabel="clusters of one size")
    elif name == "stress_growth":
        for part in ("shear", "bulk"):
            line(axes, table[x], table[f"{part}_growth"] / table[x], table[f"{part}_error"] / table[x], label=f"{label} {part}".strip())
        axes.set(xscale="log", yscale="log", ylabel="growth over lag / (mass / time)")
        axes.legend()
    elif name.startswith("free_"):
        found = table[table["flights"] > 0]
        line(axes, found[x], found[y], found["error"], label=label)
        axes.set(xscale="log", yscale="log", ylabel=f"probability density of the {x.replace('_', ' ')}")
    else:
        line(axes, table[x], table[y], error, label=label)
    if name.startswith("density_profile"):
        axes.set_xlabel(f"{name[-1]} / length")
        axes.set_ylim(0.0, None)
    return axes


def _draw_orientation_correlation(axes: Axes, table: NDArray[Any], length: float, text: str, label: str) -> None:
    found = table[table["orientation_correlation"] > 0.0]
    r, g6 = found["distance"] / length, found["orientation_correlation"]
    line(axes, r, g6, found["orientation_correlation_error"], label=label or "measured")
    if len(r):
        axes.plot(r, g6.max() * (r / r[0]) ** -0.25, color=GREY, linestyle="--", label="r^(−1/4)")
    axes.set(xscale="log", yscale="log", xlabel=text, ylabel=axis_label("orientation_correlation"))
    axes.legend()


def dynamics(found: Any, name: str = "msd", *, labels: Sequence[str] = (), axes: Axes | None = None) -> Axes:
    """A curve of :func:`gridlock.dynamics` with its errors against the logarithm of the lag, one line for each kind: "msd",
    "non_gaussian", "scattering", "overlap", "susceptibility", "total_susceptibility"; "scattering" of
    :func:`gridlock.collective_scattering` too, of the kinds with themselves.

    :param labels: the names of the kinds.
    """
    value = getattr(found, name, None) if isinstance(name, str) else None
    if value is None or not hasattr(found, name + "_error"):
        raise Error(f"there is no curve {name}\n  hint: msd is always there, others where their lengths were given")
    error = getattr(found, name + "_error")
    if value.ndim == 3:
        value, error = (np.diagonal(array).T for array in (value, error))
    axes = axes if axes is not None else new_axes()
    values, errors = np.atleast_2d(value), np.atleast_2d(error)
    for kind, (curve_of_kind, error_of_kind) in enumerate(zip(values, errors)):
        of_kind = labels[kind] if kind < len(labels) else f"kind {kind}" if len(values) > 1 else ""
        later = found.lag > 0  # a logarithm has no place for the lag 0
        line(axes, found.lag[later], curve_of_kind[later], error_of_kind[later], label=of_kind)
    axes.set(xscale="log", yscale="log" if name == "msd" else "linear", xlabel=axis_label("lag"), ylabel=axis_label(name))
    if len(values) > 1 or labels:
        axes.legend()
    return axes


def mark_contacts(axes: Axes, radii: NDArray[np.float64]) -> None:
    """Names the distances of g(r), in mean diameters, at which disks of two or three sizes touch: A the smallest."""
    sizes = np.unique(radii)
    if not 1 < len(sizes) <= 3:
        return
    for i, small in enumerate(sizes):
        for j in range(i, len(sizes)):
            at = (small + sizes[j]) / (2.0 * radii.mean())
            axes.axvline(at, color=GREY, linewidth=0.5, linestyle=":", zorder=1)
            # Every second name is higher: neighbours would touch.
            axes.annotate("ABC"[i] + "ABC"[j], (at, 1.0), (0, 1 + 6 * ((i + j) % 2)), xycoords=("data", "axes fraction"), textcoords="offset points",
                          ha="center", va="bottom", color=GREY, fontsize="x-small")


def distribution_of_runs(axes: Axes, values: NDArray[np.float64]) -> None:
    """A histogram of one result over runs that differ in their seeds, with its mean and standard error."""
    mean, error = float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))
    counts, edges = np.histogram(values, bins="sturges")
    histogram(axes, 0.5 * (edges[1:] + edges[:-1]), counts)
    axes.axvline(mean, color=LINE_COLOURS[1])
    axes.axvspan(mean - error, mean + error, color=LINE_COLOURS[1], alpha=0.25, linewidth=0)
    axes.locator_params(axis="y", integer=True)
    axes.set_title(f"{len(values)} runs: {mean:.4g} ± {error:.2g}")


def swept_keys(means: NDArray[Any]) -> list[str]:
    """The settings that a sweep varies: the columns before ``runs``."""
    names = list(means.dtype.names or ())
    return names[: names.index("runs")]


def swept_number(means: NDArray[Any]) -> str | None:
    """The swept number with the most values; None where no number has two."""
    numbers = [key for key in swept_keys(means) if means[key].dtype.kind in "fiu"]
    most = max(numbers, key=lambda key: len(np.unique(means[key])), default=None)
    return most if most is not None and len(np.unique(means[most])) > 1 else None


def combinations(means: NDArray[Any], result: str, against: str) -> dict[tuple[Any, ...], NDArray[Any]]:
    """The rows with a finite result for each combination of the other settings, ascending."""
    others = [key for key in swept_keys(means) if key != against]
    rows: dict[tuple[Any, ...], list[int]] = {}
    for number in np.argsort(means[against], kind="stable"):
        if np.isfinite(means[result][number]):
            rows.setdefault(tuple(means[key][number].item() for key in others), []).append(number)
    return {values: means[rows[values]] for values in sorted(rows, key=lambda values: [(isinstance(v, str), v) for v in values])}


def sweep(made: SweepDirectory, result: str, *, against: str | None = None, axes: Axes | None = None) -> Axes:
    """A result against a swept setting, with bars of one standard error; one line for each combination of the others."""
    means = made.means
    names = list(means.dtype.names or ())
    if result not in names:
        raise Error(f"the sweep has no result {result}\n  hint: it has {', '.join(n for n in names if n + '_error' in names)}")
    keys = swept_keys(means)
    numbers = [key for key in keys if means[key].dtype.kind in "fiu"]
    against = against if against is not None else swept_number(means) or (numbers[0] if numbers else None)
    if against not in numbers:
        raise Error(f"the sweep has no numbers {against}\n  hint: it has {', '.join(numbers)}")
    assert against is not None
    axes = axes if axes is not None else new_axes()
    others = [key for key in keys if key != against]
    found = combinations(means, result, against)
    # Curves that differ in one number go from dark to bright, others differ as kinds do.
    is_sequence = len(others) == 1 and means[others[0]].dtype.kind in "fiu" and len(found) > 2
    colours = sequential(len(found)) if is_sequence else None
    for number, (values, rows) in enumerate(found.items()):
        label = str(values[0]) if len(others) == 1 else ", ".join(f"{axis_label(key)} = {value}" for key, value in zip(others, values))
        look: dict[str, Any] = {"color": colours[number]} if colours else {}
        if means["runs"].max() == 1:
            look["linewidth"] = 0.4  # joins what belongs together, and does not lead the eye through scatter
        points(axes, rows[against], rows[result], rows[result + "_error"], label=label, number=number, **look)
    axes.set(xlabel=axis_label(against), ylabel=axis_label(result))
    if others and found:
        letters = max(len(str(text)) for text in axes.get_legend_handles_labels()[1])
        axes.figure.legend(loc="outside lower center", ncols=max(1, 60 // (letters + 8)),
                           title=axis_label(others[0]) if len(others) == 1 else None)
    return axes
