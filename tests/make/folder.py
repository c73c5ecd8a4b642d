"""Sessions that are made from others."""
import json
import shutil


def index_of(session):
    """What a session's capture.json says."""
    return json.loads((session / "capture.json").read_text())


def copied(session, out):
    """Copies a session; its index, to be changed and written."""
    shutil.copytree(session, out, dirs_exist_ok=True)
    return index_of(out)


def write(out, index):
    """Writes the changed index of a copy."""
    (out / "capture.json").write_text(json.dumps(index, indent=1) + "\n")
