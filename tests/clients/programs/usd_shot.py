"""A shot in USD, as usd-core writes and reads it.

    usd_shot.py plain SHOT.usd* CLOTH.obj CACHE.pc2
    usd_shot.py composed SHOT.usd* CLOTH.obj CACHE.pc2
    usd_shot.py behind SHOT.usd* CLOTH.obj CACHE.pc2
    usd_shot.py missing SHOT.usd*
    usd_shot.py points STAGE.usd* PRIM CACHE.pc2
    usd_shot.py compare SHOT.usd* FIX.usda PRIM
    usd_shot.py join FIX.usda PART.usda...

`plain` makes a stage with the frames of a vertex cache from time code 1 on. `composed` brings it in by a payload, a
variant and a sublayer, in centimetres, below transforms that move. `behind` refers to prims that get what they are by
the arcs and variants of those above them. `missing` makes a stage of a mesh and of arcs that lead nowhere or back, and
of each of these one in which it is the only one. `points` writes the points of a mesh as a cache. `compare` opens a
layer over a stage: everything but the points must be that of the stage. `join` puts parts into one layer, as the manual
shows.
"""

import os
import struct
import sys

import numpy
from pxr import Gf, Sdf, Usd, UsdGeom, UsdUtils, Vt

CLOTH = "/world/garment/cloth"


def frames_of(path):
    data = open(path, "rb").read()
    num_vertices, _, _, num_frames = struct.unpack("<iffi", data[16:32])
    return numpy.frombuffer(data, "<f4", offset=32).reshape(num_frames, num_vertices, 3)


def faces_of(path):
    lines = [line.split() for line in open(path) if line.startswith("f ")]
    return [[int(corner.split("/")[0]) - 1 for corner in line[1:]] for line in lines]


def plain(shot, cloth, cache, scale=1.0):
    frames, faces = frames_of(cache), faces_of(cloth)
    stage = Usd.Stage.CreateNew(shot)
    UsdGeom.SetStageMetersPerUnit(stage, scale)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(len(frames))
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/world").GetPrim())
    UsdGeom.Camera.Define(stage, "/world/camera").CreateFocalLengthAttr(35.0)
    UsdGeom.Xform.Define(stage, "/world/garment")
    mesh = UsdGeom.Mesh.Define(stage, CLOTH)
    mesh.CreateFaceVertexCountsAttr([len(face) for face in faces])
    mesh.CreateFaceVertexIndicesAttr([corner for face in faces for corner in face])
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateDisplayColorAttr([Gf.Vec3f(0.5, 0.1, 0.7)])
    for number, frame in enumerate(frames):
        points = Vt.Vec3fArray.FromNumpy(numpy.ascontiguousarray(frame / scale, "<f4"))
        mesh.GetPointsAttr().Set(points, number + 1)
    stage.Save()
    return len(frames)


def composed(shot, cloth, cache):
    folder, name = os.path.split(shot)
    asset, moves = os.path.join(folder, "asset_" + name), os.path.join(folder, "moves_" + name)
    num_frames = plain(asset, cloth, cache, 0.01)
    layer = Usd.Stage.CreateNew(moves)
    garment = UsdGeom.Xform(layer.OverridePrim("/set/garment"))
    turn, shift = garment.AddRotateXYZOp(), garment.AddTranslateOp(opSuffix="pivot")
    for time in range(1, num_frames + 1, 2):
        turn.Set(Gf.Vec3f(time, 10, -20), time)
        shift.Set(Gf.Vec3d(100 + time, 0, 7), time)
    layer.Save()
    stage = Usd.Stage.CreateNew(shot)
    stage.GetRootLayer().subLayerPaths = ["./" + os.path.basename(moves)]
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    stage.SetTimeCodesPerSecond(24)
    prim = stage.DefinePrim("/set", "Xform")
    stage.SetDefaultPrim(prim)
    sizes = prim.GetVariantSets().AddVariantSet("size")
    for size in ["small", "large"]:
        sizes.AddVariant(size)
    sizes.SetVariantSelection("large")
    with sizes.GetVariantEditContext():
        prim.GetPayloads().AddPayload("./" + os.path.basename(asset), "/world")
        UsdGeom.Xform(prim).AddScaleOp().Set(Gf.Vec3f(1, 1, 2))
    stage.Save()


