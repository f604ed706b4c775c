"""The UTIAS recording, and its cut that ships; `python tests/support/utias_cut.py` cuts the whole."""

from functools import cache

import numpy as np
from needs import missing
from scipy.io import loadmat, savemat

from percept_obs.recording.stereo_mat import LANDMARKS, NOT_SEEN, VARIABLES, read_stereo_mat
from percept_obs.recording.utias import UTIAS_CUT, find_utias

HEADER = b"MATLAB 5.0 MAT-file: a cut of dataset3.mat of the STARS Laboratory; see LICENSE".ljust(116)


@cache
def whole():
    """The file of the whole recording; skip the test where it cannot be had."""
    found = find_utias()
    return missing("utias", "The whole UTIAS recording is not here.") if found == UTIAS_CUT else found


def cut(recording):
    """What the conversion reads of the recording: nothing of the images is left but the tracks."""
    recorded = loadmat(recording, variable_names=(*VARIABLES, LANDMARKS))
    images = np.moveaxis(read_stereo_mat(recording).images, -1, 0)
    kept = {name: recorded[name] for name in (*VARIABLES, LANDMARKS)}
    return kept | {"y_k_j": np.where(np.isnan(images), NOT_SEEN, images)}


def write(variables, file):
    """Write variables to a file whose header has no date, so that it is the same whenever it is written."""
    savemat(file, variables, do_compression=True)
    with file.open("r+b") as opened:
        opened.write(HEADER)


if __name__ == "__main__":
    write(cut(whole()), UTIAS_CUT)
    print(f"{UTIAS_CUT}: {UTIAS_CUT.stat().st_size} bytes")
