"""What tests of figures look at: the panels that carry data, and whether texts stand on each other."""

from __future__ import annotations

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text


def panels(figure):
    """The axes that carry data, in the order they were made."""
    return [ax for ax in figure.axes if ax.axison]


def visible_texts(figure):
    """Every piece of text that is really drawn, with its box on the canvas."""
    drawn = {}
    draw = Text.draw

    def remember(text, renderer, *rest, **keywords):
        if text.get_visible() and text.get_text().strip():
            drawn[id(text)] = text
        return draw(text, renderer, *rest, **keywords)

    canvas = FigureCanvasAgg(figure)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Text, "draw", remember)
        canvas.draw()
    return [(text.get_text(), text.get_window_extent(canvas.get_renderer())) for text in drawn.values()]


def assert_no_overlap(figure):
    texts = visible_texts(figure)
    assert len(texts) > 10
    width, height = figure.bbox.width, figure.bbox.height
    for number, (words, box) in enumerate(texts):
        assert min(box.x0, box.y0, width - box.x1, height - box.y1) >= -1, f"{words!r} is cut"
        for other, box2 in texts[number + 1 :]:
            across = min(box.x1, box2.x1) - max(box.x0, box2.x0)
            along = min(box.y1, box2.y1) - max(box.y0, box2.y0)
            assert across <= 1 or along <= 1, f"{words!r} stands on {other!r}"
