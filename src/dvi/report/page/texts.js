"use strict";
// All explanations of figures in one place: their meaning and the remedies.
dvi.texts = {
  // In the order of kind/NAME.png. Colors of Okabe and Ito, which color-blind people can distinguish.
  kinds: [
    {name: "original", color: null, hint: "Unchanged: exactly as recorded."},
    {name: "copied", key: "copied", color: "#0072b2", hint: "Copied from another frame of this drive that observed the background without traffic."},
    {name: "from elsewhere", key: "copied_elsewhere", color: "#56b4e9", hint: "Copied from another camera or another drive through the same street."},
    {name: "interpolated", key: "interpolated", color: "#e69f00", hint: "No frame observed this. It was interpolated from its surroundings: plausible, but not evidence."},
    {name: "synthesized", key: "synthesized", color: "#cc79a7", hint: "No frame observed this. The texture of the same surface was continued: plausible, but not evidence."},
    {name: "left empty", key: "empty", color: "#999999", hint: "No frame observed this, and nothing was filled in."},
    {name: "imported", key: "imported", color: "#009e73", hint: "No frame observed this. Another program filled it: plausible, but not evidence."},
  ],
  within: {label: "expected to be right", hint: "Mean confidence of the filled pixels: the share expected within 10 gray levels (of 255) of the real background."},
  objects: {
    columns: [["object", "Its number, the track of its label if it has one."], ["class", "As labels or detections state it."],
      ["evidence", "Where the object is from: mask files, labels, a detector, or motion segmentation (found)."], ["motion", "Whether it moves during the drive."],
      ["first frame", ""], ["last frame", ""], ["completed frames", "Frames whose masks, labels, or detections lacked a part of it."],
      ["removed pixels", "In all frames."], ["remains visible", "Frames of the result that still show the object, measured by comparison with the input."]],
    summary: (all, visible) => `${all} object${all === 1 ? "" : "s"}; ${visible === 0 ? "none" : visible} of them remain${visible === 1 ? "s" : ""} visible in the result.`,
    doubtful: (object, frame, visible) => `Object ${object.object}${object.class ? ` (${object.class})` : ""}, frame ${frame}: ` +
      (visible ? "it remains visible." : `similarity with the input ${dvi.number(object.residue.highest_score, 2)}.`),
    publishing: "The removed objects whose worst frame is most similar to the input, as a sheet to look through. objects.csv lists all of them. " +
      "Objects that neither masks, labels, a detector, nor motion show are in no list.",
    none: "No removed object is known. Mask files without scans do not show which object a pixel belongs to.",
  },
  truth: {
    psnr: {label: "PSNR", unit: "dB", digits: 2, hint: "Peak signal-to-noise ratio against the truth, inside the removed area. Errors above 30 dB are hard to see; below 20 dB the content differs."},
    mae: {label: "mean error", unit: "levels", digits: 2, hint: "Mean absolute difference from the truth, in gray levels of 255."},
    ssim: {label: "SSIM", unit: "", digits: 3, hint: "Structural similarity with the truth; 1 means identical."},
    sharpness: {label: "sharpness", unit: "", digits: 2, hint: "1: as sharp as the truth; less: blurred."},
    flicker: {label: "flicker", unit: "", digits: 2, hint: "1: as stable over time as the truth; more: it flickers."},
  },
  overlays: [
    {name: "none", key: "0", title: "none"},
    {name: "mask", key: "m", title: "removed area"},
    {name: "kind", key: "k", title: "kind of pixels"},
    {name: "confidence", key: "c", title: "confidence", low: "0 %: certainly wrong", high: "100 %: certainly within 10 gray levels"},
    {name: "depth", key: "d", title: "depth", low: "near", high: "far"},
    {name: "blending", key: "e", title: "change by blending", low: "none", high: "40 gray levels or more"},
    {name: "error", key: "x", title: "difference from the truth", low: "none", high: "64 gray levels or more", truth: true},
  ],
  keys: "Keys: arrows frame by frame, space play, n and p the next and previous uncertain part, m k c d e overlays, 0 none, " +
    "b all before or all after, f the whole frame, + and - zoom. Click a pixel to see its provenance; the wheel zooms, dragging moves.",
  receipt: "Click a pixel of the picture to see its provenance.",
  // Remedies for warnings, by words in them; the first match is used.
  advice: [
    [/camera|calibrat|mounting/i, "Compare the calibration with the recording: dvi check DRIVE reports contradictions."],
    [/pose|odometry|trajectory/i, "Try --poses loam or --poses given and compare the sharpness on the page Stages."],
    [/mask|label|detector/i, "Look at the overlay “removed area” in the frames: is all traffic inside, and nothing else? docs/masks.md"],
    [/clock|time|stamp/i, "Check the clock offsets of camera and LiDAR: dvi check DRIVE."],
    [/memory/i, "Raise job.memory_mb (--set job.memory_mb=N), or fill fewer frames: --frames A:B."],
  ],
  defaultAdvice: "Look at the frames concerned, and run dvi check DRIVE.",
  problemAdvice: "The page shows the existing part. Run the same dvi run again to complete the result, or dvi report to write this page again.",
};

dvi.texts.adviceFor = (warning) => {
  const found = dvi.texts.advice.find(([words]) => words.test(warning));
  return found ? found[1] : dvi.texts.defaultAdvice;
};
