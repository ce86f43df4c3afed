"""Runs inside Blender: builds a scene of this project and renders it with Cycles on one thread of the CPU.

    blender --background --factory-startup --python render_in_cycles.py -- SCENE WIDTH HEIGHT SEED SAMPLES OUTPUT.exr

Prints "cpu_seconds X": CPU time of the samples alone, without Blender's start, the scene and the file. For that a
picture of one sample is rendered first, and its time is taken off.
"""

import math
import pathlib
import sys
import time
import tomllib

import bpy
from mathutils import Euler, Matrix, Vector


def read_mtl(path):
    """Kd and Ke of each material, linear RGB."""
    materials = {}
    for line in path.read_text().splitlines():
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if words[0] == "newmtl":
            materials[words[1]] = current = {}
        elif words[0] in ("Kd", "Ke"):
            current[words[0]] = [float(word) for word in words[1:4]]
    return materials


class ObjFile:
    """What this project's OBJ files use: v, vn, f, mtllib, usemtl."""

    def __init__(self, path):
        self.vertices, self.normals, self.faces, self.face_normals, self.face_materials = [], [], [], [], []
        self.materials = {}
        name = None
        for line in path.read_text().splitlines():
            words = line.split()
            if not words or words[0].startswith("#"):
                continue
            if words[0] == "mtllib":
                self.materials.update(read_mtl(path.parent / words[1]))
            elif words[0] == "usemtl":
                name = words[1]
            elif words[0] == "v":
                self.vertices.append([float(word) for word in words[1:4]])
            elif words[0] == "vn":
                self.normals.append([float(word) for word in words[1:4]])
            elif words[0] == "f":
                corners = [word.split("/") for word in words[1:]]
                self.faces.append([int(corner[0]) - 1 for corner in corners])
                self.face_normals.append([int(corner[2]) - 1 if len(corner) > 2 else None for corner in corners])
                self.face_materials.append(name)


def new_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    return material, material.node_tree.nodes, material.node_tree.links


def diffuse_material(name, reflectance, emission=None):
    """Lambert; emits from the front only, as this project's lights do."""
    material, nodes, links = new_material(name)
    output = nodes.new("ShaderNodeOutputMaterial")
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*reflectance, 1)
    diffuse.inputs["Roughness"].default_value = 0
    if not emission or not any(emission):
        links.new(diffuse.outputs[0], output.inputs["Surface"])
        return material
    emit = nodes.new("ShaderNodeEmission")
    emit.inputs["Color"].default_value = (*emission, 1)
    both = nodes.new("ShaderNodeAddShader")
    links.new(diffuse.outputs[0], both.inputs[0])
    links.new(emit.outputs[0], both.inputs[1])
    side = nodes.new("ShaderNodeMixShader")
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"], side.inputs["Fac"])
    links.new(both.outputs[0], side.inputs[1])
    links.new(diffuse.outputs[0], side.inputs[2])
    links.new(side.outputs[0], output.inputs["Surface"])
    return material


def mesh_material(name, table):
    """A [[mesh]]'s material table: glass, metal, or varnish on diffuse."""
    material, nodes, links = new_material(name)
    output = nodes.new("ShaderNodeOutputMaterial")
    colour = (*table.get("reflectance", [0.8] * 3), 1)
    roughness = table.get("roughness")
    if table.get("transmission", 0) == 1:
        shader = nodes.new("ShaderNodeBsdfGlass")
        shader.distribution = "SHARP" if roughness == 0 else "GGX"
        shader.inputs["Color"].default_value = colour
        shader.inputs["IOR"].default_value = table.get("ior", 1.5)
        shader.inputs["Roughness"].default_value = roughness or 0
    elif roughness is not None:
        shader = nodes.new("ShaderNodeBsdfPrincipled")
        shader.distribution = "GGX"
        shader.inputs["Base Color"].default_value = colour
        shader.inputs["Metallic"].default_value = table.get("metallic", 0)
        shader.inputs["Roughness"].default_value = roughness
        shader.inputs["Specular"].default_value = 0.5  # an index of 1.5
    else:
        return diffuse_material(name, colour[:3])
    links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def transform(table):
    scale = Matrix.Scale(table.get("scale", 1.0), 4)
    angles = [math.radians(angle) for angle in table.get("rotate_degrees", [0, 0, 0])]
    turned = Euler(angles, "XYZ").to_matrix().to_4x4()
    return Matrix.Translation(Vector(table.get("translate", [0, 0, 0]))) @ turned @ scale


