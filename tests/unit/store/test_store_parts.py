"""Responses taken apart, kept in parts and put together again."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.solve.response import ColumnResponse
from pounding_cli.store import PartStore, parts
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.codec import decode, encode, parse
from tests.helpers.plans import known, small_plan

ARRAYS = ("shear", "drift", "ductility", "acceleration", "displacement_max", "displacement_min", "residual_drift")
COLUMNS = ("link", "shear_below", "shear_above", "demand")
LINKS = ("impacts", "peak_force", "max_closing", "impulse", "contact_time")


@pytest.fixture
def plan():
    return small_plan()


@pytest.fixture
def responses(plan):
    return {digest: known(scene) for digest, scene in plan.scenes.items()}


def same(one, other) -> bool:
    """Bit for bit."""
    facts = (
        "status", "advice", "method", "accuracy", "seconds", "flags", "energy", "steps", "events", "orders",
        "effects", "dropped",
    )  # fmt: skip
    return (
        all(getattr(one, name) == getattr(other, name) for name in facts)
        and all(type(getattr(other, name)) is int for name in ("steps", "events", "orders"))
        and np.array_equal(one.sensitivity, other.sensitivity, equal_nan=True)
        and len(one.buildings) == len(other.buildings)
        and all(
            getattr(a, name).astype(float).tobytes() == getattr(b, name).tobytes()
            for a, b in zip(one.buildings, other.buildings, strict=True)
            for name in ARRAYS
        )
        and all((a.sway, a.rocking) == (b.sway, b.rocking) for a, b in zip(one.buildings, other.buildings, strict=True))
        and all(getattr(one.links, n).astype(float).tobytes() == getattr(other.links, n).tobytes() for n in LINKS)
        and all(getattr(one.columns, n).tobytes() == getattr(other.columns, n).tobytes() for n in COLUMNS)
    )


def odd(plan):
    """A response whose every field is unlike the default, with doubles that no short decimal gives."""
    scene = next(scene for scene in plan.scenes.values() if scene.links)
    response = replace(
        known(scene), advice="ν\nsecond line", seconds=1 / 3, flags=("a", "b"), energy={"input": 0.1, "residual": 1e-17}
    )
    response.links.peak_force[0] = np.nextafter(1e6, 2e6)
    response.buildings[0].shear[1] = np.nan
    columns = ColumnResponse(np.array([2]), np.array([1e5 / 3]), np.array([np.nextafter(2.0, 3.0)]), np.array([np.nan]))
    return replace(
        response,
        columns=columns,
        buildings=(replace(response.buildings[0], sway=1 / 7, rocking=5e-324), *response.buildings[1:]),
    )


def test_a_response_comes_back_bit_for_bit(plan):
    response = odd(plan)
    text, numbers = encode(response)
    assert same(response, decode(text, numbers))
    assert not same(response, decode(text, np.nextafter(numbers, 1)))


def test_words_and_numbers_that_do_not_belong_together_are_refused(plan):
    text, numbers = encode(odd(plan))
    with pytest.raises(ValueError, match="expected"):
        decode(text, numbers[:-1])


@pytest.mark.parametrize("value", [None, 3.0, [], "a\0b", "\ud800"])
@pytest.mark.parametrize("name", ["status", "flags", "energy", "storeys", "links"])
def test_words_of_another_kind_are_refused(plan, name, value):
    """A part that someone wrote, its checksum included. Fails if the run ends where the results file is written."""
    response = odd(plan)
    text, _ = encode(response)
    words = json.loads(text)
    words[name] = [value] if isinstance(words[name], list) else value
    with pytest.raises((ValueError, TypeError)):
        parse(json.dumps(words))
    assert parse(text).facts["status"] == response.status


def test_a_store_gives_back_what_went_in_from_memory_and_from_disk(tmp_path, plan, responses):
    responses["odd"] = odd(plan)
    store = PartStore(tmp_path / "r.h5", "key")
    names = list(responses)
    for begin in range(0, len(names), 5):
        store.add(Chunk.of({name: responses[name] for name in names[begin : begin + 5]}))
    assert not store.folder.exists()
    assert all(same(responses[name], store[name]) for name in names)
    store.flush()
    assert len(list(store.folder.iterdir())) == -(-len(names) // 5)
    assert all(same(responses[name], store[name]) for name in names)
    found = PartStore(tmp_path / "r.h5", "key")
    assert found.load() == []
    assert len(found) == len(responses)
    assert all(same(responses[name], found[name]) for name in names)
    taken = found.take(names[::-1])
    assert all(same(responses[name], decode(*each)) for name, each in zip(names[::-1], taken, strict=True))
    assert found.seconds(["odd"]) == 1 / 3
    assert found.storeys(responses) == 3
    assert found.storeys([name for name in responses if len(responses[name].buildings) == 1][-1:]) == 2
    assert set(found) == set(responses)


def test_responses_of_one_header_line_come_together_and_in_the_order_asked_for(tmp_path, plan, responses):
    """From several chunks, some in memory and some on disk, with a response asked for twice."""
    responses["odd"] = odd(plan)
    store = PartStore(tmp_path / "r.h5", "key")
    names = list(responses)
    for begin in range(0, len(names), 5):
        store.add(Chunk.of({name: responses[name] for name in names[begin : begin + 5]}))
        if begin == 5:
            store.flush()
    asked = [*names[::-1], names[3]]
    lines, words = store.lines(asked)
    assert lines == list(dict.fromkeys(encode(responses[name])[0] for name in asked))
    assert [lines[word] for word in words] == [encode(responses[name])[0] for name in asked]
    found = {
        place: (line, row) for line, which, rows in store.alike(asked) for place, row in zip(which, rows, strict=True)
    }
    assert all(same(responses[name], decode(*found[place])) for place, name in enumerate(asked))
    assert len(store.alike(asked)) == len(lines) > 1
    assert store.is_done(asked).tolist() == [encode_is_done(responses[name]) for name in asked]


@pytest.mark.parametrize("order", ["as kept", "in turns", "backwards", "mixed", "one"])
def test_numbers_come_one_response_after_another_in_the_order_asked_for(tmp_path, plan, responses, order):
    """Rows and buildings alone have numbers of other sizes. Fails if those that stand in a row in a chunk, or are asked
    for in a row, are taken for both."""
    digests = list(responses)
    store = PartStore(tmp_path / "r.h5", "key")
    for some in (digests[::2], digests[1::2]):
        store.add(Chunk.of({digest: responses[digest] for digest in some}))
    store.flush()
    mixed = np.random.default_rng(2).permutation(digests).tolist()
    asked = {
        "as kept": [*digests[::2], *digests[1::2]], "in turns": digests, "backwards": digests[::-1], "mixed": mixed,
        "one": digests[:1],
    }  # fmt: skip
    rows = [numbers for _, numbers in store.take(asked[order])]
    found = store.numbers(asked[order], np.array([row.size for row in rows]))
    assert found.tobytes() == np.concatenate(rows).tobytes()
    assert store.numbers([], np.zeros(0, int)).size == 0


def encode_is_done(response) -> bool:
    return parse(encode(response)[0]).is_done


def test_chunks_of_one_scene_go_to_the_disk_as_one_part(tmp_path, responses):
    """The last response of a scene counts. Fails if a scene is looked for in the chunk that it came in, or if one that
    came twice is read as it was first."""
    store = PartStore(tmp_path / "r.h5", "key")
    names = list(responses)
    again, later = (replace(responses[name], steps=12345) for name in names[1:3])
    for name in names[:4]:
        store.add(Chunk.of({name: responses[name]}))
    store.add(Chunk.of({names[2]: later} | {name: responses[name] for name in names[4:]}))
    store.add(Chunk.of({names[1]: again}))
    expected = {**responses, names[1]: again, names[2]: later}
    store.flush()
    assert len(list(store.folder.iterdir())) == 2
    assert all(same(expected[name], store[name]) for name in names)
    assert store.saved(names) == len(names)
    found = PartStore(tmp_path / "r.h5", "key")
    assert found.load() == []
    assert all(same(expected[name], found[name]) for name in names if name != names[2])


def test_only_what_is_wanted_and_done_and_of_this_key_is_found(tmp_path, responses):
    first, second, third = list(responses)[:3]
    stopped = replace(responses[second], status="event bound reached")
    store = PartStore(tmp_path / "r.h5", "key")
    store.add(Chunk.of({first: responses[first], second: stopped, third: responses[third]}))
    store.flush()
    found = PartStore(tmp_path / "r.h5", "key")
    assert found.load() == []
    assert list(found) == [first, third]
    assert same(found[third], responses[third])  # where it stands behind the one that was stopped
    found.only({first: None, second: None})
    assert list(found) == [first]
    another = PartStore(tmp_path / "r.h5", "another key")
    assert another.load() == []
    assert len(another) == 0


def test_digests_that_were_asked_for_are_not_held_twice(responses):
    """Fails if a chunk that came back from a worker brings texts of its own, 113 bytes a scene; or takes others'."""
    asked = list(responses)
    content = Chunk.of({name: responses[name] for name in asked[:3]}).to_bytes("key")
    found = Chunk.from_bytes(content, "key", asked)
    assert [found.digests[place] is asked[place] for place in range(3)] == [True] * 3
    assert list(Chunk.from_bytes(content, "key", asked[1:]).digests) == asked[:3]


