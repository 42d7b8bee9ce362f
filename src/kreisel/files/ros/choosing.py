"""Turns the topics of a bag and the words of a user into the topics to read, or into an error that lists them."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass

from kreisel.files.formats import ReadOptions, Topic, Undecided
from kreisel.files.ros.bags import Bag, is_tf

_WANTED = {"imu": ("imu",), "attitude": ("imu", "poses"), None: ("imu", "poses")}
_LISTED = 12


@dataclass(frozen=True, slots=True)
class Choice:
    """What to read: a topic with an IMU or poses, and for the former the topic of a magnetometer."""

    main: Topic
    mag: Topic | None = None


def choose(bag: Bag, options: ReadOptions) -> Choice:
    """The topics asked for, or the only ones that fit; ValueError with what is there where that is not clear."""
    topics = bag.topics()
    asked = [_named(bag, topics, name) for name in options.topics]
    main = [topic for topic in asked if topic.holds != "mag"]
    mag = [topic for topic in asked if topic.holds == "mag"]
    if len(main) > 1 or len(mag) > 1:
        raise ValueError(
            f"{bag.path}: topic takes one with an IMU or poses, and for an IMU one with its magnetic field; "
            f"got {', '.join(options.topics)}."
        )
    chosen = main[0] if main else _only(bag, topics, options.kind)
    if chosen.holds == "imu":
        return Choice(chosen, mag[0] if mag else _beside(topics, chosen))
    if mag:
        raise ValueError(f"{bag.path}: {mag[0].name} is a magnetometer, and {chosen.name} no IMU to go with.")
    return Choice(chosen)


def _named(bag: Bag, topics: Sequence[Topic], name: str) -> Topic:
    """The topic a user named, its first slash forgiven."""
    asked = name if name.startswith("/") else f"/{name}"
    base = asked.partition(":")[0]
    known = {topic.name.lstrip("/"): topic for topic in topics}
    found = known.get(base.lstrip("/"))
    if found is not None and is_tf(found):
        pairs = bag.transforms(found.name)
        found = next((p for p in pairs if p.name.lstrip("/") == asked.lstrip("/")), None)
        if found is None and (":" in asked or len(pairs) != 1):
            raise ValueError(
                f"{bag.path}: say which frames of {base}, as in --topic {base}:PARENT.CHILD. {_there(pairs)}"
            )
        return found or pairs[0]
    if found is None or ":" in asked:
        near = difflib.get_close_matches(base.lstrip("/"), list(known), n=1)
        hint = f" Did you mean {known[near[0]].name!r}?" if near else ""
        raise ValueError(f"{bag.path} has no topic {name!r}.{hint} {_there(topics)}")
    if " and " in found.type:
        raise ValueError(
            f"{bag.path}: topic {found.name} mixes messages of different types, {found.type}. Choose another."
        )
    if not found.holds:
        raise ValueError(
            f"{bag.path}: topic {found.name} holds {found.type}, which is neither an IMU nor poses. {_there(topics)}"
        )
    return found


def _only(bag: Bag, topics: Sequence[Topic], kind: str | None) -> Topic:
    wanted = _WANTED.get(kind, ("poses",))
    fitting = [topic for topic in topics if topic.holds in wanted and topic.messages]
    found = [topic for topic in fitting if not is_tf(topic)]
    if not found:
        # Transforms commonly repeat what another topic has: they count where they are alone.
        found = [pair for topic in fitting for pair in bag.transforms(topic.name)]
    if len(found) == 1:
        return found[0]
    if found:
        raise Undecided(
            f"{bag.path} has several topics to read. Say which, as in --topic {found[0].name}. {_there(found)}"
        )
    what = " or ".join({"imu": "an IMU", "poses": "poses"}[each] for each in wanted)
    raise Undecided(f"{bag.path} has no topic with {what}. {_there(topics)}")


def _beside(topics: Sequence[Topic], imu: Topic) -> Topic | None:
    """The magnetometer of an IMU nobody named: the only one in its namespace, or in a bag with one IMU the only one."""
    mags = [topic for topic in topics if topic.holds == "mag"]
    near = [topic for topic in mags if _namespace(topic) == _namespace(imu)]
    alone = sum(topic.holds == "imu" for topic in topics) == 1
    found = near or (mags if alone else [])
    return found[0] if len(found) == 1 else None


def _namespace(topic: Topic) -> str:
    return topic.name.rpartition("/")[0]


def _there(topics: Sequence[Topic]) -> str:
    if not topics:
        return "It has no topics."
    listed = ", ".join(f"{topic.name} ({topic.type})" for topic in topics[:_LISTED])
    more = f" and {len(topics) - _LISTED} more" if len(topics) > _LISTED else ""
    return f"There {'is' if len(topics) == 1 else 'are'} {listed}{more}."
