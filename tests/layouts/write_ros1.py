#!/usr/bin/env python3
"""write_ros1.py MESSAGES OUT.bag [none|bz2|lz4]: the messages of bag_messages.py as a ROS 1 bag, by Debian's python3-rosbag."""
import importlib
import json
import pathlib
import sys

import rosbag
import rospy

folder = pathlib.Path(sys.argv[1])


def fill(message, value):
    """Sets the fields of a ROS message from a dictionary."""
    for slot, kind in zip(message.__slots__, message._slot_types):
        if slot not in value:
            continue
        given = value[slot]
        if kind == "time":
            setattr(message, slot, rospy.Time(given["sec"], given["nanosec"]))
        elif isinstance(given, dict) and "bytes" in given:
            setattr(message, slot, (folder / given["bytes"]).read_bytes())
        elif isinstance(given, dict):
            fill(getattr(message, slot), given)
        elif isinstance(given, list) and given and isinstance(given[0], dict):
            setattr(message, slot, [fill(kind_of(kind[:-2])(), item) for item in given])
        else:
            setattr(message, slot, given)
    return message


def kind_of(name):
    package, kind = name.split("/")
    return getattr(importlib.import_module(package + ".msg"), kind)


with rosbag.Bag(sys.argv[2], "w", compression=sys.argv[3] if len(sys.argv) > 3 else "none", chunk_threshold=32768) as bag:
    for m in json.loads((folder / "messages.json").read_text()):
        ns = int(m["time"])
        kind = kind_of(m["type"])
        head = {"topic": m["topic"], "type": m["type"], "md5sum": kind._md5sum, "message_definition": "# left out: kilobytes"}
        bag.write(m["topic"], fill(kind(), m["value"]), rospy.Time(ns // 10**9, ns % 10**9), connection_header=head)
