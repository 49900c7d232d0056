"""A study file as a tree of nodes, each knowing its line and column."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

Mark = tuple[int, int]
"""Line and column, both from 1."""


@dataclass(frozen=True, eq=False, slots=True)  # slots: a study of many samples has a node for each value
class Node:
    """One value of the file.

    value : None, bool, int, float or str; a list of nodes; or a dict of nodes by key, in the file's order
    mark : where the value begins
    text : what the file says, for a scalar or a short list or mapping
    keys : where each key of a mapping begins
    quoted : whether it is a scalar in quotes
    """

    value: Any
    mark: Mark
    text: str = ""
    keys: dict[str, Mark] | None = None
    quoted: bool = False

    @property
    def is_mapping(self) -> bool:
        return isinstance(self.value, dict)

    @property
    def is_list(self) -> bool:
        return isinstance(self.value, list)

    def plain(self) -> Any:
        """The value as plain dicts, lists and scalars."""
        if isinstance(self.value, dict):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value

    def get(self, *path: str | int) -> Node | None:
        """The node at a path of keys and list places from 0, or None."""
        node = self
        for step in path:
            if node.is_mapping and str(step) in node.value:
                node = node.value[str(step)]
            elif node.is_list and isinstance(step, int) and 0 <= step < len(node.value):
                node = node.value[step]
            else:
                return None
        return node

    def locate(self, path: Sequence[str | int], key: bool = False) -> Mark:
        """Where the value at `path` begins (its key where `key`); steps the file lacks are passed over."""
        node, mark = self, self.mark
        for place, step in enumerate(path):
            child = node.get(step)
            if child is None:
                continue
            last = not any(child.get(later) for later in path[place + 1 : place + 2])
            mark = node.keys[str(step)] if key and last and node.keys else child.mark
            node = child
        return mark

    def replaced(self, path: Sequence[str | int], new: Node) -> Node:
        """The same tree with `new` at `path`; mappings on the way are made where they are missing.

        Raises KeyError when the path runs through a scalar or off a list.
        """
        if not path:
            return new
        step, rest = path[0], path[1:]
        if self.is_mapping or self.value is None:
            children = dict(self.value or {})
            below = children.get(str(step), Node({}, new.mark, keys={}))
            children[str(step)] = below.replaced(rest, new)
            return Node(children, self.mark, self.text, {**{str(step): new.mark}, **(self.keys or {})})
        if self.is_list and str(step).isdigit() and int(step) < len(self.value):
            items = list(self.value)
            items[int(step)] = items[int(step)].replaced(rest, new)
            return Node(items, self.mark, self.text)
        raise KeyError(step)


UNWRITTEN = Node(None, (0, 0), "default")
"""What stands at a point of an axis for a key that the file leaves to its default."""
