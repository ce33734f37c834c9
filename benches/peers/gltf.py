"""The part of glTF 2.0 that dapple and Mitsuba 3 both render alike.

Triangles with transforms, a perspective camera, directional and point lights, emitters that shine
from their front, and metallic-roughness materials without textures. All else raises `LeftOut`, with
the reason. `common_copy` writes a copy of a scene for both, without what Mitsuba lacks.
"""

import json
import math
import struct

import numpy as np

KNOWN = {"KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_specular"}
TYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class LeftOut(Exception):
    """Why a scene is not compared."""


def read(path):
    """The JSON of a scene and its one buffer."""
    data = path.read_bytes()
    if data[:4] == b"glTF":
        length = struct.unpack_from("<I", data, 12)[0]
        return json.loads(data[20:20 + length]), data[28 + length:]
    scene = json.loads(data)
    if len(scene["buffers"]) != 1:
        raise LeftOut("more than one buffer")
    return scene, (path.parent / scene["buffers"][0]["uri"]).read_bytes()


def common_copy(source, target, diffuse=False):
    """Writes a scene as .glb: no ranges of lights, no spot lights, and maybe all diffuse.

    Mitsuba has no ranges, and its spot lights fade in another way.
    """
    scene, data = read(source)
    lights = scene.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
    for light in lights:
        light.pop("range", None)
    for node in scene["nodes"]:
        told = node.get("extensions", {}).get("KHR_lights_punctual")
        if told and lights[told["light"]]["type"] == "spot":
            del node["extensions"]["KHR_lights_punctual"]
    if diffuse:
        used = scene.setdefault("extensionsUsed", [])
        if "KHR_materials_specular" not in used:
            used.append("KHR_materials_specular")
        for material in scene["materials"]:
            material["pbrMetallicRoughness"] |= {"metallicFactor": 0, "roughnessFactor": 1}
            extensions = material.setdefault("extensions", {})
            extensions["KHR_materials_specular"] = {"specularFactor": 0}
    scene["buffers"][0].pop("uri", None)
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    total = 28 + len(text) + len(data)
    head = struct.pack("<4sIIII", b"glTF", 2, total, len(text), 0x4E4F534A)
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(head + text + struct.pack("<II", len(data), 0x004E4942) + data)


class Material:
    """What both renderers are told of a surface."""

    def __init__(self, told):
        kept = {"name", "pbrMetallicRoughness", "emissiveFactor", "extensions", "doubleSided",
                "alphaMode", "alphaCutoff", "extras"}
        pbr = told.get("pbrMetallicRoughness", {})
        if any("Texture" in key for key in [*told, *pbr]):
            raise LeftOut("textures")
        if set(told) - kept or told.get("alphaMode", "OPAQUE") != "OPAQUE":
            raise LeftOut("holes or other features of materials")
        extensions = told.get("extensions", {})
        if set(extensions) - KNOWN:
            raise LeftOut("materials beyond metallic-roughness")
        specular = extensions.get("KHR_materials_specular", {})
        if set(specular) - {"specularFactor"}:
            raise LeftOut("coloured specular reflection")
        self.base = np.array(pbr.get("baseColorFactor", [1, 1, 1, 1])[:3], float)
        self.metallic = float(pbr.get("metallicFactor", 1))
        self.roughness = float(pbr.get("roughnessFactor", 1))
        self.specular = float(specular.get("specularFactor", 1))
        strength = extensions.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
        self.emission = np.array(told.get("emissiveFactor", [0, 0, 0]), float) * strength
        if self.emission.any() and told.get("doubleSided"):
            raise LeftOut("emitters that shine from both sides")

    @property
    def is_diffuse(self):
        return self.metallic == 0 and self.specular == 0


class Mesh:
    """All triangles of a material, in the world; `normals` is None for flat ones."""

    def __init__(self, material, positions, normals, faces):
        self.material, self.faces = material, faces
        self.positions, self.normals = positions, normals


