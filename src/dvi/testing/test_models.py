#!/usr/bin/env python3
"""Writes the tiny networks of the tests: test_models.py FOLDER [OPSET]

They detect magenta as a car and cyan as a person, in RGB images with values from 0 to 1. The heads have the shapes, names, and
operators that exporters write by default. Objects of the heads on a grid are squares of 16 pixels at multiples of 16.
"""
import sys
from pathlib import Path

import numpy
import onnx
from onnx import TensorProto, helper, numpy_helper

FLOAT, INT64 = TensorProto.FLOAT, TensorProto.INT64
MAGENTA, CYAN = numpy.array([1.0, -2, 1]), numpy.array([-2.0, 1, 1])  # 2 where an image has that color
SIDE, MASKS = 64, 32  # side of the input, number of the prototypes
STRIDE, CELLS, COUNT = 16, 4, 16  # the cells of a grid
NAMES = "{0: 'car', 1: 'person'}"


class Net:
    """The nodes and weights of a network. Methods append nodes and return the names of their outputs."""

    def __init__(self, opset, rank=4):
        self.opset, self.rank, self.nodes, self.weights = opset, rank, [], []
        self.image = "image"
        if rank == 3:
            self.image = self.unsqueeze("image", 0)

    def constant(self, values, name=None):
        values = numpy.asarray(values)
        name = name or f"constant{len(self.weights)}"
        values = values.astype(numpy.int64 if values.dtype.kind == "i" else numpy.float32)
        self.weights.append(numpy_helper.from_array(values, name))
        return name

    def node(self, kind, *inputs, name=None, count=1, **attributes):
        name = name or f"{kind.lower()}{len(self.nodes)}"
        outputs = [name] if count == 1 else [f"{name}.{i}" for i in range(count)]
        self.nodes.append(helper.make_node(kind, list(inputs), outputs, name=f"head/{name}", **attributes))
        return name if count == 1 else outputs

    def conv(self, side, weights, bias, name=None):
        """Maps the mean color of each side x side block; its weights (out x 3) and bias."""
        kernel = numpy.repeat(numpy.asarray(weights, float), side * side, 1).reshape(len(weights), 3, side, side) / side**2
        return self.node("Conv", self.image, self.constant(kernel), self.constant(numpy.asarray(bias, float)), name=name,
                         kernel_shape=[side, side], strides=[side, side])

    def reshape(self, value, *shape):
        return self.node("Reshape", value, self.constant(list(shape)))

    def concat(self, *values, axis=1, name=None):
        return self.node("Concat", *values, axis=axis, name=name)

    def split(self, value, sizes, axis=1):
        if self.opset < 13:
            return self.node("Split", value, count=len(sizes), split=sizes, axis=axis)
        return self.node("Split", value, self.constant(sizes), count=len(sizes), axis=axis)

    def _axis(self, kind, value, axis, last):
        if self.opset <= last:
            return self.node(kind, value, axes=[axis])
        return self.node(kind, value, self.constant([axis]))

    def unsqueeze(self, value, axis):
        return self._axis("Unsqueeze", value, axis, 12)

    def squeeze(self, value, axis):
        return self._axis("Squeeze", value, axis, 12)

    def reduce_max(self, value, axis, name=None):
        if self.opset < 18:
            return self.node("ReduceMax", value, axes=[axis], keepdims=0, name=name)
        return self.node("ReduceMax", value, self.constant([axis]), keepdims=0, name=name)

    def save(self, path, outputs, size=(SIDE, SIDE), metadata=None, more_inputs=()):
        """Writes the network. `outputs` and `more_inputs`: name, type, and shape of each."""
        values = [helper.make_tensor_value_info(name, kind, shape) for name, kind, shape in outputs]
        shape = [3, *size] if self.rank == 3 else [1, 3, *size]
        image = helper.make_tensor_value_info("image", FLOAT, shape)
        inputs = [image] + [helper.make_tensor_value_info(name, kind, axes) for name, kind, axes in more_inputs]
        graph = helper.make_graph(self.nodes, "test", inputs, values, self.weights)
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", self.opset)])
        model.ir_version = 7 if self.opset < 18 else 9
        helper.set_model_props(model, metadata or {})
        if self.opset <= onnx.defs.onnx_opset_version():
            onnx.checker.check_model(model)
        onnx.save(model, str(path))


def class_logits(net, side=STRIDE):
    """Logits of car and person per cell: 1 x 2 x rows x cols."""
    return net.conv(side, [20 * MAGENTA, 20 * CYAN], [-20, -20])


def prototypes(net, name="prototypes"):
    """Prototypes of which only the first is used, which is positive on objects."""
    weights = numpy.zeros((MASKS, 3))
    weights[0] = 1, 1, 1
    bias = numpy.zeros(MASKS)
    bias[0] = -1.5
    return net.conv(4, weights, bias, name)