def add_mesh(folder, table, index):
    obj = ObjFile(folder / table["file"])
    mesh = bpy.data.meshes.new(f"mesh{index}")
    mesh.from_pydata(obj.vertices, [], obj.faces)
    slots = {}
    for polygon, name in zip(mesh.polygons, obj.face_materials):
        if name not in slots:
            slots[name] = len(slots)
            if name is None:
                mesh.materials.append(mesh_material(f"mesh{index}", table.get("material", {})))
            else:
                described = obj.materials[name]
                emission = described.get("Ke")
                missing = [0.0] * 3 if emission else [0.8] * 3
                mesh.materials.append(diffuse_material(name, described.get("Kd", missing), emission))
        polygon.material_index = slots[name]
    if obj.normals:
        mesh.use_auto_smooth = True
        for polygon in mesh.polygons:
            polygon.use_smooth = True
        mesh.normals_split_custom_set([obj.normals[n] for normals in obj.face_normals for n in normals])
    item = bpy.data.objects.new(f"mesh{index}", mesh)
    item.matrix_world = transform(table)
    bpy.context.scene.collection.objects.link(item)


def add_camera(table):
    position = Vector(table["position"])
    if "look_at" in table:
        direction = (Vector(table["look_at"]) - position).normalized()
    else:
        direction = Vector(table["direction"]).normalized()
    right = direction.cross(Vector(table.get("up", [0, 1, 0]))).normalized()
    up = right.cross(direction)
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    if "vertical_fov_degrees" in table:
        camera.angle = math.radians(table["vertical_fov_degrees"])
    else:
        camera.angle = 2 * math.atan(0.5 * table["film_height"] / table["focal_length"])
    camera.clip_start, camera.clip_end = 1e-3, 1e6
    item = bpy.data.objects.new("camera", camera)
    rotation = Matrix((right, up, -direction)).transposed().to_4x4()
    item.matrix_world = Matrix.Translation(position) @ rotation
    bpy.context.scene.collection.objects.link(item)
    bpy.context.scene.camera = item


def build(folder):
    description = tomllib.loads((folder / "scene.toml").read_text())
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    add_camera(description["camera"])
    for index, table in enumerate(description["mesh"]):
        add_mesh(folder, table, index)
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*description.get("environment", {}).get("constant", [0] * 3), 1)
    bpy.context.scene.world = world


def set_up(width, height, seed):
    """Everything unbiased: no clamp, no filtering, no denoiser, all caustics, a filter of one pixel."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.use_persistent_data = False
    image = scene.render.image_settings
    image.file_format, image.color_mode, image.color_depth = "OPEN_EXR", "RGB", "32"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.seed = seed
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_guiding = False
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 1024
    cycles.min_light_bounces = 3  # segments without roulette, as this project's default


def cpu_seconds(samples, output):
    scene = bpy.context.scene
    scene.cycles.samples = samples
    scene.render.filepath = output
    start = time.process_time()
    bpy.ops.render.render(write_still=True)
    return time.process_time() - start


def main(scene, width, height, seed, samples, output):
    set_up(int(width), int(height), int(seed))
    build(pathlib.Path(scene))
    alone = cpu_seconds(1, output)
    count = int(samples)
    whole = cpu_seconds(count, output)
    print(f"cpu_seconds {(whole - alone) * count / (count - 1):.6f}")


main(*sys.argv[sys.argv.index("--") + 1:])