class Scene:
    """What a file holds, with everything placed in the world."""

    def __init__(self, path):
        self.json, self.data = read(path)
        beyond = set(self.json.get("extensionsUsed", [])) - KNOWN
        if beyond:
            raise LeftOut(", ".join(sorted(beyond)))
        self.materials = [Material(told) for told in self.json.get("materials", [])]
        self.meshes, self.lights, self.camera = [], [], None
        self._parts = {}
        roots = self.json["scenes"][self.json.get("scene", 0)]["nodes"]
        for root in roots:
            self._visit(self.json["nodes"][root], np.eye(4))
        for (material, _), parts in self._parts.items():
            self.meshes.append(_joined(self.materials[material], parts))
        if self.camera is None:
            raise LeftOut("no camera")
        if not self.lights and not any(mesh.material.emission.any() for mesh in self.meshes):
            raise LeftOut("no light of its own")

    def triangles(self):
        """All triangles as rows of nine numbers."""
        rows = [mesh.positions[mesh.faces].reshape(-1, 9) for mesh in self.meshes]
        return np.concatenate(rows).astype(np.float32)

    def _visit(self, node, above):
        matrix = above @ _transform(node)
        extensions = node.get("extensions", {})
        if set(extensions) - KNOWN or "skin" in node:
            raise LeftOut("instances by extension, or skins")
        if "mesh" in node:
            self._place(self.json["meshes"][node["mesh"]], matrix)
        if "camera" in node and self.camera is None:
            self.camera = self._lens(node["camera"]), matrix
        if "KHR_lights_punctual" in extensions:
            lights = self.json["extensions"]["KHR_lights_punctual"]["lights"]
            light = lights[extensions["KHR_lights_punctual"]["light"]]
            if light["type"] == "spot" or "range" in light:
                raise LeftOut("spot lights or ranges; see common_copy")
            self.lights.append((light, matrix))
        for child in node.get("children", []):
            self._visit(self.json["nodes"][child], matrix)

    def _lens(self, index):
        camera = self.json["cameras"][index]
        if camera["type"] != "perspective":
            raise LeftOut("a camera that is not perspective")
        return camera["perspective"]

    def _place(self, mesh, matrix):
        for primitive in mesh["primitives"]:
            if primitive.get("mode", 4) != 4 or "targets" in primitive or "extensions" in primitive:
                raise LeftOut("other primitives than plain triangles")
            attributes = primitive["attributes"]
            positions = self._accessor(attributes["POSITION"]).astype(float)
            faces = np.arange(len(positions))
            if "indices" in primitive:
                faces = self._accessor(primitive["indices"]).ravel().astype(np.int64)
            faces = faces.reshape(-1, 3)
            if np.linalg.det(matrix[:3, :3]) < 0:
                faces = faces[:, ::-1]
            normals = None
            if "NORMAL" in attributes:
                normals = self._accessor(attributes["NORMAL"]) @ np.linalg.inv(matrix[:3, :3])
                normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
            positions = positions @ matrix[:3, :3].T + matrix[:3, 3]
            key = primitive["material"], normals is not None
            self._parts.setdefault(key, []).append((positions, normals, faces))

    def _accessor(self, index):
        told = self.json["accessors"][index]
        if "sparse" in told or told.get("normalized") or "bufferView" not in told:
            raise LeftOut("sparse or packed accessors")
        view = self.json["bufferViews"][told["bufferView"]]
        kind, width = np.dtype(TYPES[told["componentType"]]), WIDTHS[told["type"]]
        stride = view.get("byteStride", kind.itemsize * width)
        start = view.get("byteOffset", 0) + told.get("byteOffset", 0)
        shape, strides = (told["count"], width), (stride, kind.itemsize)
        return np.ndarray(shape, kind, self.data, start, strides).copy()


def _joined(material, parts):
    before, positions, normals, faces = 0, [], [], []
    for position, normal, face in parts:
        positions.append(position)
        normals.append(normal)
        faces.append(face + before)
        before += len(position)
    normals = None if normals[0] is None else np.concatenate(normals)
    return Mesh(material, np.concatenate(positions), normals, np.concatenate(faces))


def _transform(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    turn = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])
    matrix = np.eye(4)
    matrix[:3, :3] = turn * np.array(node.get("scale", [1, 1, 1]), float)
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix


def to_mitsuba(scene, width, height, depth, roulette, sampler):
    """The scene as Mitsuba's, for the variant that is set."""
    import mitsuba as mi

    import bsdf

    bsdf.register()
    lens, matrix = scene.camera
    # glTF looks along -Z with X to the right, Mitsuba along +Z with X to the left.
    place = matrix @ np.diag([-1.0, 1.0, -1.0, 1.0])
    place[:3, :3] /= np.linalg.norm(place[:3, :3], axis=0)
    told = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": depth, "rr_depth": roulette},
        "sensor": {
            "type": "perspective", "fov_axis": "y", "fov": math.degrees(lens["yfov"]),
            "near_clip": 1e-3, "far_clip": 1e6,
            "to_world": mi.ScalarTransform4f(place.tolist()),
            "sampler": {"type": sampler},
            "film": {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb",
                     "component_format": "float32", "rfilter": {"type": "box"}},
        },
    }
    for number, mesh in enumerate(scene.meshes):
        told[f"mesh{number}"] = _mitsuba_mesh(mi, mesh, number)
    for number, (light, matrix) in enumerate(scene.lights):
        power = np.array(light.get("color", [1, 1, 1]), float) * light.get("intensity", 1)
        if light["type"] == "directional":
            told[f"light{number}"] = {"type": "directional", "irradiance": _rgb(power),
                                      "direction": (-matrix[:3, 2]).tolist()}
        else:
            told[f"light{number}"] = {"type": "point", "intensity": _rgb(power),
                                      "position": matrix[:3, 3].tolist()}
    # Plugins in Python may deadlock where a scene is loaded in parallel.
    return mi.load_dict(told, parallel=False)


def _rgb(value):
    return {"type": "rgb", "value": [float(x) for x in value]}


def _mitsuba_mesh(mi, mesh, number):
    material = mesh.material
    if material.is_diffuse:
        surface = {"type": "diffuse", "reflectance": _rgb(material.base)}
    else:
        surface = {"type": "metallic_roughness", "metallic": material.metallic,
                   "roughness": material.roughness, "specular": material.specular,
                   **{f"base_{c}": float(x) for c, x in zip("rgb", material.base)}}
    properties = mi.Properties()
    twosided = {"type": "twosided", "surface": surface}
    properties["surface"] = mi.load_dict(twosided, parallel=False)
    if material.emission.any():
        light = {"type": "area", "radiance": _rgb(material.emission)}
        properties["light"] = mi.load_dict(light, parallel=False)
    made = mi.Mesh(f"mesh{number}", len(mesh.positions), len(mesh.faces), props=properties,
                   has_vertex_normals=mesh.normals is not None)
    values = mi.traverse(made)
    values["vertex_positions"] = mesh.positions.astype(np.float32).ravel()
    values["faces"] = mesh.faces.astype(np.uint32).ravel()
    if mesh.normals is not None:
        values["vertex_normals"] = mesh.normals.astype(np.float32).ravel()
    values.update()
    return made