@pytest.mark.parametrize("words", [[0, 1], [0, -1], [0, 0.5], [0], [0, 0, 0]])
def test_words_of_a_part_name_its_lines(responses, words):
    """Fails if a part is read whose words, though its checksum is right, name lines that it has not."""
    some = dict(list(responses.items())[:2])
    assert {scene.status for scene in some.values()} == {"done"}
    chunk = Chunk.of(some)
    text, row = chunk.texts[0], chunk.row(0)
    sound = Chunk(list(some), [text], np.array([0, 0]), np.tile(row, 2))
    assert len(Chunk.from_bytes(sound.to_bytes("key"), "key")) == 2
    with pytest.raises((ValueError, IndexError)):
        Chunk.from_bytes(replace(sound, words=np.array(words)).to_bytes("key"), "key")


@pytest.mark.parametrize("place", [0, 20, 90, -3])  # magic, digest, words, numbers
def test_damaged_and_foreign_parts_are_passed_over(tmp_path, responses, place):
    store = PartStore(tmp_path / "r.h5", "key")
    for some in (list(responses)[:4], list(responses)[4:]):
        store.add(Chunk.of({name: responses[name] for name in some}))
    store.flush()
    part = next(path for path in store.folder.iterdir() if len(Chunk.from_bytes(path.read_bytes(), "key")) == 4)
    content = bytearray(part.read_bytes())
    content[place] ^= 1
    part.write_bytes(content)
    (store.folder / "x.part").write_bytes(b"nothing of ours")
    (store.folder / "empty.part").touch()
    found = PartStore(tmp_path / "r.h5", "key")
    assert sorted(found.load()) == sorted([part, store.folder / "x.part", store.folder / "empty.part"])
    assert len(found) == len(responses) - 4


