"""Pictures of a scene that moves: floors at a displacement scale, links that flash, the ground's motion below.

Displacements and gaps are drawn at one scale, so that floors touch in the picture when they touch in the scene."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pounding_cli.laws import drawn
from pounding_cli.report.picture import Picture
from pounding_cli.report.style import literal, styled
from pounding_cli.solve.histories import History

SIZE, DPI = (8.0, 6.0), 110
"""Figure [in] and its resolution: an even number of pixels, as video wants."""

SHARE = 0.12
"""The largest displacement is drawn as about this part of the tallest building unless a scale is given."""

FADE = 0.2
"""Time in the film [s] after which a flash has a third of its brightness left: contacts are shorter than a frame."""

UP = np.linspace(0.0, 1.0, 9)
BENT = UP * UP * (3.0 - 2.0 * UP)
"""Points of a column along its height, and its shape between floors that it is clamped in."""

CALM, YIELDED, PUSH, PULL = "#2b2b2b", "#e08e00", "#c8102e", "#0b62a4"
"""Colours of storeys within and beyond their yield drift, of links that push and that pull."""


@dataclass(frozen=True)
class Film:
    """How it is shown: from `begin` to `end` [s] of the scene, `slow` times slower than real time, `rate` frames a
    second, displacements and gaps `scale` times their size."""

    begin: float
    end: float
    slow: float
    rate: float
    scale: float

    @property
    def words(self) -> str:
        """Scale and speed, as the picture says them."""
        speed = f"{self.slow:g} times slower than real time" if self.slow != 1 else "in real time"
        return f"displacements and gaps × {self.scale:g}, {speed}"

    @property
    def times(self) -> np.ndarray:
        """The time [s] of every frame."""
        step = 1.0 / (self.slow * self.rate)
        return self.begin + step * np.arange(int(np.floor((self.end - self.begin) / step + 1e-9)) + 1)


def fitting_scale(history: History, picture: Picture) -> float:
    """A round scale at which the largest displacement can be seen: 1, 2 or 5 times a power of ten, at least 1."""
    largest = float(np.nanmax(np.abs(history.displacement)))
    tallest = max(float(each[-1]) for each in picture.elevation)
    if largest == 0:
        return 1.0
    wanted = max(SHARE * tallest / largest, 1.0)
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted * (1 + 1e-9)))


def frames(history: History, picture: Picture, film: Film) -> Iterator[np.ndarray]:
    """The frames of a film, each (height, width, 3) bytes."""
    stage = _Stage(history, picture, film)
    yield from stage.frames()


class _Stage:
    """The figure, drawn once, and what moves on it, drawn anew on every frame."""

    def __init__(self, history: History, picture: Picture, film: Film) -> None:
        self.history, self.picture, self.film = history, picture, film
        self.count = len(picture.elevation)
        tallest = max(float(each[-1]) for each in picture.elevation)
        self.gaps = [_gap(picture, place) for place in range(self.count - 1)]
        apart = [film.scale * gap if gap is not None else 0.2 * tallest for gap in self.gaps]  # fault: film-gap
        self.width = min(max((1.8 * tallest - sum(apart)) / self.count, 0.2 * tallest), 0.8 * tallest)
        self.left = np.concatenate(([0.0], np.cumsum([self.width + space for space in apart])))
        self.canvas = self._background(tallest)

    @styled
    def _background(self, tallest: float) -> FigureCanvasAgg:
        history, film = self.history, self.film
        figure = Figure(figsize=SIZE, dpi=DPI)
        canvas = FigureCanvasAgg(figure)
        grid = figure.add_gridspec(
            3, 1, height_ratios=(5.2, 1, 1), hspace=0.32, left=0.1, right=0.97, top=0.87, bottom=0.09
        )
        self.scene = figure.add_subplot(grid[0])
        reach = 1.15 * film.scale * float(np.nanmax(np.abs(history.displacement)))
        right = self.left[-1] + self.width
        room = max(reach, 0.1 * tallest)
        box = self.scene.get_window_extent()
        height = max(1.27 * tallest, (right + 2 * room) * box.height / box.width)
        spare = (height * box.width / box.height - right) / 2
        self.scene.set(xlim=(-spare, right + spare), ylim=(-0.21 * tallest, height - 0.21 * tallest), aspect="equal")
        self.scene.axis("off")
        self.scene.axhline(0, color="0.6", lw=1.0)
        for place, name in enumerate(history.buildings):
            middle = self.left[place] + self.width / 2
            self.scene.annotate(name, (middle, 0), (0, -9), textcoords="offset points", ha="center", va="top")
        yields = any(np.isfinite(each).any() for each in self.picture.yield_drift)
        told = ("storeys beyond their yield drift are orange; " if yields else "") + "links push red, pull blue"
        self.scene.text(-spare, -0.17 * tallest, told, fontsize=8, color="0.35", va="center")
        _scale_bar(self.scene, film.scale, right + spare, -0.17 * tallest, tallest)
        figure.text(0.5, 0.965, self.picture.title, ha="center", va="top", fontsize=12)
        told = f"{self.picture.words}\n{film.words}"
        figure.text(0.5, 0.925, told, ha="center", va="top", fontsize=9, color="0.3", linespacing=1.4)
        self.strips = [figure.add_subplot(grid[row]) for row in (1, 2)]
        shown = (history.time >= film.begin - 1e-9) & (history.time <= film.end + 1e-9)
        forces = np.nan_to_num(history.link_force)
        pushing = np.where(forces > 0, forces, 0).sum(axis=1)
        unit = self.picture.acceleration
        ground = history.ground_acceleration / unit.factor
        series = (ground, f"ground\n[{unit.name}]", "0.25"), (pushing / 1e6, "links push\n[MN]", PUSH)
        for ax, (values, label, color) in zip(self.strips, series, strict=True):
            ax.plot(history.time[shown], values[shown], color=color, lw=0.7)
            ax.set(xlim=(film.begin, film.end), ylabel=label)
            ax.yaxis.set_label_coords(-0.06, 0.5)
        self.strips[0].tick_params(labelbottom=False)
        self.strips[1].set_xlabel("time [s]")
        self.cursors = [ax.axvline(film.begin, color="#0b62a4", lw=1.2, animated=True) for ax in self.strips]
        self.clock = self.scene.text(
            0.0, 1.0, "", transform=self.scene.transAxes, ha="left", va="top", family="monospace", animated=True
        )
        self.walls = LineCollection([], linewidths=1.6, animated=True, zorder=2)
        self.slabs = LineCollection([], colors=CALM, linewidths=4.0, animated=True, zorder=3)
        self.bridges = LineCollection([], linewidths=2.5, animated=True, zorder=4)
        self.plates = PolyCollection([], facecolor=CALM, linewidths=0, animated=True, zorder=3)
        for lines in (self.walls, self.slabs, self.plates, self.bridges):
            self.scene.add_collection(lines)
        self.flashes = self.scene.scatter([], [], animated=True, zorder=5, linewidths=0, clip_on=False)
        literal(figure)
        return canvas

    def frames(self) -> Iterator[np.ndarray]:
        """Every frame: the background put back, the moving parts drawn on it."""
        self.canvas.draw()
        still = self.canvas.copy_from_bbox(self.canvas.figure.bbox)
        moving: list[tuple[Axes, Artist]] = [
            (self.scene, part) for part in (self.walls, self.slabs, self.plates, self.bridges, self.flashes, self.clock)
        ]
        moving += zip(self.strips, self.cursors, strict=True)
        for time, bright, pull in zip(self.film.times, *self._brightness(), strict=True):
            self.canvas.restore_region(still)
            self._pose(float(time), bright, pull)
            for ax, artist in moving:
                ax.draw_artist(artist)
            yield np.asarray(self.canvas.buffer_rgba())[..., :3].copy()

    def _brightness(self) -> tuple[np.ndarray, np.ndarray]:
        """How bright each link shines in each frame (0 to 1), and whether it last pulled; shape (frames, links).

        The largest force between two frames counts, and fades.
        """
        times, forces = self.film.times, np.nan_to_num(self.history.link_force)
        most = np.abs(forces).max(initial=0.0) or 1.0
        left = np.exp(-1.0 / (FADE * self.film.rate))
        edges = np.searchsorted(self.history.time, times + 1e-9)
        bright, pull = np.zeros((times.size, forces.shape[1])), np.zeros((times.size, forces.shape[1]), bool)
        for number in range(times.size):
            part = forces[edges[number - 1] if number else max(edges[0] - 1, 0) : edges[number]]
            before = bright[number - 1] * left if number else 0.0
            now = np.abs(part).max(axis=0, initial=0.0) / most
            bright[number] = np.maximum(now, before)
            tension = part.size > 0 and np.abs(part.min(axis=0, initial=0.0)) > part.max(axis=0, initial=0.0)
            pull[number] = np.where(now >= before, tension, pull[number - 1] if number else False)
        return bright, pull

    def _pose(self, time: float, bright: np.ndarray, pull: np.ndarray) -> None:
        """Put everything where it is at `time`."""
        scale, h = self.film.scale, self.history
        displacement, drift = _at(h, h.displacement, time), _at(h, h.drift, time)
        sway, rocking = _at(h, h.sway, time), _at(h, h.rocking, time)
        walls, colors, slabs, plates = [], [], [], []
        for place, elevation in enumerate(self.picture.elevation):
            n = elevation.size
            x = self.left[place] + scale * np.concatenate(([sway[place]], displacement[place, :n]))
            y = np.concatenate(([0.0], elevation))
            tilt = scale * rocking[place] * self.width / 2  # a slab's ends rise and sink by so much
            yields = np.abs(drift[place, :n]) > self.picture.yield_drift[place]
            for j in range(n):
                column = self._columns(place, j, x, y, rocking[place])
                for side in (0.04 * self.width, 0.96 * self.width):
                    walls.append(column + np.array([side, 0.0]))
                    colors.append(YIELDED if yields[j] else CALM)
            slabs += [[(x[j], y[j] + tilt), (x[j] + self.width, y[j] - tilt)] for j in range(n + 1)]
            half = self.picture.slabs[place] / 2 if self.picture.slabs else 0.0
            if half > 0.0:
                plates += [
                    [(a, b - half), (c, d - half), (c, d + half), (a, b + half)] for (a, b), (c, d) in slabs[-n:]
                ]
        self.walls.set(segments=walls, color=colors)
        self.slabs.set_segments(slabs)
        self.plates.set_verts(plates)
        self._pose_links(displacement, sway, rocking, bright, pull)
        self.clock.set_text(f"t = {time:6.3f} s")
        for cursor in self.cursors:
            cursor.set_xdata([time, time])

    def _columns(self, place: int, j: int, x: np.ndarray, y: np.ndarray, rocking: float) -> np.ndarray:
        """Points of the columns between floors j and j + 1 (0: base), clamped in both, which lean with the base."""
        lean = self.film.scale * rocking * (y[j + 1] - y[j]) * (UP - BENT)
        return np.column_stack((x[j] + (x[j + 1] - x[j]) * BENT + lean, y[j] + (y[j + 1] - y[j]) * UP))

    def _struck(self, place: int, floor: int, at: float, displacement, sway, rocking) -> tuple[float, float]:
        """How far the end of a link has moved in the picture, and its height [m]."""
        elevation = np.concatenate(([0.0], self.picture.elevation[place]))
        moved = np.concatenate(([sway[place]], displacement[place]))
        height = elevation[floor] - elevation[floor - 1]
        bent = at * at * (3.0 - 2.0 * at)
        away = moved[floor - 1] + (moved[floor] - moved[floor - 1]) * bent + rocking[place] * height * (at - bent)
        return self.film.scale * float(away), float(elevation[floor - 1] + at * height)  # fault: film-struck-point

    def _pose_links(
        self,
        displacement: np.ndarray,
        sway: np.ndarray,
        rocking: np.ndarray,
        bright: np.ndarray,
        pull: np.ndarray,
    ) -> None:
        """What stands between floors as lines; every force as a flash in the middle."""
        bridges, shades, centres, sizes, hues = [], [], [], [], []
        for link, shine, pulls in zip(self.picture.links, bright, pull, strict=True):
            if link is None:
                continue
            now = displacement, sway, rocking
            left, up = self._struck(link.left, link.left_floor, link.left_at, *now)
            right, beside = self._struck(link.left + 1, link.right_floor, link.right_at, *now)
            ends = (self.left[link.left] + self.width + left, up), (self.left[link.left + 1] + right, beside)
            hue = PULL if pulls else PUSH
            between = drawn(link.kind) != "gap"
            if between:
                bridges.append(ends)
                shades.append(_mixed("#9a9a9a", hue, shine))
            centres.append(np.mean(ends, axis=0))
            sizes.append((200.0 if between else 900.0) * shine)
            hues.append((*_rgb(hue), 0.75 * min(1.0, 2 * shine)))
        self.bridges.set(segments=bridges, color=shades)
        self.flashes.set_offsets(np.array(centres).reshape(-1, 2))
        self.flashes.set_sizes(sizes)
        self.flashes.set_facecolor(hues)


def _gap(picture: Picture, place: int) -> float | None:
    """The least gap between a building and its right neighbour [m]; None where no link says it."""
    gaps = [link.gap for link in picture.links if link is not None and link.left == place]
    return min(gaps) if gaps else None


def _at(history: History, series: np.ndarray, time: float) -> np.ndarray:
    """A series at any time, straight between two output times."""
    step = history.time[1] - history.time[0] if history.time.size > 1 else 1.0
    place = min(max((time - history.time[0]) / step, 0.0), history.time.size - 1.0)
    before = min(int(place), history.time.size - 2) if history.time.size > 1 else 0
    after = min(before + 1, history.time.size - 1)
    return series[before] + (place - before) * (series[after] - series[before])


def _scale_bar(ax: Axes, scale: float, right: float, y: float, tallest: float) -> None:
    """A bar of a round length at the scale of the displacements."""
    fits = 0.3 * tallest / scale
    power = 10.0 ** np.floor(np.log10(fits))
    length = max(step * power for step in (1.0, 2.0, 5.0) if step * power <= fits)
    ax.add_line(Line2D([right - scale * length, right], [y, y], color="0.3", lw=2.5, solid_capstyle="butt"))
    shown = f"{100 * length:g} cm" if length >= 0.01 else f"{1000 * length:g} mm"
    ax.annotate(shown, (right - scale * length, y), (-4, 0), textcoords="offset points", ha="right", va="center")


def _rgb(color: str) -> tuple[float, float, float]:
    red, green, blue = (int(color[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return red, green, blue


def _mixed(calm: str, hue: str, share: float) -> tuple[float, ...]:
    return tuple(a + share * (b - a) for a, b in zip(_rgb(calm), _rgb(hue), strict=True))
