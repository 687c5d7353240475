"""Keys and types of job.json, and the files that a job folder holds."""
import re

from .job import program_file, tray_file
from .report import first_few

INTEGER = "integer"
NUMBER = "number"
POSITIVE = "positive number"
TEXT = "text"
BOOLEAN = "true or false"
SHA256 = "64 hexadecimal digits"
OBJECT = "object"

NEIGHBOUR = {"id": INTEGER, "glue_area_mm2": NUMBER}
PART = {"id": INTEGER, "model": INTEGER, "tray": INTEGER, "file": TEXT, "volume_mm3": POSITIVE,
        "transform": (NUMBER, 16), "neighbours": [NEIGHBOUR]}
JOB = {
    "version": INTEGER,
    "inputs": [{"file": TEXT, "sha256": SHA256, "scale": POSITIVE}],
    "profile": {"id": TEXT, "sha256": SHA256},
    "seed": INTEGER,
    "settings": {
        "technology": TEXT, "build_mm": (POSITIVE, 3), "layer_mm": POSITIVE, "support_angle_deg": NUMBER,
        "gap_mm": NUMBER, "grid_mm": POSITIVE, "rotation_step_deg": POSITIVE, "objective": TEXT,
        "weight": NUMBER, "wall_mm": NUMBER, "voxel_mm": POSITIVE, "segmentation": TEXT, "clusters": INTEGER,
        "min_glue_area_mm2": NUMBER, "min_volume_fraction": NUMBER, "tabu_memory": INTEGER,
        "tabu_patience": INTEGER},
    "printer": {"build_mm": (POSITIVE, 3), "support_angle_deg": NUMBER},  # and plate_mm, keep_out_mm
    "shell": {"volume_mm3": POSITIVE, "wall_mm": NUMBER},
    "segments": {"tetrahedra": INTEGER, "clusters": INTEGER, "after_premerge": INTEGER, "final": INTEGER},
    "packing": {"weight": NUMBER, "cost": NUMBER, "bbox_mm3": POSITIVE, "support_mm3": NUMBER,
                "height_mm": POSITIVE, "gap_mm": NUMBER, "grid_mm": POSITIVE},
    "parts": [PART],
    "removal_order": [INTEGER],
    "estimates": {"as_is": OBJECT, "solid": OBJECT, "hollow": OBJECT, "packed": OBJECT},
    "timings_s": OBJECT,
    "warnings": [{"code": TEXT, "text": TEXT}],
}
OBJECTIVES = ("paper", "printer", "height")
SEGMENTATIONS = ("paper", "printer")
TECHNOLOGIES = ("polyjet", "fdm", "powder")
DIALECT_SUFFIX = {"gcode": ".gcode", "s3g": ".x3g"}


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _fits(value, kind):
    if kind == INTEGER:
        return isinstance(value, int) and not isinstance(value, bool)
    if kind == NUMBER:
        return _is_number(value)
    if kind == POSITIVE:
        return _is_number(value) and value > 0
    if kind == TEXT:
        return isinstance(value, str) and value != ""
    if kind == BOOLEAN:
        return isinstance(value, bool)
    if kind == SHA256:
        return isinstance(value, str) and re.fullmatch(r"[0-9a-f]{64}", value) is not None
    return isinstance(value, dict)


def mismatches(value, schema, path="job.json"):
    """Every place where value is not what schema says: 'parts[2].id: integer expected'."""
    if isinstance(schema, dict):
        if not isinstance(value, dict):
            return [f"{path}: object expected"]
        found = []
        for key, inner in schema.items():
            if key not in value:
                found.append(f"{path}.{key}: missing")
            else:
                found += mismatches(value[key], inner, f"{path}.{key}")
        return found
    if isinstance(schema, (list, tuple)):
        inner, count = (schema[0], None) if isinstance(schema, list) else schema
        if not isinstance(value, list):
            return [f"{path}: list expected"]
        if count is not None and len(value) != count:
            return [f"{path}: {count} values expected, {len(value)} found"]
        return [line for index, item in enumerate(value) for line in mismatches(item, inner, f"{path}[{index}]")]
    return [] if _fits(value, schema) else [f"{path}: {schema} expected, {value!r:.40} found"]


