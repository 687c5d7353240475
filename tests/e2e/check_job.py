#!/usr/bin/python3
"""check_job.py JOB_FOLDER [--model FILE …] [--json]: reopens a job folder and verifies what job.json promises.

One line a check, with figures. Exits 0 when everything holds, 1 when a promise is broken, 2 on wrong usage.
Needs Debian's python3, numpy and scipy; shares nothing with PackMerger.
"""
import argparse
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from checker import assembly, contract, documents, estimates, figures, pictures, removal, separation, solids
from checker.job import Job
from checker.report import Report


def check(folder, models):
    """The full report on one job folder; models are the input files, in any order."""
    report = Report()
    try:
        job = Job(folder)
    except (OSError, ValueError) as error:
        report.check("job.json is JSON of finite numbers", False, error)
        return report
    report.check("job.json is JSON of finite numbers", True)
    if not contract.check_keys(job, report):
        return report
    profile = documents.read_profile(job, report)
    dialect = profile.get("dialect")
    contract.check_files(job, dialect, report)
    job.read_parts(report)
    estimates.check_estimates(job, report)
    if not job.triangles:
        return report
    solids.check_solids(job, report)
    trees = separation.check_gap(job, report)
    removal.check_removal(job, trees, report)
    figures.check_figures(job, report)
    assembly.check_assembly(job, models, report)
    for tray in job.trays():
        documents.check_tray_stl(job, tray, report)
        documents.check_3mf(job, tray, report)
        documents.check_program(job, tray, dialect, report)
    pictures.check_png(job, report)
    pictures.check_glb(job, "preview.glb", lambda part: job.triangles[part["id"]], report)
    pictures.check_glb(job, "assembly.glb", job.in_model, report)
    return report


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--model", action="append", nargs="+", default=[], help="the input file; several in any order")
    parser.add_argument("--json", action="store_true", help="the checks as a JSON list")
    arguments = parser.parse_args()
    report = check(arguments.folder, [path for paths in arguments.model for path in paths])
    failures = report.failures()
    if arguments.json:
        print(json.dumps(report.rows, indent=1, ensure_ascii=False))
    else:
        print("\n".join(report.lines()))
        print(f"{len(failures)} of {sum(row['result'] in ('ok', 'FAIL') for row in report.rows)} checks failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