def test_the_first_chunks_stay_in_memory(tmp_path, responses, monkeypatch):
    """Fails if what fits is read back from the disk, or if more stays than may."""
    chunk = Chunk.of(responses)
    monkeypatch.setattr(parts, "IN_MEMORY", chunk.numbers.nbytes)
    store = PartStore(tmp_path / "r.h5", "key")
    for number in range(2):
        store.add(Chunk([f"{number}{digest[1:]}" for digest in chunk.digests], chunk.texts, chunk.words, chunk.numbers))
        store.flush()
    store.remove()
    assert len(store.take([f"0{digest[1:]}" for digest in chunk.digests])) == len(responses)
    with pytest.raises(FileNotFoundError):
        store.take([f"1{digest[1:]}" for digest in chunk.digests])


@pytest.mark.parametrize("found", [True, False])
def test_a_part_that_is_damaged_after_it_was_listed_is_not_read(tmp_path, responses, monkeypatch, found):
    """Found beside the file, or written by this run, which holds no more of it."""
    monkeypatch.setattr(parts, "IN_MEMORY", 0)
    store = PartStore(tmp_path / "r.h5", "key")
    store.add(Chunk.of(responses))
    store.flush()
    if found:
        store = PartStore(tmp_path / "r.h5", "key")
        store.load()
    (part,) = store.folder.iterdir()
    content = bytearray(part.read_bytes())
    content[-3] ^= 1
    part.write_bytes(content)
    with pytest.raises(OSError, match="damaged since it was written") as refused:
        store.take(list(responses))
    assert refused.value.filename == str(part)


def test_a_part_that_cannot_be_written_leaves_nothing_half_written(tmp_path, responses, monkeypatch):
    store = PartStore(tmp_path / "r.h5", "key")
    store.add(Chunk.of(responses))
    with monkeypatch.context() as patch:
        patch.setattr("os.fsync", lambda _: (_ for _ in ()).throw(OSError(28, "No space left on device")))
        with pytest.raises(OSError, match="No space"):
            store.flush()
    assert list(store.folder.iterdir()) == []
    store.flush()  # there is space again
    found = PartStore(tmp_path / "r.h5", "key")
    assert found.load() == []
    assert len(found) == len(responses)
