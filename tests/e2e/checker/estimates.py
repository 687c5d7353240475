"""The four estimates of job.json."""
import re

from .contract import BOOLEAN, INTEGER, NUMBER, TEXT, mismatches
from .report import first_few

FIGURES = {"time_s": NUMBER, "model_mm3": NUMBER, "model_g": NUMBER, "support_mm3": NUMBER, "support_g": NUMBER,
           "cost": NUMBER, "material_cost": NUMBER, "machine_cost": NUMBER, "hands_cost": NUMBER, "parts": INTEGER, "trays": INTEGER, "assembly_min": NUMBER}
WAYS = ("as_is", "solid", "hollow", "packed")


def faults(estimate, name):
    """What is wrong with one estimate's shape."""
    found = mismatches(estimate, {"fits": BOOLEAN}, name)
    if found:
        return found
    if not estimate["fits"]:
        return [f"{name}.{key}: null expected" for key in FIGURES if estimate.get(key, "missing") is not None]
    found = mismatches(estimate, FIGURES | {"currency": TEXT, "source": TEXT}, name)
    if found:
        return found
    found += [f"{name}.{key}: negative" for key in FIGURES if estimate[key] < 0]
    found += [f"{name}.{key}: positive expected" for key in ("time_s", "model_mm3", "model_g", "parts", "trays")
              if estimate[key] <= 0]
    sums = sum(estimate[key] for key in ("material_cost", "machine_cost", "hands_cost"))
    if abs(sums - estimate["cost"]) > 1e-6 * max(1, sums):
        found.append(f"{name}.cost: {estimate['cost']} is not material, machine and hands, {sums}")
    if not re.fullmatch(r"[A-Z]{3}", estimate["currency"]):
        found.append(f"{name}.currency: three capitals expected, {estimate['currency']}")
    if estimate["source"] not in ("model", "slicer"):
        found.append(f"{name}.source: model or slicer expected, {estimate['source']}")
    return found


def check_estimates(job, report):
    estimates = job.data["estimates"]
    wrong = [line for way in WAYS for line in faults(estimates[way], way)]
    if not report.check("estimates are complete", not wrong, first_few(wrong)):
        return
    for way in WAYS:
        e = estimates[way]
        report.note(f"estimate {way}", f"{e['time_s'] / 3600:.2f} h, {e['support_mm3'] / 1000:.1f} cm³ support, "
                    f"{e['cost']:.2f} {e['currency']}, {e['source']}" if e["fits"] else "does not fit")
    packed = estimates["packed"]
    if job.data.get("variant", "packed") == "packed":
        report.check("estimates.packed counts the parts and trays",
                     packed["fits"] and (packed["parts"], packed["trays"]) == (len(job.parts()), len(job.trays())),
                     f"{packed['parts']} parts on {packed['trays']} trays")
    as_is, solid = estimates["as_is"], estimates["solid"]
    if as_is["fits"] and solid["fits"] and solid["source"] == "model":
        # six ways up are ranked by the analytic estimate: where the slicer speaks, its order may differ
        report.check("solid, the best way up, costs no more than as_is", solid["cost"] <= as_is["cost"] * (1 + 1e-6),
                     f"{solid['cost']:.3f} and {as_is['cost']:.3f}")
