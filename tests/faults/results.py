"""Compares a result folder with the result of an undisturbed run."""
import hashlib
import json
import re

OWN_RECORDS = ".dvi"
PAGE = "report/index.js"
TIMED = ("report.json", "dvi.toml", PAGE)


def contents(out):
    """Returns the expected contents of every file of a result, by relative path, without times and the path of OUT."""
    files = {}
    for path in sorted(out.rglob("*")):
        name = path.relative_to(out)
        if name.parts[0] == OWN_RECORDS or path.is_dir():
            continue
        data = path.read_bytes()
        files[str(name)] = timeless(str(name), data) if str(name) in TIMED else hashlib.sha256(data).hexdigest()
    return files


def timeless(name, data):
    text = data.decode("utf-8", "replace")
    if name == "dvi.toml":
        return re.sub(r"(?m)^out = .*\n", "", text)
    try:
        document = json.loads(text[text.index("(") + 1:text.rindex(")")] if name == PAGE else text)
    except ValueError:
        return "not JSON"
    report = document["run"] if name == PAGE else document
    report.pop("cost", None)
    if name == PAGE:
        document.pop("title")  # the name of the folder
        document["options"] = [option for option in document["options"] if option["name"] != "job.out"]
    return json.dumps(document, sort_keys=True)


def differences(expected, out):
    """Returns findings about files that are missing, not expected, or different."""
    found = contents(out) if out.is_dir() else {}
    missing, extra = sorted(expected.keys() - found.keys()), sorted(found.keys() - expected.keys())
    other = sorted(name for name in expected.keys() & found.keys() if expected[name] != found[name])
    lists = (("missing", missing), ("not expected", extra), ("other than undisturbed", other))
    return [f"result: {what}: {', '.join(names[:4])}{f' and {len(names) - 4} more' if len(names) > 4 else ''}"
            for what, names in lists if names]


def kind_of(name):
    """Returns the kind of a file: the pictures of one folder, the manifests, or a single file."""
    return re.sub(r"[^/]*\d{3}[^/]*$", "*", name)
