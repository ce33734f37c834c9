"""Embree 4, out of the wheel `embreex`, called without Python in the loop.

The loops over rays are compiled by Numba. They fill Embree's records, call `rtcIntersect1` or its
kin, and store what dapple stores: t, u, v and the number of the triangle.
"""

import ctypes
import importlib.metadata
import math

import numba
import numpy as np

INVALID = np.uint32(0xFFFFFFFF)
VOID = ctypes.c_void_p


def _library():
    files = importlib.metadata.files("embreex")
    found = [file for file in files if "libembree4" in file.name]
    return ctypes.CDLL(str(found[0].locate()))


def _function(library, name, arguments, result=None):
    function = library[name]
    function.argtypes, function.restype = arguments, result
    return function


LIBRARY = _library()
# A scene, a record, and arguments, which are null.
_INTERSECT_1 = _function(LIBRARY, "rtcIntersect1", [VOID] * 3)
_OCCLUDED_1 = _function(LIBRARY, "rtcOccluded1", [VOID] * 3)
# The same, behind a mask of the lanes that are to be shot.
_INTERSECT_16 = _function(LIBRARY, "rtcIntersect16", [VOID] * 4)
_OCCLUDED_16 = _function(LIBRARY, "rtcOccluded16", [VOID] * 4)


def _aligned(count, kind):
    """Zeros at a multiple of 64 bytes, as Embree wants its records."""
    size = np.dtype(kind).itemsize
    memory = np.zeros(count * size + 64, np.uint8)
    start = -memory.ctypes.data % 64
    return memory[start:start + count * size].view(kind)


# The records, in words of four bytes: origin 0-2, t_min 3, direction 4-6, time 7, t_max 8, mask 9,
# id 10, flags 11, normal 12-14, u 15, v 16, triangle 17, mesh 18, instance 19 and 20. With sixteen
# lanes each of these is sixteen words.


@numba.njit
def _closest_1(scene, record, words, rays, hits):
    for i in range(len(rays)):
        for k in range(7):
            record[k] = rays[i, k]
        record[7] = 0
        record[8] = rays[i, 7]
        words[9] = INVALID
        words[10] = 0
        words[11] = 0
        words[18] = INVALID
        words[19] = INVALID
        _INTERSECT_1(scene, record.ctypes, 0)
        missed = words[18] == INVALID
        hits[i, 0] = np.inf if missed else record[8]
        hits[i, 1] = record[15]
        hits[i, 2] = record[16]
        hits[i, 3] = record[17]


@numba.njit
def _any_1(scene, record, words, rays, hits):
    for i in range(len(rays)):
        for k in range(7):
            record[k] = rays[i, k]
        record[7] = 0
        record[8] = rays[i, 7]
        words[9] = INVALID
        words[10] = 0
        words[11] = 0
        _OCCLUDED_1(scene, record.ctypes, 0)
        hits[i] = record[8] < 0


@numba.njit
def _fill_16(record, words, mask, rays, first):
    for lane in range(16):
        inside = first + lane < len(rays)
        mask[lane] = -1 if inside else 0
        if inside:
            for k in range(7):
                record[k * 16 + lane] = rays[first + lane, k]
            record[112 + lane] = 0
            record[128 + lane] = rays[first + lane, 7]
            words[144 + lane] = INVALID
            words[160 + lane] = 0
            words[176 + lane] = 0


@numba.njit
def _closest_16(scene, record, words, mask, rays, hits):
    for first in range(0, len(rays), 16):
        _fill_16(record, words, mask, rays, first)
        for lane in range(16):
            words[288 + lane] = INVALID
            words[304 + lane] = INVALID
        _INTERSECT_16(mask.ctypes, scene, record.ctypes, 0)
        for lane in range(min(16, len(rays) - first)):
            missed = words[288 + lane] == INVALID
            hits[first + lane, 0] = np.inf if missed else record[128 + lane]
            hits[first + lane, 1] = record[240 + lane]
            hits[first + lane, 2] = record[256 + lane]
            hits[first + lane, 3] = record[272 + lane]


@numba.njit
def _any_16(scene, record, words, mask, rays, hits):
    for first in range(0, len(rays), 16):
        _fill_16(record, words, mask, rays, first)
        _OCCLUDED_16(mask.ctypes, scene, record.ctypes, 0)
        for lane in range(min(16, len(rays) - first)):
            hits[first + lane] = record[128 + lane] < 0


class Scene:
    """Triangles in Embree's default mode and default quality of building."""

    def __init__(self, triangles):
        call = lambda name, result, *kinds: _function(LIBRARY, name, kinds, result)
        unsigned, size = ctypes.c_uint, ctypes.c_size_t
        device = call("rtcNewDevice", VOID, ctypes.c_char_p)(b"threads=1,set_affinity=0")
        self.scene = call("rtcNewScene", VOID, VOID)(device)
        mesh = call("rtcNewGeometry", VOID, VOID, unsigned)(device, 0)
        share = call("rtcSetSharedGeometryBuffer", None, VOID, unsigned, unsigned, unsigned, VOID,
                     size, size, size)
        # Embree may read a vector beyond the last vertex.
        self.vertices = _aligned(len(triangles) * 9 + 4, np.float32)
        self.vertices[:-4] = triangles.ravel()
        self.corners = np.arange(len(triangles) * 3, dtype=np.uint32)
        share(mesh, 0, 0, 0x5003, self.corners.ctypes.data, 0, 12, len(triangles))
        share(mesh, 1, 0, 0x9003, self.vertices.ctypes.data, 0, 12, len(triangles) * 3)
        call("rtcCommitGeometry", None, VOID)(mesh)
        call("rtcAttachGeometry", unsigned, VOID, VOID)(self.scene, mesh)
        call("rtcCommitScene", None, VOID)(self.scene)
        self.record, self.mask = _aligned(1024, np.float32), _aligned(16, np.int32)

    def shoot(self, rays, hits, lanes=1):
        """Answers rows of origin, t_min, direction, t_max into `hits`.

        Rows of four floats are the closest hits. Single bytes tell whether anything is hit.
        """
        words = self.record.view(np.uint32)
        closest = hits.ndim == 2
        if lanes == 1:
            run = _closest_1 if closest else _any_1
            run(self.scene, self.record, words, rays, hits)
        else:
            run = _closest_16 if closest else _any_16
            run(self.scene, self.record, words, self.mask, rays, hits)


def room_for_hits(count, closest):
    """An array for the answers to so many rays."""
    return np.zeros((count, 4), np.float32) if closest else np.zeros(count, np.uint8)


def hit_count(hits):
    """How many rays hit anything."""
    return int((hits[:, 0] < math.inf).sum() if hits.ndim == 2 else hits.sum())
