#!/usr/bin/env python3
"""Writes the tiny networks of the tests: test_models.py FOLDER

They detect magenta as a car and cyan as a person, in RGB images with values from 0 to 1.
"""
import sys
from pathlib import Path

import numpy
import onnx
from onnx import TensorProto, helper, numpy_helper

FLOAT, INT64 = TensorProto.FLOAT, TensorProto.INT64
MAGENTA, CYAN = numpy.array([1.0, -2, 1]), numpy.array([-2.0, 1, 1])  # 2 where an image has that color
SIDE, MASKS = 64, 32  # side of the YOLO's input, number of its prototypes


def tensor(name, values):
    values = numpy.asarray(values)
    return numpy_helper.from_array(values.astype(numpy.int64 if values.dtype.kind == "i" else numpy.float32), name)


def conv(name, side, weights, bias):
    """A node that maps the mean color of each side x side block; its weights (out x 3) and bias."""
    kernel = numpy.repeat(numpy.asarray(weights, float), side * side, 1).reshape(len(weights), 3, side, side) / side**2
    node = helper.make_node("Conv", ["image", name + ".w", name + ".b"], [name], name=name, kernel_shape=[side, side],
                            strides=[side, side])
    return node, [tensor(name + ".w", kernel), tensor(name + ".b", numpy.asarray(bias, float))]


def save(path, nodes, weights, outputs, size=(SIDE, SIDE)):
    values = [helper.make_tensor_value_info(name, kind, shape) for name, kind, shape in outputs]
    image = helper.make_tensor_value_info("image", FLOAT, [1, 3, *size])
    graph = helper.make_graph(nodes, "test", [image], values, weights)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 12)])
    model.ir_version = 7
    onnx.checker.check_model(model)
    onnx.save(model, str(path))


def semantic(folder):
    logits, weights = conv("logits", 1, [[0, 0, 0], MAGENTA, CYAN], [0.5, -1, -1])
    shape = [1, 3, SIDE, SIDE]
    save(folder / "semantic.onnx", [logits], weights, [("logits", FLOAT, shape)])
    best = helper.make_node("ArgMax", ["logits"], ["ids"], name="best", axis=1, keepdims=0)
    save(folder / "ids.onnx", [logits, best], weights, [("ids", INT64, [1, SIDE, SIDE])])
    top = helper.make_node("TopK", ["logits", "k"], ["values", "ids"], name="head/top", axis=1)
    save(folder / "topk.onnx", [logits, top], weights + [tensor("k", [1])],
         [("values", FLOAT, [1, 1, SIDE, SIDE]), ("ids", INT64, [1, 1, SIDE, SIDE])])
    fixed = helper.make_node("Reshape", ["logits", "size"], ["flat"], name="head/flatten")
    save(folder / "fixed.onnx", [logits, fixed], weights + [tensor("size", [1, 3 * SIDE * SIDE])],
         [("flat", FLOAT, [1, 3 * SIDE * SIDE])])


def prototypes():
    """Prototypes of which only the first is used, which is positive on objects."""
    weights = numpy.zeros((MASKS, 3))
    weights[0] = 1, 1, 1
    bias = numpy.zeros(MASKS)
    bias[0] = -1.5
    return conv("prototypes", 4, weights, bias), (1, *[0] * (MASKS - 1))


def yolov8(folder):
    bins = numpy.zeros((4, 16))
    bins[:, 2] = 40  # two cells of 8 pixels to each side
    boxes, box_weights = conv("boxes", 8, numpy.zeros((64, 3)), bins.ravel())
    classes, class_weights = conv("classes", 8, [20 * MAGENTA, 20 * CYAN], [-20, -20])
    (masks, mask_weights), first = prototypes()
    coefficients, coefficient_weights = conv("coefficients", 8, numpy.zeros((MASKS, 3)), first)
    save(folder / "yolov8.onnx", [boxes, classes, coefficients, masks],
         box_weights + class_weights + coefficient_weights + mask_weights,
         [("boxes", FLOAT, [1, 64, 8, 8]), ("classes", FLOAT, [1, 2, 8, 8]), ("coefficients", FLOAT, [1, MASKS, 8, 8]),
          ("prototypes", FLOAT, [1, MASKS, 16, 16])])


def yolov5(folder):
    width = 5 + 2 + MASKS
    (masks, mask_weights), first = prototypes()
    weights = numpy.zeros((width, 3))
    weights[5], weights[6] = MAGENTA / 2, CYAN / 2
    cells, cell_weights = conv("cells", 8, weights, [0, 0, 32, 32, 1, 0, 0, *first])
    grid = numpy.zeros((1, 64, width))
    grid[0, :, 0], grid[0, :, 1] = numpy.arange(64) % 8 * 8 + 4, numpy.arange(64) // 8 * 8 + 4
    nodes = [cells, helper.make_node("Reshape", ["cells", "size"], ["flat"]),
             helper.make_node("Transpose", ["flat"], ["rows"], perm=[0, 2, 1]),
             helper.make_node("Add", ["rows", "grid"], ["output0"]), masks]
    save(folder / "yolov5.onnx", nodes, cell_weights + mask_weights + [tensor("size", [1, width, 64]), tensor("grid", grid)],
         [("output0", FLOAT, [1, 64, width]), ("prototypes", FLOAT, [1, MASKS, 16, 16])])


if __name__ == "__main__":
    for write in semantic, yolov5, yolov8:
        write(Path(sys.argv[1]))
