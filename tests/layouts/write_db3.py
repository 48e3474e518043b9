#!/usr/bin/env python3
"""write_db3.py MESSAGES OUT.db3: the messages of bag_messages.py, which write_mcap.mjs has serialized, as rosbag2 stores them in
SQLite."""
import json
import pathlib
import sqlite3
import sys

folder = pathlib.Path(sys.argv[1])
messages = json.loads((folder / "messages.json").read_text())
with sqlite3.connect(sys.argv[2]) as db:
    db.execute("PRAGMA page_size = 1024")
    db.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT NOT NULL,"
               "offered_qos_profiles TEXT NOT NULL)")
    db.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
    db.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    topics = {}
    for i, m in enumerate(messages):
        if m["topic"] not in topics:
            topics[m["topic"]] = len(topics) + 1
            db.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')",
                       (topics[m["topic"]], m["topic"], m["type"].replace("/", "/msg/")))
        db.execute("INSERT INTO messages VALUES (?, ?, ?, ?)",
                   (i + 1, topics[m["topic"]], int(m["time"]), (folder / f"{i}.cdr").read_bytes()))