def behind(shot, cloth, cache):
    folder, name = os.path.split(shot)
    asset, library = os.path.join(folder, "behind_" + name), os.path.join(folder, "library_" + name)
    plain(asset, cloth, cache)
    stage = Usd.Stage.CreateNew(library)
    UsdGeom.SetStageMetersPerUnit(stage, 1)
    stage.DefinePrim("/lib").GetReferences().AddReference("./" + os.path.basename(asset), "/world")
    kinds = stage.DefinePrim("/kinds").GetVariantSets().AddVariantSet("kind")
    kinds.AddVariant("one")
    kinds.SetVariantSelection("one")
    with kinds.GetVariantEditContext():
        stage.DefinePrim("/kinds/one").GetReferences().AddInternalReference("/lib/garment")
    stage.Save()
    stage = Usd.Stage.CreateNew(shot)
    UsdGeom.SetStageMetersPerUnit(stage, 1)
    root = stage.DefinePrim("/set", "Xform")
    stage.SetDefaultPrim(root)
    above = stage.DefinePrim("/set/above")
    above.GetReferences().AddReference("./" + os.path.basename(library), "/lib/garment")
    variant = stage.DefinePrim("/set/variant")
    variant.GetPayloads().AddPayload("./" + os.path.basename(library), "/kinds/one")
    assert not stage.GetCompositionErrors()
    stage.Save()


def missing(shot):
    stage = Usd.Stage.CreateNew(shot)
    UsdGeom.SetStageMetersPerUnit(stage, 1)
    mesh = UsdGeom.Mesh.Define(stage, "/set/cloth")
    mesh.CreateFaceVertexCountsAttr([3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    stage.DefinePrim("/set/reference").GetReferences().AddInternalReference("/none")
    stage.DefinePrim("/set/payload").GetPayloads().AddInternalPayload("/set/cloth/none")
    stage.DefinePrim("/set/cycle/below").GetReferences().AddInternalReference("/set/cycle")
    stage.Save()
    for name in ["reference", "payload", "cycle"]:
        own = Usd.Stage.CreateInMemory()
        own.GetRootLayer().subLayerPaths = [os.path.abspath(shot)]
        for other in {"reference", "payload", "cycle"} - {name}:
            own.OverridePrim("/set/" + other).SetActive(False)
        # USD draws the one mesh, and says what it left out to those who ask.
        assert [prim.GetPath() for prim in own.Traverse() if prim.IsA(UsdGeom.Mesh)] == ["/set/cloth"]
        assert own.GetCompositionErrors(), name
        own.GetRootLayer().Export(os.path.join(os.path.dirname(shot), name + ".usda"))


def mesh_of(stage, prim):
    mesh = UsdGeom.Mesh.Get(stage, prim)
    assert mesh, prim
    return mesh


def points(stage, prim, cache):
    stage = Usd.Stage.Open(stage)
    attribute = mesh_of(stage, prim).GetPointsAttr()
    times = attribute.GetTimeSamples()
    assert times == [float(number + 1) for number in range(len(times))], times
    frames = [numpy.array(attribute.Get(time), "<f4") for time in times]
    with open(cache, "wb") as file:
        file.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, len(frames[0]), 1.0, 1.0, len(frames)))
        file.writelines(frame.tobytes() for frame in frames)


def compare(shot, fix, prim):
    below, above = Usd.Stage.Open(shot), Usd.Stage.Open(fix)
    assert not above.GetCompositionErrors()
    for name in ["startTimeCode", "endTimeCode", "timeCodesPerSecond", "metersPerUnit", "upAxis", "defaultPrim"]:
        assert above.GetMetadata(name) == below.GetMetadata(name), name
    own, other = ([prim for prim in stage.Traverse()] for stage in (below, above))
    assert [prim.GetPath() for prim in own] == [prim.GetPath() for prim in other]
    corrected = mesh_of(below, prim).GetPointsAttr().GetPath()
    for a, b in zip(own, other):
        assert a.GetTypeName() == b.GetTypeName()
        assert [x.GetName() for x in a.GetAttributes()] == [x.GetName() for x in b.GetAttributes()]
        for x, y in zip(a.GetAttributes(), b.GetAttributes()):
            assert x.GetTimeSamples() == y.GetTimeSamples(), x
            if x.GetPath() != corrected:
                assert [x.Get(time) for time in x.GetTimeSamples()] == [y.Get(time) for time in y.GetTimeSamples()], x
                assert x.Get() == y.Get(), x
    # The layer says nothing but points.
    specs = []
    layer = Sdf.Layer.FindOrOpen(fix)
    layer.Traverse("/", specs.append)
    assert [path for path in specs if path.IsPropertyPath()] == [corrected], specs
    for path in specs:
        assert not path.IsPrimPath() or layer.GetPrimAtPath(path).specifier == Sdf.SpecifierOver, path
    assert len(layer.subLayerPaths) == 1


def join(out, *parts):
    whole = Sdf.Layer.FindOrOpen(parts[0])
    for part in parts[1:]:
        UsdUtils.StitchLayers(whole, Sdf.Layer.FindOrOpen(part))
    whole.Export(out)


commands = {function.__name__: function for function in [plain, composed, behind, missing, points, compare, join]}
commands[sys.argv[1]](*sys.argv[2:])