def check_keys(job, report):
    """Returns whether the rest of the checks can rely on job.json's shape."""
    wrong = mismatches(job.data, JOB)
    whole = report.check("job.json has every key with its type", not wrong, first_few(wrong))
    if not whole:
        return False
    data = job.data
    report.check("job.json version", data["version"] == 1, data["version"])
    settings = data["settings"]
    for key, known in (("objective", OBJECTIVES), ("segmentation", SEGMENTATIONS), ("technology", TECHNOLOGIES)):
        report.check(f"settings.{key} is a known word", settings[key] in known, settings[key])
    same = [(("packing", "weight"), "weight"), (("packing", "gap_mm"), "gap_mm"), (("packing", "grid_mm"), "grid_mm"),
            (("printer", "build_mm"), "build_mm"), (("printer", "support_angle_deg"), "support_angle_deg")]
    differing = [f"{place}.{key}" for (place, key), name in same if data[place][key] != settings[name]]
    report.check("packing and printer repeat the settings", not differing, first_few(differing))
    report.check("warnings tell something", all(w["code"] and w["text"] for w in data["warnings"]),
                 first_few([w["code"] for w in data["warnings"]]))
    slow = [k for k, v in data["timings_s"].items() if not _is_number(v) or v < 0]
    report.check("timings_s are seconds", not slow and len(data["timings_s"]) > 0, first_few(slow))
    return _check_parts(data, report)


def _check_parts(data, report):
    parts, count = data["parts"], len(data["parts"])
    ids = [part["id"] for part in parts]
    report.check("part ids are 1, 2, …", count > 0 and ids == list(range(1, count + 1)), first_few(ids))
    stray = [p["id"] for p in parts if not 0 <= p["model"] < len(data["inputs"])]
    report.check("parts name an input", not stray, first_few(stray))
    trays = sorted({part["tray"] for part in parts})
    consecutive = trays == list(range(1, len(trays) + 1))
    report.check("trays are 1, 2, …, none empty", consecutive, first_few(trays))
    unlisted = [f"{p['id']}-{n['id']}" for p in parts for n in p["neighbours"]
                if n["id"] not in ids or n["id"] == p["id"]]
    report.check("neighbours are other parts", not unlisted, first_few(unlisted))
    area = {(p["id"], n["id"]): n["glue_area_mm2"] for p in parts for n in p["neighbours"]}
    one_sided = [f"{a}-{b}" for (a, b), value in area.items()
                 if abs(area.get((b, a), -1) - value) > 1e-3 * max(1.0, value) or value <= 0]
    report.check("neighbours are mutual, with one positive area", not one_sided, first_few(one_sided))
    misnamed = [p["file"] for p in parts if p["file"] != f"parts/{p['id']:02d}.stl"]
    report.check("part files are parts/NN.stl", not misnamed, first_few(misnamed))
    return len(set(ids)) == count > 0 and not misnamed


def check_files(job, dialect, report):
    """dialect: as profile.toml says; None where it cannot be told."""
    expected = {"job.json", "profile.toml", "preview.glb", "assembly.glb", "preview.png"}
    expected |= {part["file"] for part in job.parts()}
    for tray in job.trays():
        expected |= {tray_file(tray, ".3mf"), tray_file(tray, ".stl")}
        if dialect in DIALECT_SUFFIX:
            expected.add(program_file(tray, DIALECT_SUFFIX[dialect]))
    present = {str(path.relative_to(job.folder)) for path in job.folder.rglob("*") if not path.is_dir()}
    missing = sorted(expected - present)
    report.check("every promised file is there", not missing, "missing " + first_few(missing) if missing else
                 f"{len(expected)} files")
    empty = sorted(name for name in expected & present if (job.folder / name).stat().st_size == 0)
    report.check("no promised file is empty", not empty, first_few(empty))
    pattern = re.compile(r"(tray|program)(-\d+)?\.|parts/")
    extra = sorted(name for name in present - expected if pattern.match(name))
    report.check("no tray, program or part that job.json does not know", not extra, first_few(extra))
