#!/usr/bin/env python3
"""write_ros1.py MESSAGES OUT.bag [none|bz2|lz4]: the messages of bag_messages.py as a ROS 1 bag, by Debian's python3-rosbag."""
import importlib
import json
import pathlib
import sys

import genpy.dynamic
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
        elif kind == "uint64":
            setattr(message, slot, int(given))
        elif isinstance(given, dict) and "bytes" in given:
            setattr(message, slot, (folder / given["bytes"]).read_bytes())
        elif isinstance(given, dict):
            fill(getattr(message, slot), given)
        elif isinstance(given, list) and given and isinstance(given[0], dict):
            setattr(message, slot, [fill(kind_of(kind[:-2])(), item) for item in given])
        else:
            setattr(message, slot, given)
    return message


LIVOX = """std_msgs/Header header
uint64 timebase
uint32 point_num
uint8 lidar_id
uint8[3] rsvd
CustomPoint[] points
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: livox_ros_driver2/CustomPoint
uint32 offset_time
float32 x
float32 y
float32 z
uint8 reflectivity
uint8 tag
uint8 line
"""
livox = genpy.dynamic.generate_dynamic("livox_ros_driver2/CustomMsg", LIVOX)


def kind_of(name):
    if name in livox:
        return livox[name]
    package, kind = name.split("/")
    return getattr(importlib.import_module(package + ".msg"), kind)


with rosbag.Bag(sys.argv[2], "w", compression=sys.argv[3] if len(sys.argv) > 3 else "none", chunk_threshold=32768) as bag:
    for m in json.loads((folder / "messages.json").read_text()):
        ns = int(m["time"])
        kind = kind_of(m["type"])
        head = {"topic": m["topic"], "type": m["type"], "md5sum": kind._md5sum, "message_definition": "# left out: kilobytes"}
        bag.write(m["topic"], fill(kind(), m["value"]), rospy.Time(ns // 10**9, ns % 10**9), connection_header=head)