def first_prototype(count):
    coefficients = numpy.zeros((1, MASKS, count))
    coefficients[0, 0] = 1
    return coefficients


def anchors():
    """Centers of the cells, in cells: 1 x 2 x cells."""
    y, x = numpy.mgrid[0:CELLS, 0:CELLS] + 0.5
    return numpy.stack([x.ravel(), y.ravel()])[None]


def semantic(folder, opset):
    net = Net(opset)
    net.conv(1, [[0, 0, 0], MAGENTA, CYAN], [0.5, -1, -1], "logits")
    net.save(folder / "semantic.onnx", [("logits", FLOAT, [1, 3, SIDE, SIDE])])
    net.node("ArgMax", "logits", name="ids", axis=1, keepdims=0)
    net.save(folder / "ids.onnx", [("ids", INT64, [1, SIDE, SIDE])])


def normalized_semantic(folder, opset):
    """As SegFormer's: layer normalization, whose operator exists from opset 17 on, and coarse logits."""
    net = Net(opset)
    features = net.node("Transpose", net.conv(4, [[0, 0, 0], MAGENTA, CYAN], [0.5, -1, -1]), perm=[0, 2, 3, 1])
    scale, bias = net.constant(numpy.ones(3)), net.constant(numpy.zeros(3))
    if opset >= 17:
        features = net.node("LayerNormalization", features, scale, bias, axis=-1)
    net.node("Transpose", features, perm=[0, 3, 1, 2], name="logits")
    net.save(folder / "segformer.onnx", [("logits", FLOAT, [1, 3, SIDE // 4, SIDE // 4])])


def separate_weights(folder, opset):
    """A network whose weights are in another file."""
    net = Net(opset)
    net.conv(1, [[0, 0, 0], MAGENTA, CYAN], [0.5, -1, -1], "logits")
    net.save(folder / "whole.onnx", [("logits", FLOAT, [1, 3, SIDE, SIDE])])
    onnx.save_model(onnx.load(str(folder / "whole.onnx")), str(folder / "separate.onnx"), save_as_external_data=True,
                    location="separate.data", size_threshold=0)


def unsupported_nodes(folder, opset):
    """A node that OpenCV does not know, one that fails on images of other sizes, and a classifier."""
    net = Net(opset)
    logits = net.conv(1, [[0, 0, 0], MAGENTA, CYAN], [0.5, -1, -1], "logits")
    values, ids = net.node("TopK", logits, net.constant([1]), name="top", count=2, axis=1)
    net.save(folder / "topk.onnx", [(values, FLOAT, [1, 1, SIDE, SIDE]), (ids, INT64, [1, 1, SIDE, SIDE])])
    net = Net(opset)
    logits = net.conv(1, [[0, 0, 0], MAGENTA, CYAN], [0.5, -1, -1], "logits")
    net.node("Reshape", logits, net.constant([1, 3 * SIDE * SIDE]), name="flatten")
    net.save(folder / "fixed.onnx", [("flatten", FLOAT, [1, 3 * SIDE * SIDE])], ("height", "width"))
    net = Net(opset)
    net.node("Softmax", net.reshape(net.conv(SIDE, [MAGENTA, CYAN], [0, 0]), 1, 2), name="probabilities", axis=1)
    net.save(folder / "classifier.onnx", [("probabilities", FLOAT, [1, 2])])


def yolov5(folder, opset):
    """x, y, width, height, objectness, classes, coefficients per cell."""
    for name, masks in ("yolov5", 0), ("yolov5-seg", MASKS):
        net = Net(opset)
        scores = net.node("Sigmoid", net.reshape(class_logits(net), 1, 2, COUNT))
        boxes = numpy.concatenate([anchors() * STRIDE, numpy.full((1, 2, COUNT), STRIDE), numpy.ones((1, 1, COUNT))], 1)
        parts = [net.constant(boxes), scores]
        outputs = [("output0", FLOAT, [1, COUNT, 7 + masks])]
        if masks:
            parts.append(net.constant(first_prototype(COUNT)))
            outputs.append((prototypes(net, "output1"), FLOAT, [1, MASKS, SIDE // 4, SIDE // 4]))
        net.node("Transpose", net.concat(*parts), perm=[0, 2, 1], name="output0")
        net.save(folder / f"{name}.onnx", outputs)


def decoded_boxes(net):
    """The head of YOLOv8 up to its boxes in pixels (center, size) and its scores: 1 x 4 x cells, 1 x 2 x cells."""
    bins = numpy.zeros((4, 16))
    bins[:, :2] = 40  # half a cell to each side
    raw = net.concat(net.conv(STRIDE, numpy.zeros((64, 3)), bins.ravel()), class_logits(net))
    distances, classes = net.split(net.reshape(raw, 1, 66, COUNT), [64, 2])
    distances = net.node("Transpose", net.reshape(distances, 1, 4, 16, COUNT), perm=[0, 2, 1, 3])
    if net.opset < 13:  # Softmax works on all later axes before
        distances = net.node("Transpose", distances, perm=[0, 2, 3, 1])
        distances = net.node("Transpose", net.node("Softmax", distances, axis=3), perm=[0, 3, 1, 2])
    else:
        distances = net.node("Softmax", distances, axis=1)
    mean = net.constant(numpy.arange(16.0).reshape(1, 16, 1, 1))
    distances = net.reshape(net.node("Conv", distances, mean, kernel_shape=[1, 1]), 1, 4, COUNT)
    to_first, to_last = net.split(distances, [2, 2])
    centers = net.constant(anchors())
    first, last = net.node("Sub", centers, to_first), net.node("Add", centers, to_last)
    middle = net.node("Div", net.node("Add", first, last), net.constant(2.0))
    boxes = net.node("Mul", net.concat(middle, net.node("Sub", last, first)), net.constant(numpy.full((1, COUNT), float(STRIDE))))
    return boxes, net.node("Sigmoid", classes)


def yolov8(folder, opset):
    for name, masks in ("yolov8", 0), ("yolov8-seg", MASKS):
        net = Net(opset)
        parts = list(decoded_boxes(net))
        outputs = [("output0", FLOAT, [1, 6 + masks, COUNT])]
        if masks:
            parts.append(net.constant(first_prototype(COUNT)))
            outputs.append((prototypes(net, "output1"), FLOAT, [1, MASKS, SIDE // 4, SIDE // 4]))
        net.concat(*parts, name="output0")
        net.save(folder / f"{name}.onnx", outputs,
                 metadata={"names": NAMES, "stride": "32", "task": "segment" if masks else "detect", "imgsz": "[64, 64]",
                           "description": "Ultralytics YOLOv8n model"})


def undecoded_yolov8(folder, opset):
    """The head cut before its boxes are decoded, with distributions over 16 bins or with distances (YOLO26)."""
    for name, bins in ("yolov8-cut", 16), ("yolo26-cut", 1):
        net = Net(opset)
        values = numpy.full((4, bins), 0.5)
        values[:, :2] = 40 if bins > 1 else 0.5
        boxes = net.conv(STRIDE, numpy.zeros((4 * bins, 3)), values.ravel(), "boxes")
        classes = class_logits(net)
        coefficients = net.conv(STRIDE, numpy.zeros((MASKS, 3)), first_prototype(1).ravel(), "coefficients")
        masks = prototypes(net)
        net.save(folder / f"{name}.onnx", [(boxes, FLOAT, [1, 4 * bins, CELLS, CELLS]), (classes, FLOAT, [1, 2, CELLS, CELLS]),
                                           (coefficients, FLOAT, [1, MASKS, CELLS, CELLS]),
                                           (masks, FLOAT, [1, MASKS, SIDE // 4, SIDE // 4])])


def corners(net, boxes):
    """Converts center and size to corners: 1 x cells x 4."""
    center, size = net.split(boxes, [2, 2])
    half = net.node("Div", size, net.constant(2.0))
    return net.node("Transpose", net.concat(net.node("Sub", center, half), net.node("Add", center, half)), perm=[0, 2, 1])


def end_to_end(folder, opset):
    """As YOLOv10 and YOLO26 select the best boxes: x1, y1, x2, y2, score, class, coefficients per row."""
    best = 10
    for name, masks in ("yolo26", 0), ("yolo26-seg", MASKS):
        net = Net(opset)
        boxes, scores = decoded_boxes(net)
        scores = net.node("Transpose", scores, perm=[0, 2, 1])
        values, cells = net.node("TopK", net.reduce_max(scores, 2), net.constant([best]), count=2, axis=1)
        types = net.node("Cast", net.node("ArgMax", scores, axis=2, keepdims=0), to=FLOAT)
        cell_rows = net.unsqueeze(cells, 2)
        picked = net.node("GatherElements", corners(net, boxes),
                          net.node("Tile", cell_rows, net.constant([1, 1, 4])), axis=1)
        parts = [picked, net.unsqueeze(values, 2), net.unsqueeze(net.node("GatherElements", types, cells, axis=1), 2)]
        outputs = [("output0", FLOAT, [1, best, 6 + masks])]
        if masks:
            parts.append(net.constant(first_prototype(best).transpose(0, 2, 1)))
            outputs.append((prototypes(net, "output1"), FLOAT, [1, MASKS, SIDE // 4, SIDE // 4]))
        net.concat(*parts, axis=2, name="output0")
        net.save(folder / f"{name}.onnx", outputs, metadata={"names": NAMES, "stride": "32", "imgsz": "[64, 64]"})


def detr(folder, opset):
    """Logits and boxes as shares of the input (Hugging Face), and both in one output with scores (Ultralytics)."""
    shares = numpy.concatenate([anchors() / CELLS, numpy.full((1, 2, COUNT), 1 / CELLS)], 1).transpose(0, 2, 1)
    net = Net(opset)
    net.node("Transpose", net.reshape(class_logits(net), 1, 2, COUNT), perm=[0, 2, 1], name="logits")
    net.node("Identity", net.constant(shares), name="pred_boxes")
    net.save(folder / "rtdetr-hf.onnx", [("logits", FLOAT, [1, COUNT, 2]), ("pred_boxes", FLOAT, [1, COUNT, 4])])
    net = Net(opset)
    scores = net.node("Sigmoid", net.reshape(class_logits(net), 1, 2, COUNT))
    net.concat(net.constant(shares), net.node("Transpose", scores, perm=[0, 2, 1]), axis=2, name="output0")
    net.save(folder / "rtdetr.onnx", [("output0", FLOAT, [1, COUNT, 6])],
             metadata={"names": NAMES, "imgsz": "[64, 64]", "description": "Ultralytics RT-DETR-l model"})


def scaled_detr(folder, opset):
    """As RT-DETR's own exporter: boxes in pixels of a size that is a second input."""
    net = Net(opset)
    scores = net.node("Sigmoid", net.reshape(class_logits(net), 1, 2, COUNT))
    net.node("Identity", net.reduce_max(scores, 1), name="scores")
    net.node("ArgMax", scores, axis=1, keepdims=0, name="labels")
    centers = anchors().transpose(0, 2, 1) / CELLS
    shares = net.constant(numpy.concatenate([centers - 0.5 / CELLS, centers + 0.5 / CELLS], 2))
    size = net.node("Cast", net.concat("orig_target_sizes", "orig_target_sizes"), to=FLOAT)
    net.node("Mul", shares, net.unsqueeze(size, 1), name="boxes")
    net.save(folder / "rtdetr-scaled.onnx", [("labels", INT64, [1, COUNT]), ("boxes", FLOAT, [1, COUNT, 4]),
                                             ("scores", FLOAT, [1, COUNT])], more_inputs=[("orig_target_sizes", INT64, [1, 2])])


def mask_rcnn(folder, opset):
    """As torchvision's: an image without batch axis, boxes that remain after NonMaxSuppression, masks by RoiAlign."""
    net = Net(opset, rank=3)
    boxes, scores = decoded_boxes(net)
    boxes = corners(net, boxes)
    limits = [net.constant([16]), net.constant(numpy.array([0.5])), net.constant(numpy.array([0.5]))]
    selected = net.node("NonMaxSuppression", boxes, scores, *limits)
    _, types, cells = [net.squeeze(part, 1) for part in net.split(selected, [1, 1, 1])]
    picked = net.node("Gather", net.squeeze(boxes, 0), cells, axis=0, name="boxes")
    net.node("Add", types, net.constant([1]), name="labels")  # 0 is the background
    best = net.reduce_max(scores, 1)
    net.node("Gather", net.squeeze(best, 0), cells, axis=0, name="scores")
    net.node("Identity", picked, name="out_boxes")
    objects = net.node("Sigmoid", net.conv(4, [[40, 40, 40]], [-60]))
    zeros = net.node("Mul", cells, net.constant([0]))
    align = {"mode": "avg", "output_height": 28, "output_width": 28, "sampling_ratio": 2, "spatial_scale": 0.25}
    if opset >= 16:
        align["coordinate_transformation_mode"] = "output_half_pixel"
    net.node("RoiAlign", objects, picked, zeros, name="masks", **align)
    net.save(folder / "maskrcnn.onnx", [("boxes", FLOAT, ["n", 4]), ("labels", INT64, ["n"]), ("scores", FLOAT, ["n"]),
                                        ("masks", FLOAT, ["n", 1, 28, 28])], ("height", "width"))
    net.save(folder / "fasterrcnn.onnx", [("boxes", FLOAT, ["n", 4]), ("labels", INT64, ["n"]), ("scores", FLOAT, ["n"])])


def main():
    folder, opset = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 12
    for write in (semantic, normalized_semantic, separate_weights, unsupported_nodes, yolov5, yolov8, undecoded_yolov8,
                  end_to_end, detr, scaled_detr, mask_rcnn):
        write(folder, opset)


if __name__ == "__main__":
    main()
