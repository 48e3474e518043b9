"""A result folder as bytes, and one made in peace to compare with."""
import hashlib
import json
import re

OWN_RECORDS = ".dvi"
PAGE = "report/index.js"
TELL_TIMES = ("report.json", "dvi.toml", PAGE)


def contents(out):
    """What every file of a result must hold, by its relative path. Times, and the place of OUT, are left out."""
    files = {}
    for path in sorted(out.rglob("*")):
        name = path.relative_to(out)
        if name.parts[0] == OWN_RECORDS or path.is_dir():
            continue
        data = path.read_bytes()
        files[str(name)] = timeless(str(name), data) if str(name) in TELL_TIMES else hashlib.sha256(data).hexdigest()
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
    """Findings: files that are missing, too many, or other than expected."""
    found = contents(out) if out.is_dir() else {}
    missing, extra = sorted(expected.keys() - found.keys()), sorted(found.keys() - expected.keys())
    other = sorted(name for name in expected.keys() & found.keys() if expected[name] != found[name])
    lists = (("missing", missing), ("not expected", extra), ("other than undisturbed", other))
    return [f"result: {what}: {', '.join(names[:4])}{f' and {len(names) - 4} more' if len(names) > 4 else ''}"
            for what, names in lists if names]


def kind_of(name):
    """Files that are written in one way: the pictures of one folder, the records, each single file."""
    return re.sub(r"[^/]*\d{3}[^/]*$", "*", name)
