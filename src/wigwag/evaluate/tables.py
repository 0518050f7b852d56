"""Tables of the README and the docs, generated from what the commands wrote.

Run ``python -m wigwag.evaluate.tables README.md demo=a.json,b.json utd=utd.json lift=lift.json`` to write
them between the page's markers.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from wigwag.errors import InputError
from wigwag.evaluate.markdown import Records
from wigwag.evaluate.stream.tables import stream_table
from wigwag.evaluate.tables_flight import demo_table, faults_table, follow_table
from wigwag.evaluate.tables_pose import (
    camera_table,
    far_table,
    lift_table,
    monocular_table,
    operator_table,
    pose_table,
    smooth_table,
)
from wigwag.evaluate.tables_product import console_table, mission_table, record_table, teach_table
from wigwag.evaluate.tables_recognise import (
    dtw_table,
    few_shot_table,
    gallery_table,
    recognition_table,
    reject_table,
    transfer_table,
)

BEGIN, END = "<!-- results: begin -->", "<!-- results: end -->"

PARTS: dict[str, tuple[str, Callable[[Records], str]]] = {
    "demo": ("The whole chain, simulated (`wigwag demo --seed N`):", demo_table),
    "utd": (
        "UTD-MHAD skeletons (`wigwag benchmark utd-mhad --data DIR --json FILE`), one thread, from a raw "
        "clip to a label. On the random split every test person is also in training; cross-subject and "
        "leave-one-subject-out meet people never seen:",
        recognition_table,
    ),
    "lift": (
        "Lifting on UTD-MHAD's real Kinect depth (`wigwag benchmark lift --data DIR --json FILE`), "
        "offsets and stated standard deviations fitted on subjects 1, 3, 5, 7 and judged on 2, 4, 6, 8 "
        "(Gaussian errors would lie within one by 68 %, within two by 95 %):",
        lift_table,
    ),
    "far": (
        "Small people in clutter (`wigwag benchmark far --data DIR --json FILE`), the operator photos shrunk "
        "and set before other photos' rooms, 640x480:",
        far_table,
    ),
    "pose": (
        "Pose engines in one run on one core (`wigwag benchmark pose --photos DIR --models lite full heavy "
        "--json FILE`), processor time. `detect`: a picture that stands for itself; `track`: somebody is "
        "followed; `search`: nobody is there. `apart`: between the engines, median over all landmarks:",
        pose_table,
    ),
    "camera": (
        "From a frame with depth, 640x480, to the operator's 3-D pose, one core (`wigwag benchmark camera "
        "--json FILE`):",
        camera_table,
    ),
    "operator": (
        "The operator among passers-by (`wigwag benchmark operator --json FILE`), rendered: kept means "
        "handed on again within 1.5 s after the passer-by is clear (11 s where the operator had walked off "
        "and has to engage again), and nobody else's pose meanwhile:",
        operator_table,
    ),
    "smooth": (
        "The filter in space (`wigwag benchmark smooth --data DIR --json FILE`), UTD-MHAD's fastest swings "
        "by people 2, 4, 6, 8; lag and overshoot without noise, errors with it:",
        smooth_table,
    ),
    "monocular": (
        "People without depth (`wigwag benchmark monocular --json FILE`), rendered, beside the same "
        "people by depth:",
        monocular_table,
    ),
    "few-shot": (
        "Few examples (`wigwag benchmark few-shot --data DIR --json FILE`), UTD-MHAD, 27 classes, test "
        "people 2, 4, 6, 8. `others`: so many examples a gesture from people 1, 3, 5, 7; `own+others`: "
        "everything from those, and so many of the person's own, enrolled; `own`: the person's own alone:",
        few_shot_table,
    ),
    "reject": (
        "Saying no (`wigwag benchmark reject --data DIR --json FILE`), UTD-MHAD, taught by people 1, 3, 5, "
        "7, judged on 2, 4, 6, 8:",
        reject_table,
    ),
    "transfer": (
        "Another data set, no setting touched (`wigwag benchmark transfer --data DIR --json FILE`): "
        "MSR-Action3D, odd subjects, 20 actions, leaving one person out:",
        transfer_table,
    ),
    "stream": (
        "Commands in streams (`wigwag benchmark stream --data-dir DIR --json FILE`). `utd-mhad`: streams "
        "assembled of people 2, 4, 6, 8, taught by 1, 3, 5, 7; `own`: of a person who enrolled one example "
        "of each gesture; `msrc12`: its 12 gestures, people left out in five folds, F1 of action points "
        "within 333 ms; the others hold no command. The interval is the exact Poisson one of a single pass "
        "over the material (distinct hours). Twins are everyday movements that are a gesture by another "
        "name, such as standing up:",
        stream_table,
    ),
    "dtw": (
        "Dynamic time warping of one query against 688 references of 64 frames, one thread, the libraries in "
        "turn in one process (`wigwag benchmark dtw --data DIR --json FILE`):",
        dtw_table,
    ),
    "faults": (
        "Faults in flight (`wigwag benchmark faults --json FILE`):",
        faults_table,
    ),
    "follow": (
        "A person who walks an arc at 0.75 m/s for a minute, and every command, with late frames, noise and "
        "gusts (`wigwag benchmark follow --json FILE`):",
        follow_table,
    ),
    "mission": (
        "A whole flight on a vehicle (`wigwag benchmark mission --vehicle ADDRESS --json FILE`): take off, "
        "follow a person who walks an arc, obey six commands by gesture, land:",
        mission_table,
    ),
    "teach": (
        "Two new gestures, each taught by three showings of one simulated person and shown to a drone by "
        "another, through rendered pixels (`wigwag benchmark teach --json FILE`):",
        teach_table,
    ),
    "record": (
        "A recorded flight, 640x480 at 30 Hz (`wigwag benchmark record --json FILE`), processor time; 10 "
        "minutes are 18000 frames:",
        record_table,
    ),
    "console": (
        "Viewers of the console, which run on the same machine (`wigwag benchmark console --json FILE`); "
        "with and without them by turns, medians:",
        console_table,
    ),
    "gallery": (
        "A growing gallery (`wigwag benchmark gallery --data DIR --json FILE`), varied copies of UTD-MHAD's "
        "training clips, queries by its test clips:",
        gallery_table,
    ),
}
"""What can stand between the markers: its heading line, and what lays its records out."""


def fill(page: Path, parts: Mapping[str, Sequence[Path]]) -> None:
    """Write tables between a page's markers, in the order they are named.

    Args:
        page: A Markdown page.
        parts: Names of ``PARTS`` and the files their records are in, joined in that order.

    Raises:
        InputError: If the markers are missing, or there is no such part.
    """
    text = page.read_text("utf-8")
    if BEGIN not in text or END not in text:
        raise InputError(f"{page}: expected the markers {BEGIN} and {END}, but they are not there.")
    sections = []
    for name, files in parts.items():
        if name not in PARTS:
            raise InputError(f"There is no table {name!r}. Available tables: {', '.join(PARTS)}.")
        note, lay_out = PARTS[name]
        read = [json.loads(f.read_text("utf-8")) for f in files]
        records = [
            record for content in read for record in (content if isinstance(content, list) else [content])
        ]
        sections.append(f"{note}\n\n{lay_out(records)}")
    before, after = text[: text.index(BEGIN)], text[text.index(END) :]
    page.write_text(before + BEGIN + "\n" + "\n\n".join(sections) + "\n" + after, encoding="utf-8")


if __name__ == "__main__":
    target, *named = sys.argv[1:]
    fill(Path(target), {n.split("=")[0]: [Path(f) for f in n.split("=")[1].split(",")] for n in named})
